#include "bench/row.h"

#include "base/hash.h"
#include "base/memory.h"

#include <math.h>

enum rb_status rb_tile_sample_draw(struct rb_tile_sample *sample, int width, int height,
                                   uint64_t seed, struct rb_error *error)
{
    uint32_t columns = (uint32_t)(width - 1) / RB_SAMPLE_TILE + 1;
    uint32_t rows = (uint32_t)(height - 1) / RB_SAMPLE_TILE + 1;
    sample->total = sample->count = columns * rows;
    sample->tiles = rb_alloc(sample->total, sizeof *sample->tiles);
    if (!sample->tiles)
        return rb_error_memory(error, "the sample of tiles");
    for (uint32_t i = 0; i < sample->total; i++) { // Fisher and Yates, inside out
        uint32_t j = (uint32_t)(rb_hash_word(seed, i) % (i + 1));
        sample->tiles[i] = sample->tiles[j];
        sample->tiles[j] = i;
    }
    return RB_OK;
}

double rb_result_rays(const struct rb_run_result *result)
{
    uint64_t rays = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        rays += result->recorder.tally[RB_STAGE_TRACE][bounce].rays +
                result->recorder.tally[RB_STAGE_TRACE_SHADOW][bounce].rays;
    return (double)rays;
}

struct rb_estimate rb_row_cell(const struct rb_row *row, enum rb_stage stage, int bounce)
{
    double ns[RB_ROW_SAMPLES_MAX], rays[RB_ROW_SAMPLES_MAX];
    size_t count = 0;
    for (int i = 0; i < row->sample_count; i++) {
        const struct rb_tally *tally = &row->samples[i].recorder.tally[stage][bounce];
        if (tally->rays == 0)
            continue;
        ns[count] = (double)tally->ticks * rb_clock_ns_per_tick();
        rays[count++] = (double)tally->rays;
    }
    if (row->state == RB_ROW_ESTIMATED)
        return rb_stats_ratio(rays, ns, count, row->population);
    for (size_t i = 0; i < count; i++)
        ns[i] /= rays[i];
    return rb_stats_median(ns, count);
}

struct rb_estimate rb_row_frame(const struct rb_row *row, double frame_rays)
{
    double ns[RB_ROW_SAMPLES_MAX], rays[RB_ROW_SAMPLES_MAX];
    for (int i = 0; i < row->sample_count; i++) {
        ns[i] = (double)row->samples[i].wall_ns;
        rays[i] = rb_result_rays(&row->samples[i]);
    }
    if (row->state != RB_ROW_ESTIMATED)
        return rb_stats_median(ns, (size_t)row->sample_count);
    struct rb_estimate per_ray =
        rb_stats_ratio(rays, ns, (size_t)row->sample_count, row->population);
    return (struct rb_estimate){per_ray.value * frame_rays, per_ray.low * frame_rays,
                                per_ray.high * frame_rays};
}

double rb_row_probe_share(const struct rb_row *row, double probe_ns)
{
    double laps = 0, ns = 0;
    for (int i = 0; i < row->sample_count; i++) {
        laps += (double)row->samples[i].recorder.laps;
        for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
            ns += (double)rb_recorder_stage_ticks(&row->samples[i].recorder, stage) *
                  rb_clock_ns_per_tick();
    }
    return ns > 0 ? laps * probe_ns / ns : (double)NAN;
}
