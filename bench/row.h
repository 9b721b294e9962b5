// One row of the table on one scene, measured: either whole frames, again and again, or, where a
// frame would take too long, groups of tiles drawn at random.
#ifndef RB_BENCH_ROW_H
#define RB_BENCH_ROW_H

#include "bench/stats.h"
#include "render/renderer.h"

#include <stdbool.h>

enum { RB_ROW_SAMPLES_MAX = 64 };

enum rb_row_state {
    RB_ROW_UNAVAILABLE, // the build lacks what the row needs
    RB_ROW_INVALID,     // its pixels or hits differ from the reference: it gets no time
    RB_ROW_MEASURED,    // samples are whole frames
    RB_ROW_ESTIMATED,   // samples are groups of tiles
};

struct rb_row {
    const struct rb_variant *variant;
    enum rb_row_state state;
    struct rb_renderer *renderer;
    struct rb_run_result *samples; // room for RB_ROW_SAMPLES_MAX
    int sample_count;
    double population; // of groups, where samples are groups
};

static inline bool rb_row_has_time(const struct rb_row *row)
{
    return row->state >= RB_ROW_MEASURED && row->sample_count > 0;
}

// Threads that took part in the first sample; 0 if there is none.
int rb_row_threads(const struct rb_row *row);

// Rays of trace and trace_shadow, all bounces.
double rb_result_rays(const struct rb_run_result *result);

// ns per ray of a kernel at a bounce: elapsed time of the threads, added up. NaN where there was no
// ray.
struct rb_estimate rb_row_cell(const struct rb_row *row, enum rb_stage stage, int bounce);

// ns of a stage that has no rays, for a whole frame of `frame_rays` rays.
struct rb_estimate rb_row_stage(const struct rb_row *row, enum rb_stage stage, double frame_rays);

// Wall time of a frame that has `frame_rays` rays, in ns. From groups of tiles: the elapsed time of
// all threads, shared evenly among them.
struct rb_estimate rb_row_frame(const struct rb_row *row, double frame_rays);

// Share of the time that reading the clock takes, given what one reading costs.
double rb_row_probe_share(const struct rb_row *row, double probe_ns);

#endif
