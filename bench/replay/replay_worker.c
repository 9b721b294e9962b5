#define _POSIX_C_SOURCE 200809L
#include "bench/replay/replay_worker.h"

#include "bench/replay/source.h"
#include "bench/run/repeat.h"
#include "cli/commands.h"

#include <stdio.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--slice", "S", RB_OPTION_NUMBER, BENCH(slice_s), 0, 1e6, "seconds the process may take"},
    {"--cpu", "N", RB_OPTION_INT, BENCH(cpu), -1, 65535, "processor to stay on; -1: any"},
    {"--process", "N", RB_OPTION_INT, BENCH(process), 0, 1e6, "round, for the samples"},
    {.name = NULL},
};

const struct rb_command rb_command_replay_worker = {
    .name = "replay-worker",
    .summary = "measure one kernel on recorded rays; used by replay",
    .synopsis = "FILE [options]",
    .text = "Writes binary records to a pipe, for raybench replay.",
    .positional_min = 1,
    .positional_max = 1,
    .groups =
        (const struct rb_option *const[]){options, rb_options_choice, rb_options_variant, NULL},
    .run = run,
    .hidden = true,
};

// A repetition goes over the batches until it has taken as long as this: a clock reading and a
// preemption are then a small part of it.
enum { REPETITION_NS = 2000000 };

// Rounds that make a repetition, from how long one took.
static uint32_t choose_rounds(uint64_t round_ns)
{
    uint64_t rounds = REPETITION_NS / (round_ns ? round_ns : 1);
    return rounds < 1 ? 1 : rounds > 1000000 ? 1000000 : (uint32_t)rounds;
}

// The first round says how many make a repetition. Where there is no time for a second one, it is
// the only repetition.
static enum rb_status measure(struct rb_repeater *repeater, struct rb_replay_source *source,
                              struct rb_error *error)
{
    struct rb_run_result result;
    repeater->renderer = source->renderer;
    repeater->how.replay = &source->replay;
    if (rb_replay_verify(source->renderer, &source->replay, error)) {
        repeater->sample.mismatch = true;
        rb_repeater_send(repeater, NULL);
        return RB_INVALID;
    }
    rb_repeater_measure(repeater, &result);
    if (rb_clock_ns() + result.wall_ns - repeater->start_ns > (uint64_t)(repeater->slice_s * 1e9))
        return rb_repeater_send(repeater, error);
    source->replay.rounds = choose_rounds(result.wall_ns);
    rb_repeater_warm_up(repeater);
    return rb_repeater_run(repeater, error);
}

static int run(const struct rb_arguments *arguments)
{
    static struct rb_repeater repeater;
    struct rb_replay_source source;
    struct rb_error error = {0};
    int kernel, ray_class, bounce;
    rb_repeater_begin(&repeater, &arguments->bench);
    enum rb_status status = rb_choice_parse(arguments, &kernel, &ray_class, &bounce, &error);
    if (status == RB_OK && (kernel < 0 || ray_class == RB_CLASS_COUNT || isatty(STDOUT_FILENO)))
        status = rb_error_set(&error, RB_INVALID,
                              "replay-worker writes records of one kernel for raybench replay");
    if (status)
        return rb_report(status, &error);
    const struct rb_record_choice choice = {(enum rb_ray_class)ray_class, (enum rb_stage)kernel,
                                            bounce};
    int code = rb_replay_source_open(arguments->positional[0], &choice, arguments, &source);
    if (code)
        return code;
    snprintf(error.file, sizeof error.file, "%.255s", arguments->positional[0]);
    status = measure(&repeater, &source, &error);
    rb_replay_source_close(&source);
    return status ? rb_report(status, &error) : 0;
}
