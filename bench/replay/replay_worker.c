#define _POSIX_C_SOURCE 200809L
#include "bench/replay/replay_worker.h"

#include "base/hash.h"
#include "bench/energy/energy.h"
#include "bench/hardware/hardware.h"
#include "bench/replay/source.h"
#include "bench/run/energy_measure.h"
#include "bench/run/hardware_measure.h"
#include "bench/run/repeat.h"
#include "cli/commands.h"
#include "measure/simulate.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--slice", "S", RB_OPTION_NUMBER, BENCH(slice_s), 0, 1e6, "seconds the process may take"},
    {"--cpu", "N", RB_OPTION_INT, BENCH(cpu), -1, 65535, "processor to stay on; -1: any"},
    {"--threads", "N", RB_OPTION_INT, offsetof(struct rb_arguments, settings.threads), 1,
     RB_THREADS_MAX, "threads that share the batches; default 1"},
    {"--process", "N", RB_OPTION_INT, BENCH(process), 0, 1e6, "round, for the samples"},
    {"--simulate-batches", "N", RB_OPTION_INT, BENCH(simulate_tiles), 0, 1e9,
     "two rounds over so many batches, the second one as laps of a simulator"},
    {"--events", "NAME|FILE", RB_OPTION_TEXT, BENCH(events), 0, 0,
     "count events in turn; what was counted follows the sample"},
    {"--energy", NULL, RB_OPTION_FLAG, BENCH(energy), 0, 0,
     "measure energy; it follows the sample"},
    {"--perf-control", "FIFO", RB_OPTION_TEXT, BENCH(perf_control), 0, 0,
     "repeat until --slice is over; perf --control fifo:FIFO is enabled for that alone"},
    {.name = NULL},
};

const struct rb_command rb_command_replay_worker = {
    .name = "replay-worker",
    .summary = "measure one kernel on recorded rays; used by replay",
    .synopsis = "FILE [options]",
    .text = "Writes binary records to a pipe, for raybench replay.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, rb_options_choice, NULL},
    .run = run,
    .hidden = true,
};

// A repetition goes over the batches until it has taken as long as this: a clock reading and a
// preemption are then a small part of it.
// Events and energy are read less often: hashing the image in between is to be small as well.
enum { REPETITION_NS = 2000000, MORE_NS = 50000000 };

static const double VERIFY_SHARE = 0.3; // of the time, at most

// Of the rays of a row that is not exact, so many may be answered otherwise than recorded. On the
// scenes for speed Embree is at 0.013 % or less, but for shadow rays from the light, which on the
// mountains is far: 0.25 %.
static const double DIFFER_MOST = 0.005;

// Rounds that make a repetition, from how long one took.
static uint32_t choose_rounds(uint64_t least_ns, uint64_t round_ns)
{
    uint64_t rounds = least_ns / (round_ns ? round_ns : 1);
    return rounds < 1 ? 1 : rounds > 1000000 ? 1000000 : (uint32_t)rounds;
}

// The groups of batches of a replay, shuffled: the first batch of each. NULL without memory.
static size_t *shuffle_groups(const struct rb_replay *replay, uint64_t seed, size_t *count)
{
    size_t *order = rb_alloc(replay->count, sizeof *order);
    *count = 0;
    for (size_t i = 0; order && i < replay->count; i = rb_replay_group_end(replay, i)) {
        size_t j = (size_t)(rb_hash_word(seed, *count) % (*count + 1)); // Fisher and Yates
        order[*count] = order[j];
        order[j] = i;
        (*count)++;
    }
    return order;
}

// Drops the groups of `dropped`; the others keep the order of the file.
static void drop_groups(struct rb_replay_source *source, const size_t *dropped, size_t count)
{
    struct rb_batch *batches = source->record.batches.data;
    size_t kept = 0;
    for (size_t g = 0; g < count; g++)
        for (size_t i = dropped[g], end = rb_replay_group_end(&source->replay, i); i < end; i++) {
            rb_free(batches[i].memory);
            batches[i].memory = NULL;
        }
    for (size_t i = 0; i < source->replay.count; i++)
        if (batches[i].memory)
            batches[kept++] = batches[i];
    source->record.batches.count = source->replay.count = kept;
}

// Verifies batches in random order until there are `most` of them or the time is up; the others are
// left out. What is replayed then is a random sample, another one in every process.
static enum rb_status verify(struct rb_repeater *repeater, struct rb_replay_source *source,
                             bool exact, size_t most, double limit_s, struct rb_error *error)
{
    struct rb_replay *replay = &source->replay;
    struct rb_replay_difference difference = {0, 0};
    size_t count, done = 0;
    size_t *order = shuffle_groups(replay, repeater->sample.process, &count);
    if (!order)
        return rb_error_memory(error, "the order of the batches");
    uint64_t start_ns = rb_clock_ns();
    enum rb_status status = RB_OK;
    while (status == RB_OK && done < count && done < most &&
           (done == 0 || (double)(rb_clock_ns() - start_ns) < limit_s * 1e9)) {
        size_t first = order[done++];
        if (exact)
            status = rb_replay_verify(source->renderer, replay, first,
                                      rb_replay_group_end(replay, first), error);
        else
            rb_replay_difference(source->renderer, replay, first,
                                 rb_replay_group_end(replay, first), &difference);
    }
    repeater->sample.compared = difference.rays;
    repeater->sample.differ = difference.differ;
    if ((double)difference.differ > DIFFER_MOST * (double)difference.rays)
        status =
            rb_error_set(error, RB_INVALID,
                         "%" PRIu64 " of %" PRIu64 " rays are answered otherwise than recorded",
                         difference.differ, difference.rays);
    drop_groups(source, order + done, count - done);
    rb_free(order);
    if (status == RB_INVALID) {
        repeater->sample.mismatch = true;
        rb_repeater_send(repeater, NULL);
    }
    return status;
}

