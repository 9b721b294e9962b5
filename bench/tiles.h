// The tiles the reference is run on: a seeded random sample, in groups, sized to a time budget.
#ifndef RB_BENCH_TILES_H
#define RB_BENCH_TILES_H

#include "render/renderer.h"

// Small tiles spread well over the image. Eight groups give the interval seven degrees of freedom.
enum { RB_SAMPLE_TILE = 16, RB_GROUPS_MAX = 8 };

struct rb_tiles {
    uint32_t *order;      // all tiles of edge RB_SAMPLE_TILE, shuffled
    uint32_t total;       // tiles of the image
    uint32_t group_count; // groups in the sample
    uint32_t group_size;  // tiles in each; group g begins at order[g * group_size]
};

// Shuffles the tiles of a width x height image. Release with rb_free(tiles->order).
enum rb_status rb_tiles_shuffle(struct rb_tiles *tiles, int width, int height, uint64_t seed,
                                struct rb_error *error);

// Chooses the groups so that rendering all of them takes about `budget_s`, after timing one tile
// (or eight if they are quick). At least one tile, at most the whole image.
void rb_tiles_fit(struct rb_tiles *tiles, struct rb_renderer *renderer, double budget_s);

// Are the groups the whole image?
bool rb_tiles_complete(const struct rb_tiles *tiles);

// Renders group `g`, hits hashed.
void rb_tiles_run(const struct rb_tiles *tiles, uint32_t g, struct rb_renderer *renderer,
                  struct rb_run_result *result);

#endif
