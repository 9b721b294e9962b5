// Samples of tiles, for what takes too long on whole frames: groups of small tiles drawn at random,
// and runs of neighbours.
#ifndef RB_RUN_TILES_H
#define RB_RUN_TILES_H

#include "render/renderer.h"

// Small tiles spread well over the image.
enum { RB_SAMPLE_TILE = 16 };

struct rb_tiles {
    uint32_t *order; // indices of tiles
    uint32_t total;
};

// Shuffles the tiles of edge RB_SAMPLE_TILE of a width x height image. Release with
// rb_free(tiles->order).
enum rb_status rb_tiles_shuffle(struct rb_tiles *tiles, int width, int height, uint64_t seed,
                                struct rb_error *error);

// Makes a run render group `g` of `size` tiles. Groups do not overlap before the image is used up.
void rb_tiles_group(const struct rb_tiles *tiles, uint32_t size, uint32_t g,
                    struct rb_run_options *how);

// Makes a run render `count` of `all` tiles, twice in the same order: first to warm the caches,
// then as laps of a simulator. They lie in about sqrt(count) runs of neighbours, each at a random
// place in its part of the image: neighbours share what is in the caches, and runs see all of the
// scene. Release with rb_free(tiles->order).
enum rb_status rb_tiles_runs(struct rb_tiles *tiles, uint32_t all, uint32_t count, uint64_t seed,
                             struct rb_run_options *how, struct rb_error *error);

#endif
