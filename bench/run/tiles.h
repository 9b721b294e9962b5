// Groups of small tiles drawn at random: what rows are measured on whose frames take too long.
#ifndef RB_RUN_TILES_H
#define RB_RUN_TILES_H

#include "render/renderer.h"

// Small tiles spread well over the image.
enum { RB_SAMPLE_TILE = 16 };

struct rb_tiles {
    uint32_t *order; // all tiles of edge RB_SAMPLE_TILE, shuffled
    uint32_t total;
};

// Shuffles the tiles of a width x height image. Release with rb_free(tiles->order).
enum rb_status rb_tiles_shuffle(struct rb_tiles *tiles, int width, int height, uint64_t seed,
                                struct rb_error *error);

// Makes a run render group `g` of `size` tiles. Groups do not overlap before the image is used up.
void rb_tiles_group(const struct rb_tiles *tiles, uint32_t size, uint32_t g,
                    struct rb_run_options *how);

#endif
