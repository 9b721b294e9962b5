#define _DEFAULT_SOURCE
#include "bench/run/worker.h"

#include "bench/run/energy_measure.h"
#include "bench/run/hardware_measure.h"
#include "bench/run/repeat.h"
#include "bench/run/tiles.h"
#include "cli/commands.h"
#include "measure/simulate.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--slice", "S", RB_OPTION_NUMBER, BENCH(slice_s), 0, 1e6, "seconds the process may take"},
    {"--expect", "IMAGE:HITS", RB_OPTION_TEXT, BENCH(expect), 0, 0, "hashes of the reference"},
    {"--cpu", "N", RB_OPTION_INT, BENCH(cpu), -1, 65535, "processor to stay on; -1: any"},
    {"--process", "N", RB_OPTION_INT, BENCH(process), 0, 1e6, "round, for the samples"},
    {"--group-tiles", "N", RB_OPTION_INT, BENCH(group_tiles), 0, 1e9,
     "render a random group of so many small tiles, the process's own, instead of frames"},
    {"--simulate-tiles", "N", RB_OPTION_INT, BENCH(simulate_tiles), 0, 1e9,
     "render so many tiles twice, the second time as laps of a simulator"},
    {"--simulate-sample", "N", RB_OPTION_INT, BENCH(simulate_sample), 0, 1e9,
     "which tiles: seed of rb_tiles_runs"},
    {"--count", NULL, RB_OPTION_FLAG, BENCH(count), 0, 0,
     "render once with the kernels that count; their counts follow the sample"},
    {"--events", "NAME|FILE", RB_OPTION_TEXT, BENCH(events), 0, 0,
     "count events in turn; what was counted follows the sample"},
    {"--energy", NULL, RB_OPTION_FLAG, BENCH(energy), 0, 0,
     "measure energy; it follows the sample"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0, "no warnings"},
    {.name = NULL},
};

const struct rb_command rb_command_worker = {
    .name = "worker",
    .summary = "measure one cell; used by bench",
    .synopsis = "SCENE [options]",
    .text = "Writes binary records to a pipe, for raybench bench.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, rb_options_settings, rb_options_levels,
                                                rb_options_variant, rb_options_threads, NULL},
    .run = run,
    .hidden = true,
};

enum { NATIVE_RUNS = 5 };

struct worker {
    const struct rb_arguments *arguments;
    struct rb_repeater repeater;
    struct rb_tiles tiles;
    struct rb_count_table counts;
    uint64_t hits_hash; // to be expected, with the repeater's image_hash
};

// The first frame, with its hits hashed. Returns false, having sent it, if it is not as expected.
static bool verify(struct worker *worker)
{
    struct rb_repeater *repeater = &worker->repeater;
    struct rb_sample *sample = &repeater->sample;
    struct rb_run_result result;
    repeater->how.hash_hits = true;
    rb_repeater_measure(repeater, &result);
    repeater->how.hash_hits = false;
    sample->hits_hash = result.hits_hash;
    sample->mismatch |= repeater->expected && result.hits_hash != worker->hits_hash;
    if (sample->mismatch)
        rb_repeater_send(repeater, NULL);
    return !sample->mismatch;
}

static bool same_rays(const struct rb_sample *sample, const struct rb_run_result *other)
{
    bool same = true;
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            same = same &&
                   sample->stage[stage][bounce].rays == other->recorder.tally[stage][bounce].rays;
    return same;
}

// Renders the process's group of tiles once, and then with the row bvh, which must agree.
static enum rb_status run_group(struct worker *worker, const struct rb_scene *scene,
                                struct rb_error *error)
{
    struct rb_repeater *repeater = &worker->repeater;
    struct rb_sample *sample = &repeater->sample;
    struct rb_run_result result, check;
    struct rb_renderer *bvh;
    const struct rb_settings *settings = rb_renderer_settings(repeater->renderer);
    enum rb_status status =
        rb_tiles_shuffle(&worker->tiles, settings->width, settings->height, settings->seed, error);
    if (status == RB_OK)
        status = rb_renderer_create(scene, rb_variant_find("bvh"), settings, &bvh, error);
    if (status)
        return status;
    rb_tiles_group(&worker->tiles, (uint32_t)worker->arguments->bench.group_tiles, sample->process,
                   &repeater->how);
    repeater->how.hash_hits = true;
    rb_repeater_measure(repeater, &result);
    repeater->how.counts = NULL;
    rb_renderer_run(bvh, &repeater->how, &check);
    rb_renderer_free(bvh);
    sample->hits_hash = result.hits_hash;
    bool exact = rb_variant_resolve(rb_open_variant(worker->arguments))->exact;
    sample->mismatch =
        exact && (result.hits_hash != check.hits_hash || result.image_hash != check.image_hash ||
                  !same_rays(sample, &check));
    status = rb_repeater_send(repeater, error);
    return status == RB_OK && sample->mismatch ? RB_INVALID : status;
}

