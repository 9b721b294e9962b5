#include "bench/tiles.h"

#include "base/hash.h"
#include "base/memory.h"

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

static double pilot_s(const struct rb_tiles *tiles, struct rb_renderer *renderer, uint32_t count)
{
    struct rb_run_options options = {.tiles = tiles->order, .tile_count = count};
    struct rb_run_result result;
    rb_renderer_run(renderer, &options, &result);
    return (double)result.wall_ns * 1e-9 / count;
}

void rb_tiles_fit(struct rb_tiles *tiles, struct rb_renderer *renderer, double budget_s)
{
    double tile_s = pilot_s(tiles, renderer, 1);
    if (tile_s * RB_GROUPS_MAX < 0.1 * budget_s && tiles->total >= RB_GROUPS_MAX)
        tile_s = pilot_s(tiles, renderer, RB_GROUPS_MAX);
    double affordable = budget_s / tile_s;
    uint32_t count = affordable < tiles->total ? (uint32_t)affordable : tiles->total;
    count = count ? count : 1;
    if (count == tiles->total) {
        tiles->group_count = 1;
        tiles->group_size = count;
        return;
    }
    tiles->group_count = count < RB_GROUPS_MAX ? count : RB_GROUPS_MAX;
    tiles->group_size = count / tiles->group_count;
}

bool rb_tiles_complete(const struct rb_tiles *tiles)
{
    return tiles->group_count * tiles->group_size == tiles->total;
}

void rb_tiles_run(const struct rb_tiles *tiles, uint32_t g, struct rb_renderer *renderer,
                  struct rb_run_result *result)
{
    struct rb_run_options options = {
        .tiles = tiles->order + g * tiles->group_size,
        .tile_count = tiles->group_size,
        .hash_hits = true,
    };
    rb_renderer_run(renderer, &options, result);
}
