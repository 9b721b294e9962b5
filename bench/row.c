#include "bench/row.h"

#include <math.h>

int rb_row_threads(const struct rb_row *row)
{
    return row->sample_count ? row->samples[0].thread_count : 0;
}

double rb_result_rays(const struct rb_run_result *result)
{
    uint64_t rays = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        rays += result->recorder.tally[RB_STAGE_TRACE][bounce].rays +
                result->recorder.tally[RB_STAGE_TRACE_SHADOW][bounce].rays;
    return (double)rays;
}

static double stage_ns(const struct rb_run_result *result, enum rb_stage stage)
{
    return (double)rb_recorder_stage_ticks(&result->recorder, stage) * rb_clock_ns_per_tick();
}

// Elapsed time of all threads.
static double threads_ns(const struct rb_run_result *result)
{
    double ns = 0;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        ns += stage_ns(result, (enum rb_stage)stage);
    return ns;
}

struct rb_estimate rb_row_cell(const struct rb_row *row, enum rb_stage stage, int bounce)
{
    double ns[RB_ROW_SAMPLES_MAX], rays[RB_ROW_SAMPLES_MAX];
    size_t count = (size_t)row->sample_count;
    for (size_t i = 0; i < count; i++) {
        const struct rb_tally *tally = &row->samples[i].recorder.tally[stage][bounce];
        ns[i] = (double)tally->ticks * rb_clock_ns_per_tick();
        rays[i] = (double)tally->rays;
    }
    if (row->state == RB_ROW_ESTIMATED)
        return rb_stats_ratio(rays, ns, count, row->population);
    if (count == 0 || rays[0] == 0) // all frames have the same rays
        return rb_stats_median(ns, 0);
    for (size_t i = 0; i < count; i++)
        ns[i] /= rays[i];
    return rb_stats_median(ns, count);
}

// A time that each sample has, extrapolated to a frame.
static struct rb_estimate whole_frame(const struct rb_row *row, double *ns, double frame_rays)
{
    double rays[RB_ROW_SAMPLES_MAX];
    if (row->state != RB_ROW_ESTIMATED)
        return rb_stats_median(ns, (size_t)row->sample_count);
    for (int i = 0; i < row->sample_count; i++)
        rays[i] = rb_result_rays(&row->samples[i]);
    struct rb_estimate e = rb_stats_ratio(rays, ns, (size_t)row->sample_count, row->population);
    return (struct rb_estimate){e.value * frame_rays, e.low * frame_rays, e.high * frame_rays};
}

struct rb_estimate rb_row_stage(const struct rb_row *row, enum rb_stage stage, double frame_rays)
{
    double ns[RB_ROW_SAMPLES_MAX];
    for (int i = 0; i < row->sample_count; i++)
        ns[i] = stage_ns(&row->samples[i], stage);
    return whole_frame(row, ns, frame_rays);
}

struct rb_estimate rb_row_frame(const struct rb_row *row, double frame_rays)
{
    double ns[RB_ROW_SAMPLES_MAX];
    for (int i = 0; i < row->sample_count; i++) {
        const struct rb_run_result *sample = &row->samples[i];
        ns[i] = row->state == RB_ROW_ESTIMATED ? threads_ns(sample) / rb_row_threads(row)
                                               : (double)sample->wall_ns;
    }
    return whole_frame(row, ns, frame_rays);
}

double rb_row_probe_share(const struct rb_row *row, double probe_ns)
{
    double laps = 0, ns = 0;
    for (int i = 0; i < row->sample_count; i++) {
        laps += (double)row->samples[i].recorder.laps;
        ns += threads_ns(&row->samples[i]);
    }
    return ns > 0 ? laps * probe_ns / ns : (double)NAN;
}
