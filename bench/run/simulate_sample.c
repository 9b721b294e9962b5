#include "bench/run/simulate_sample.h"

#include "base/memory.h"
#include "bench/run/tiles.h"
#include "render/renderer.h"
#include "scene/load.h"

#include <math.h>

enum {
    SAMPLES = 512,
    COSTS = 1 << RB_COUNT_NODES | 1 << RB_COUNT_SPHERES | 1 << RB_COUNT_TRIANGLES |
            1 << RB_COUNT_CONES | 1 << RB_COUNT_PLANES | 1 << RB_COUNT_SHADINGS,
};

// What each tile of the renderer's frame costs; to be released with rb_free.
static enum rb_status count_tiles(struct rb_renderer *renderer, double **costs,
                                  struct rb_error *error)
{
    static struct rb_count_table table; // too large for the stack
    const struct rb_settings *settings = rb_renderer_settings(renderer);
    size_t width = (size_t)settings->width, height = (size_t)settings->height;
    size_t edge = (size_t)settings->tile, across = (width - 1) / edge + 1;
    uint64_t *pixels = rb_alloc(width * height, sizeof *pixels);
    *costs = rb_alloc(rb_renderer_tile_count(renderer), sizeof **costs);
    if (pixels && *costs) {
        struct rb_run_result result;
        struct rb_run_options how = {.counts = &table, .heat = pixels, .heat_of = COSTS};
        rb_renderer_run(renderer, &how, &result);
        for (size_t i = 0; i < width * height; i++)
            (*costs)[i / width / edge * across + i % width / edge] += (double)pixels[i];
    }
    bool failed = !pixels || !*costs;
    rb_free(pixels);
    return failed ? rb_error_memory(error, "the choice of tiles") : RB_OK;
}

static enum rb_status find_best(const double *costs, uint32_t all, uint32_t count, uint64_t *seed,
                                struct rb_error *error)
{
    double total = 0, least = (double)INFINITY;
    for (uint32_t i = 0; i < all; i++)
        total += costs[i];
    for (uint64_t candidate = 0; candidate < SAMPLES; candidate++) {
        struct rb_tiles tiles;
        struct rb_run_options how;
        double sum = 0;
        if (rb_tiles_runs(&tiles, all, count, candidate, &how, error))
            return RB_FAILED;
        for (uint32_t i = 0; i < count; i++)
            sum += costs[tiles.order[i]];
        rb_free(tiles.order);
        double off = fabs(sum / count - total / all);
        if (off < least) {
            least = off;
            *seed = candidate;
        }
    }
    return RB_OK;
}

enum rb_status rb_simulate_choose_sample(const struct rb_cell *cell,
                                         const struct rb_settings *settings, uint32_t count,
                                         uint64_t *seed, struct rb_error *error)
{
    struct rb_scene scene;
    const struct rb_nff_options options = {0};
    struct rb_renderer *renderer = NULL;
    double *costs = NULL;
    *seed = 0;
    enum rb_status status = rb_scene_load(cell->reference->scene_name, &options, &scene, error);
    if (status)
        return status;
    status = rb_renderer_create(&scene, rb_variant_find("bvh"), settings, &renderer, error);
    uint32_t all = status ? 0 : rb_renderer_tile_count(renderer);
    if (status == RB_OK && count < all) {
        status = count_tiles(renderer, &costs, error);
        if (status == RB_OK)
            status = find_best(costs, all, count, seed, error);
    }
    rb_free(costs);
    rb_renderer_free(renderer);
    rb_scene_free(&scene);
    return status;
}