// Renders runs of tiles, under a simulator or natively: then the samples say what hits and rays the
// simulator must have, and how long they take without it.
static enum rb_status run_simulated(struct worker *worker, struct rb_error *error)
{
    struct rb_repeater *repeater = &worker->repeater;
    struct rb_run_result result;
    const struct rb_arguments *arguments = worker->arguments;
    enum rb_status status =
        rb_tiles_runs(&worker->tiles, rb_renderer_tile_count(repeater->renderer),
                      (uint32_t)arguments->bench.simulate_tiles,
                      (uint64_t)arguments->bench.simulate_sample, &repeater->how, error);
    if (status)
        return status;
    repeater->how.hash_hits = true;
    rb_simulate_start();
    rb_repeater_measure(repeater, &result);
    rb_simulate_end(result.hits_hash, rb_variant_resolve(rb_open_variant(arguments))->name);
    repeater->sample.hits_hash = result.hits_hash;
    status = rb_repeater_send(repeater, error);
    while (status == RB_OK && !rb_simulate_running() &&
           ++repeater->sample.repetition < NATIVE_RUNS) {
        rb_repeater_measure(repeater, &result);
        status = rb_repeater_send(repeater, error);
    }
    return status;
}

static enum rb_status want_counts(struct worker *worker, struct rb_error *error)
{
    const struct rb_variant *variant = rb_variant_resolve(rb_open_variant(worker->arguments));
    worker->repeater.how.counts = &worker->counts;
    return variant->counted
               ? RB_OK
               : rb_error_set(error, RB_INVALID,
                              "%s has no kernels that count: see kernels/kernel.h", variant->name);
}

static enum rb_status run_frames(struct worker *worker, struct rb_error *error)
{
    if (!verify(worker))
        return RB_INVALID;
    const struct rb_bench_arguments *bench = &worker->arguments->bench;
    if (worker->repeater.slice_s == 0 || bench->events || bench->energy) // more follows, or nothing
        return rb_repeater_send(&worker->repeater, error);
    rb_repeater_warm_up(&worker->repeater);
    return rb_repeater_run(&worker->repeater, error);
}

// The stage that a test wants slower counts as much more.
static void slow_counts(struct worker *worker)
{
    const struct rb_run_options *how = &worker->repeater.how;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        for (int i = 0; i < RB_COUNTER_COUNT; i++) {
            uint64_t *count = &worker->counts.at[how->slow_stage][bounce].of[i];
            *count += (uint64_t)((double)*count * how->slow_share);
        }
}

static bool parse_slow(const char *text, struct rb_run_options *how)
{
    char name[32];
    double percent;
    if (!text)
        return true;
    if (sscanf(text, "%31[a-z_]:%lf", name, &percent) != 2)
        return false;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        if (strcmp(name, rb_stage_names[stage]) == 0) {
            how->slow_stage = (enum rb_stage)stage;
            how->slow_share = percent / 100.0;
            return true;
        }
    return false;
}

static enum rb_status prepare(struct worker *worker, struct rb_error *error)
{
    const struct rb_arguments *arguments = worker->arguments;
    if (isatty(STDOUT_FILENO))
        return rb_error_set(error, RB_INVALID, "worker writes records for raybench bench");
    if (!parse_slow(getenv(RB_SLOW_VARIABLE), &worker->repeater.how))
        return rb_error_set(error, RB_INVALID,
                            RB_SLOW_VARIABLE "=%.64s: expected STAGE:PERCENT, such as trace:20",
                            getenv(RB_SLOW_VARIABLE));
    if (arguments->bench.expect) {
        if (sscanf(arguments->bench.expect, "%" SCNx64 ":%" SCNx64, &worker->repeater.image_hash,
                   &worker->hits_hash) != 2)
            return rb_error_set(error, RB_INVALID, "--expect takes IMAGE:HITS");
        worker->repeater.expected = true;
    }
    return RB_OK;
}

// What follows the sample in a record, also of one that is a mismatch.
static enum rb_status send_more(struct worker *worker, struct rb_error *error)
{
    const struct rb_bench_arguments *bench = &worker->arguments->bench;
    if (bench->count)
        return rb_repeater_write(&worker->counts, sizeof worker->counts, error);
    if (bench->events)
        return rb_hardware_measure(&worker->repeater, bench->events, error);
    return bench->energy ? rb_energy_measure(&worker->repeater, 0, error) : RB_OK;
}

static int run(const struct rb_arguments *arguments)
{
    static struct worker worker; // a sample is too large for the stack
    struct rb_scene scene;
    struct rb_error error = {0};
    worker.arguments = arguments;
    rb_repeater_begin(&worker.repeater, &arguments->bench);
    enum rb_status status = prepare(&worker, &error);
    if (status)
        return rb_report(status, &error);
    int code = rb_open_renderer(arguments, &scene, &worker.repeater.renderer);
    if (code)
        return code;
    if (arguments->bench.count)
        status = want_counts(&worker, &error);
    if (status)
        return rb_report(status, &error);
    if (arguments->bench.simulate_tiles)
        status = run_simulated(&worker, &error);
    else
        status = arguments->bench.group_tiles ? run_group(&worker, &scene, &error)
                                              : run_frames(&worker, &error);
    slow_counts(&worker);
    if (!error.text[0] && send_more(&worker, &error))
        status = RB_FAILED;
    rb_free(worker.tiles.order);
    rb_renderer_free(worker.repeater.renderer);
    rb_scene_free(&scene);
    return error.text[0] ? rb_report(status, &error) : (int)status;
}
