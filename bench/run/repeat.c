#define _DEFAULT_SOURCE
#include "bench/run/repeat.h"

#include "measure/affinity.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

// Frames are alike if they differ by no more than this; warm-up takes at most its share of time.
static const double STEADY = 0.05, WARM_UP_SHARE = 0.3;
enum { WARM_UP_NS = 30000000 };

void rb_repeater_begin(struct rb_repeater *repeater, const struct rb_bench_arguments *bench)
{
    *repeater = (struct rb_repeater){.slice_s = bench->slice_s, .start_ns = rb_clock_ns()};
    rb_clock_begin();
    repeater->sample.magic = RB_SAMPLE_MAGIC;
    repeater->sample.steady = -1;
    repeater->sample.process = (uint32_t)bench->process;
    repeater->sample.cpu = bench->cpu < 0 ? -1 : rb_affinity_pin(bench->cpu);
}

static double elapsed_s(const struct rb_repeater *repeater)
{
    return (double)(rb_clock_ns() - repeater->start_ns) * 1e-9;
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

enum rb_status rb_repeater_write(const void *from, size_t bytes, struct rb_error *error)
{
    for (size_t done = 0; done < bytes;) {
        ssize_t sent = write(STDOUT_FILENO, (const char *)from + done, bytes - done);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return rb_error_set(error, RB_FAILED, "cannot write to the pipe");
        done += (size_t)sent;
    }
    return RB_OK;
}

enum rb_status rb_repeater_send(const struct rb_repeater *repeater, struct rb_error *error)
{
    return rb_repeater_write(&repeater->sample, sizeof repeater->sample, error);
}

void rb_repeater_measure(struct rb_repeater *repeater, struct rb_run_result *result)
{
    struct rb_sample *sample = &repeater->sample;
    double stolen_ms = steal_ms();
    int64_t switches = involuntary_switches();
    int cpu = rb_affinity_current();
    rb_renderer_run(repeater->renderer, &repeater->how, result);
    sample->migrations = result->thread_count > 1 ? -1 : rb_affinity_current() != cpu;
    sample->context_switches = involuntary_switches() - switches;
    sample->steal_ms = steal_ms() - stolen_ms;
    fill_stages(sample, result);
    sample->build_ns = rb_renderer_build_ns(repeater->renderer);
    sample->tree_bytes = rb_renderer_tree_bytes(repeater->renderer);
    sample->mismatch = repeater->expected && sample->image_hash != repeater->image_hash;
}

void rb_repeater_warm_up(struct rb_repeater *repeater)
{
    struct rb_run_result result;
    double last_ns = 0, limit_s = repeater->slice_s * WARM_UP_SHARE;
    uint64_t begin_ns = rb_clock_ns();
    while (elapsed_s(repeater) < limit_s &&
           (repeater->sample.steady < 1 || rb_clock_ns() - begin_ns < WARM_UP_NS)) {
        rb_renderer_run(repeater->renderer, &repeater->how, &result);
        double ns = (double)result.wall_ns;
        if (last_ns > 0)
            repeater->sample.steady = fabs(ns - last_ns) <= STEADY * last_ns;
        last_ns = ns;
    }
}

enum rb_status rb_repeater_run(struct rb_repeater *repeater, struct rb_error *error)
{
    struct rb_run_result result;
    do {
        rb_repeater_measure(repeater, &result);
        if (rb_repeater_send(repeater, error))
            return RB_FAILED;
        repeater->sample.repetition++;
    } while (repeater->sample.repetition < RB_REPETITIONS_MAX &&
             elapsed_s(repeater) + (double)result.wall_ns * 1e-9 < repeater->slice_s);
    return RB_OK;
}