// Says a word to perf.
static enum rb_status tell_perf(const char *fifo, const char *word, struct rb_error *error)
{
    FILE *file = fopen(fifo, "w");
    bool told = file && fputs(word, file) >= 0;
    if (file && fclose(file) == 0 && told)
        return RB_OK;
    return rb_error_set(error, RB_FAILED, "cannot tell perf to %.7s: no such pipe?", word);
}

// Rounds until --slice is over, of which perf takes samples.
static enum rb_status sample(struct rb_repeater *repeater, struct rb_replay_source *source,
                             const struct rb_bench_arguments *bench, uint64_t round_ns,
                             struct rb_error *error)
{
    struct rb_run_result result;
    source->replay.rounds = choose_rounds((uint64_t)(bench->slice_s * 1e9), round_ns);
    enum rb_status status = tell_perf(bench->perf_control, "enable\n", error);
    uint64_t start_ns = rb_clock_ns();
    while (status == RB_OK && (double)(rb_clock_ns() - start_ns) < bench->slice_s * 1e9)
        rb_repeater_measure(repeater, &result);
    if (status == RB_OK)
        status = tell_perf(bench->perf_control, "disable\n", error);
    return status ? status : rb_repeater_send(repeater, error);
}

// The first round says how many make a repetition. Where there is no time for a second one, it is
// the only repetition.
static enum rb_status measure(struct rb_repeater *repeater, struct rb_replay_source *source,
                              bool exact, const struct rb_bench_arguments *bench,
                              struct rb_error *error)
{
    struct rb_run_result result;
    size_t count = source->replay.count;
    enum rb_status status =
        verify(repeater, source, exact, SIZE_MAX, VERIFY_SHARE * repeater->slice_s, error);
    if (status)
        return status;
    rb_repeater_measure(repeater, &result);
    if (bench->events || bench->energy) {
        source->replay.rounds = choose_rounds(MORE_NS, result.wall_ns);
        status = rb_repeater_send(repeater, error);
        if (status == RB_OK)
            status = bench->events ? rb_hardware_measure(repeater, bench->events, error)
                                   : rb_energy_measure(repeater, bench->bounce, error);
        return status;
    }
    if (bench->perf_control)
        return sample(repeater, source, bench, result.wall_ns, error);
    if (rb_clock_ns() + result.wall_ns - repeater->start_ns > (uint64_t)(repeater->slice_s * 1e9))
        return rb_repeater_send(repeater, error);
    if (source->replay.count == count) // repetitions of a sample are one round: it can be told
        source->replay.rounds = choose_rounds(REPETITION_NS, result.wall_ns);
    rb_repeater_warm_up(repeater);
    return rb_repeater_run(repeater, error);
}

// Some batches once to warm the simulated caches, and once to count.
static enum rb_status simulate(struct rb_repeater *repeater, struct rb_replay_source *source,
                               size_t batches, const char *row, struct rb_error *error)
{
    struct rb_run_result result;
    enum rb_status status = verify(repeater, source, true, batches, (double)INFINITY, error);
    if (status)
        return status;
    source->replay.rounds = 2;
    repeater->how.simulate_from = 1;
    rb_simulate_start();
    rb_repeater_measure(repeater, &result);
    rb_simulate_end(0, row);
    return rb_repeater_send(repeater, error);
}

// A record has what was asked for, also where there is nothing to measure.
static void complete_record(const struct rb_bench_arguments *bench)
{
    static const struct rb_hardware no_events;
    const struct rb_energy_span no_energy = {.units = 0};
    if (bench->events)
        rb_repeater_write(&no_events, sizeof no_events, NULL);
    else if (bench->energy)
        rb_repeater_write(&no_energy, sizeof no_energy, NULL);
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
    repeater.renderer = source.renderer;
    repeater.how.replay = &source.replay;
    if (arguments->bench.simulate_tiles)
        status = simulate(&repeater, &source, (size_t)arguments->bench.simulate_tiles,
                          rb_replay_variant(arguments)->name, &error);
    else
        status = measure(&repeater, &source, rb_replay_variant(arguments)->exact, &arguments->bench,
                         &error);
    if (repeater.sample.mismatch)
        complete_record(&arguments->bench);
    rb_replay_source_close(&source);
    return status ? rb_report(status, &error) : 0;
}
