#define _DEFAULT_SOURCE
#include "bench/run/worker.h"

#include "bench/run/sample.h"
#include "bench/run/tiles.h"
#include "cli/commands.h"
#include "measure/affinity.h"
#include "measure/simulate.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
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

// Frames are alike if they differ by no more than this; warm-up takes at most its share of time.
static const double STEADY = 0.05, WARM_UP_SHARE = 0.3;
enum { WARM_UP_NS = 30000000 };

struct worker {
    const struct rb_arguments *arguments;
    struct rb_renderer *renderer;
    struct rb_run_options how;
    struct rb_tiles tiles;
    struct rb_sample sample; // what does not change from repetition to repetition is filled once
    uint64_t start_ns;
    bool expected; // the hashes below were given
    uint64_t image_hash, hits_hash;
};

static double elapsed_s(const struct worker *worker)
{
    return (double)(rb_clock_ns() - worker->start_ns) * 1e-9;
}

// Time that the hypervisor gave to others, of all processors; NaN where the kernel does not tell.
static double steal_ms(void)
{
    unsigned long long steal;
    FILE *file = fopen("/proc/stat", "r");
    int found = 0;
    if (file) {
        found = fscanf(file, "cpu %*u %*u %*u %*u %*u %*u %*u %llu", &steal);
        fclose(file);
    }
    return found == 1 ? (double)steal * 1000.0 / (double)sysconf(_SC_CLK_TCK) : (double)NAN;
}

static int64_t involuntary_switches(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_nivcsw : 0;
}

static uint64_t peak_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}

static void fill_stages(struct rb_sample *sample, const struct rb_run_result *result)
{
    double ns_per_tick = rb_clock_ns_per_tick();
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
        for (int stage = 0; stage < RB_STAGE_COUNT; stage++) {
            const struct rb_tally *tally = &result->recorder.tally[stage][bounce];
            sample->stage[stage][bounce] = (struct rb_sample_stage){
                (uint64_t)((double)tally->ticks * ns_per_tick + 0.5), tally->rays, tally->calls};
        }
        sample->reflected[bounce] = result->recorder.reflected[bounce];
        sample->refracted[bounce] = result->recorder.refracted[bounce];
    }
    sample->wall_ns = result->wall_ns;
    sample->busy_max_ns = (uint64_t)((double)result->busy_max_ticks * ns_per_tick + 0.5);
    sample->threads = result->thread_count;
    sample->image_hash = result->image_hash;
    sample->peak_bytes = peak_bytes();
}

static bool send_sample(const struct rb_sample *sample)
{
    const char *from = (const char *)sample;
    size_t left = sizeof *sample;
    while (left > 0) {
        ssize_t sent = write(STDOUT_FILENO, from, left);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return false;
        from += sent;
        left -= (size_t)sent;
    }
    return true;
}

static enum rb_status cannot_send(struct rb_error *error)
{
    return rb_error_set(error, RB_FAILED, "cannot write to the pipe");
}

static void measure(struct worker *worker, struct rb_run_result *result)
{
    struct rb_sample *sample = &worker->sample;
    double stolen_ms = steal_ms();
    int64_t switches = involuntary_switches();
    int cpu = rb_affinity_current();
    rb_renderer_run(worker->renderer, &worker->how, result);
    sample->migrations = result->thread_count > 1 ? -1 : rb_affinity_current() != cpu;
    sample->context_switches = involuntary_switches() - switches;
    sample->steal_ms = steal_ms() - stolen_ms;
    fill_stages(sample, result);
    sample->mismatch = worker->expected && sample->image_hash != worker->image_hash;
}

// The first frame, with its hits hashed. Returns false, having sent it, if it is not as expected.
static bool verify(struct worker *worker)
{
    struct rb_run_result result;
    worker->how.hash_hits = true;
    measure(worker, &result);
    worker->how.hash_hits = false;
    worker->sample.hits_hash = result.hits_hash;
    worker->sample.mismatch |= worker->expected && result.hits_hash != worker->hits_hash;
    if (worker->sample.mismatch)
        send_sample(&worker->sample);
    return !worker->sample.mismatch;
}

// Until two frames in a row took about the same time, or time is short.
static void warm_up(struct worker *worker)
{
    struct rb_run_result result;
    double last_ns = 0, limit_s = worker->arguments->bench.slice_s * WARM_UP_SHARE;
    uint64_t begin_ns = rb_clock_ns();
    while (elapsed_s(worker) < limit_s &&
           (worker->sample.steady < 1 || rb_clock_ns() - begin_ns < WARM_UP_NS)) {
        rb_renderer_run(worker->renderer, &worker->how, &result);
        double ns = (double)result.wall_ns;
        if (last_ns > 0)
            worker->sample.steady = fabs(ns - last_ns) <= STEADY * last_ns;
        last_ns = ns;
    }
}

