#include "bench/run/tiles.h"

#include "base/hash.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum rb_status rb_tiles_shuffle(struct rb_tiles *tiles, int width, int height, uint64_t seed,
                                struct rb_error *error)
{
    uint32_t columns = (uint32_t)(width - 1) / RB_SAMPLE_TILE + 1;
    uint32_t rows = (uint32_t)(height - 1) / RB_SAMPLE_TILE + 1;
    tiles->total = columns * rows;
    tiles->order = rb_alloc(tiles->total, sizeof *tiles->order);
    if (!tiles->order)
        return rb_error_memory(error, "the sample of tiles");
    for (uint32_t i = 0; i < tiles->total; i++) { // Fisher and Yates, inside out
        uint32_t j = (uint32_t)(rb_hash_word(seed, i) % (i + 1));
        tiles->order[i] = tiles->order[j];
        tiles->order[j] = i;
    }
    return RB_OK;
}

void rb_tiles_group(const struct rb_tiles *tiles, uint32_t size, uint32_t g,
                    struct rb_run_options *how)
{
    size = size < tiles->total ? size : tiles->total;
    uint32_t groups = tiles->total / size;
    how->tiles = tiles->order + (size_t)(g % groups) * size;
    how->tile_count = size;
}

enum rb_status rb_tiles_runs(struct rb_tiles *tiles, uint32_t all, uint32_t count, uint64_t seed,
                             struct rb_run_options *how, struct rb_error *error)
{
    count = count < all ? count : all;
    tiles->total = 2 * count;
    tiles->order = rb_alloc(tiles->total, sizeof *tiles->order);
    if (!tiles->order)
        return rb_error_memory(error, "the sample of tiles");
    uint64_t runs = (uint64_t)ceil(sqrt(count));
    uint32_t used = 0;
    for (uint64_t run = 0; run < runs; run++) {
        // Each run has its share of the tiles, and of those that are left over.
        uint64_t begin = run * (all - count) / runs, end = (run + 1) * (all - count) / runs;
        uint32_t skipped = (uint32_t)(begin + rb_hash_word(seed, run) % (end - begin + 1));
        for (uint32_t last = (uint32_t)((run + 1) * count / runs); used < last; used++)
            tiles->order[used] = skipped + used;
    }
    memcpy(tiles->order + count, tiles->order, count * sizeof *tiles->order);
    how->tiles = tiles->order;
    how->tile_count = tiles->total;
    how->simulate_from = count;
    return RB_OK;
}
