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
    struct rb_run_result samples[RB_ROW_SAMPLES_MAX];
    int sample_count;
    double population; // of groups, where they are a sample
};

// A tile edge that makes a sample of tiles spread well over the image.
enum { RB_SAMPLE_TILE = 16, RB_SAMPLE_GROUPS = 8 };

// The tiles (of edge RB_SAMPLE_TILE) all rows are verified on, and sampled rows are timed on, in
// RB_SAMPLE_GROUPS groups of equal size.
struct rb_tile_sample {
    uint32_t *tiles;
    uint32_t count, total;
};

// All tiles in random order (seeded); `count` starts out as all of them. Release with rb_free.
enum rb_status rb_tile_sample_draw(struct rb_tile_sample *sample, int width, int height,
                                   uint64_t seed, struct rb_error *error);

// Rays of trace and trace_shadow, all bounces.
double rb_result_rays(const struct rb_run_result *result);

// ns of thread time per ray of a kernel at a bounce. NaN where there was no ray.
struct rb_estimate rb_row_cell(const struct rb_row *row, enum rb_stage stage, int bounce);

// Wall time of a frame that has `frame_rays` rays, in ns.
struct rb_estimate rb_row_frame(const struct rb_row *row, double frame_rays);

// Share of the time that reading the clock takes, given what one reading costs.
double rb_row_probe_share(const struct rb_row *row, double probe_ns);

#endif