// At least one repetition, and no more that would end late.
static bool repeat(struct worker *worker)
{
    struct rb_run_result result;
    double slice_s = worker->arguments->bench.slice_s;
    do {
        measure(worker, &result);
        if (!send_sample(&worker->sample))
            return false;
        worker->sample.repetition++;
    } while (worker->sample.repetition < RB_REPETITIONS_MAX &&
             elapsed_s(worker) + (double)result.wall_ns * 1e-9 < slice_s);
    return true;
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
    struct rb_run_result result, check;
    struct rb_renderer *bvh;
    const struct rb_settings *settings = rb_renderer_settings(worker->renderer);
    enum rb_status status =
        rb_tiles_shuffle(&worker->tiles, settings->width, settings->height, settings->seed, error);
    if (status == RB_OK)
        status = rb_renderer_create(scene, rb_variant_find("bvh"), settings, &bvh, error);
    if (status)
        return status;
    rb_tiles_group(&worker->tiles, (uint32_t)worker->arguments->bench.group_tiles,
                   worker->sample.process, &worker->how);
    worker->how.hash_hits = true;
    measure(worker, &result);
    rb_renderer_run(bvh, &worker->how, &check);
    rb_renderer_free(bvh);
    worker->sample.hits_hash = result.hits_hash;
    worker->sample.mismatch = result.hits_hash != check.hits_hash ||
                              result.image_hash != check.image_hash ||
                              !same_rays(&worker->sample, &check);
    if (!send_sample(&worker->sample))
        return cannot_send(error);
    return worker->sample.mismatch ? RB_INVALID : RB_OK;
}

// Renders runs of tiles, under a simulator or natively: then the sample says what hits and rays the
// simulator must have.
static enum rb_status run_simulated(struct worker *worker, struct rb_error *error)
{
    struct rb_run_result result;
    const struct rb_arguments *arguments = worker->arguments;
    enum rb_status status = rb_tiles_runs(&worker->tiles, rb_renderer_tile_count(worker->renderer),
                                          (uint32_t)arguments->bench.simulate_tiles,
                                          arguments->settings.seed, &worker->how, error);
    if (status)
        return status;
    worker->how.hash_hits = true;
    rb_simulate_start();
    measure(worker, &result);
    rb_simulate_end(result.hits_hash, rb_variant_resolve(rb_open_variant(arguments))->name);
    worker->sample.hits_hash = result.hits_hash;
    return send_sample(&worker->sample) ? RB_OK : cannot_send(error);
}

static enum rb_status run_frames(struct worker *worker, struct rb_error *error)
{
    if (!verify(worker))
        return RB_INVALID;
    if (worker->arguments->bench.slice_s == 0) // the verified frame is all that is wanted
        return send_sample(&worker->sample) ? RB_OK : cannot_send(error);
    warm_up(worker);
    return repeat(worker) ? RB_OK : cannot_send(error);
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
    if (!parse_slow(getenv(RB_SLOW_VARIABLE), &worker->how))
        return rb_error_set(error, RB_INVALID,
                            RB_SLOW_VARIABLE "=%.64s: expected STAGE:PERCENT, such as trace:20",
                            getenv(RB_SLOW_VARIABLE));
    if (arguments->bench.expect) {
        if (sscanf(arguments->bench.expect, "%" SCNx64 ":%" SCNx64, &worker->image_hash,
                   &worker->hits_hash) != 2)
            return rb_error_set(error, RB_INVALID, "--expect takes IMAGE:HITS");
        worker->expected = true;
    }
    worker->sample.cpu = arguments->bench.cpu < 0 ? -1 : rb_affinity_pin(arguments->bench.cpu);
    return RB_OK;
}

static int run(const struct rb_arguments *arguments)
{
    static struct worker worker; // a sample is too large for the stack
    struct rb_scene scene;
    struct rb_error error = {0};
    worker.arguments = arguments;
    worker.start_ns = rb_clock_ns();
    rb_clock_begin();
    enum rb_status status = prepare(&worker, &error);
    if (status)
        return rb_report(status, &error);
    int code = rb_open_renderer(arguments, &scene, &worker.renderer);
    if (code)
        return code;
    worker.sample.magic = RB_SAMPLE_MAGIC;
    worker.sample.steady = -1;
    worker.sample.process = (uint32_t)arguments->bench.process;
    worker.sample.build_ns = rb_renderer_build_ns(worker.renderer);
    worker.sample.tree_bytes = rb_renderer_tree_bytes(worker.renderer);
    if (arguments->bench.simulate_tiles)
        status = run_simulated(&worker, &error);
    else
        status = arguments->bench.group_tiles ? run_group(&worker, &scene, &error)
                                              : run_frames(&worker, &error);
    rb_free(worker.tiles.order);
    rb_renderer_free(worker.renderer);
    rb_scene_free(&scene);
    return error.text[0] ? rb_report(status, &error) : (int)status;
}
