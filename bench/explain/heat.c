#include "bench/explain/heat.h"

#include "base/file.h"
#include "base/memory.h"
#include "bench/data/stats.h"
#include "render/image.h"
#include "render/renderer.h"
#include "scene/load.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Frames that time is the least of.
enum { FRAMES = 5 };

// The share of pixels that are not white.
static const double SHOWN = 0.999;

enum rb_status rb_heat_find(const char *name, struct rb_heat *heat, struct rb_error *error)
{
    char names[256] = "tests, ns";
    *heat = (struct rb_heat){.name = name};
    if (strcmp(name, "ns") == 0)
        return RB_OK;
    if (strcmp(name, "tests") == 0)
        heat->counters = 1u << RB_COUNT_SPHERES | 1u << RB_COUNT_TRIANGLES | 1u << RB_COUNT_CONES |
                         1u << RB_COUNT_PLANES;
    for (int c = 0; c < RB_COUNTER_COUNT; c++) {
        if (!rb_counter_is_of_rays((enum rb_counter)c))
            continue;
        if (strcmp(name, rb_counter_names[c]) == 0)
            heat->counters = 1u << c;
        snprintf(names + strlen(names), sizeof names - strlen(names), ", %s", rb_counter_names[c]);
    }
    return heat->counters ? RB_OK
                          : rb_error_set(error, RB_INVALID, "--heatmap %.64s: expected one of %s",
                                         name, names);
}

struct picture {
    struct rb_renderer *renderer;
    int width, height;
    uint64_t *cost; // of each pixel; ticks of each tile
    double *value;  // of each pixel: counts, or ns
    double *sorted; // these values
    float *rgb;
};

static void count_pixels(struct picture *picture, const struct rb_heat *heat)
{
    static struct rb_count_table table; // too large for the stack
    size_t pixels = (size_t)picture->width * (size_t)picture->height;
    struct rb_run_result result;
    struct rb_run_options how = {
        .counts = &table, .heat = picture->cost, .heat_of = heat->counters};
    rb_renderer_run(picture->renderer, &how, &result);
    for (size_t i = 0; i < pixels; i++)
        picture->value[i] = (double)picture->cost[i];
}

static void time_tiles(struct picture *picture)
{
    struct rb_run_result result;
    struct rb_run_options how = {.tile_ticks = picture->cost};
    int tile = rb_renderer_settings(picture->renderer)->tile;
    int across = (picture->width - 1) / tile + 1;
    double ns_per_tick = rb_clock_ns_per_tick();
    for (int frame = 0; frame < FRAMES; frame++) {
        rb_renderer_run(picture->renderer, &how, &result);
        for (int y = 0; y < picture->height; y++)
            for (int x = 0; x < picture->width; x++) {
                int left = x / tile * tile, top = y / tile * tile;
                int wide = picture->width - left < tile ? picture->width - left : tile;
                int high = picture->height - top < tile ? picture->height - top : tile;
                double ns = (double)picture->cost[y / tile * across + x / tile] * ns_per_tick /
                            (wide * high);
                double *value = &picture->value[(size_t)y * (size_t)picture->width + (size_t)x];
                *value = frame == 0 || ns < *value ? ns : *value;
            }
    }
}

// Black, violet, red, orange, yellow, white: ever lighter.
static void color(double share, float rgb[3])
{
    static const float steps[][3] = {{0, 0, 0},
                                     {0.27f, 0, 0.42f},
                                     {0.73f, 0.13f, 0.31f},
                                     {0.96f, 0.48f, 0.1f},
                                     {0.98f, 0.86f, 0.3f},
                                     {1, 1, 1}};
    enum { LAST = sizeof steps / sizeof *steps - 1 };
    double at = (share < 1 ? share : 1) * LAST;
    int below = at < LAST ? (int)at : LAST - 1;
    float rest = (float)(at - below);
    for (int k = 0; k < 3; k++)
        rgb[k] = steps[below][k] + rest * (steps[below + 1][k] - steps[below][k]);
}

static enum rb_status paint(struct picture *picture, const char *path, double *white,
                            struct rb_error *error)
{
    size_t pixels = (size_t)picture->width * (size_t)picture->height;
    bool raw = strlen(path) > 4 && strcmp(path + strlen(path) - 4, ".pfm") == 0;
    const struct rb_image_format *format = rb_image_format_of(path, error);
    struct rb_output output;
    memcpy(picture->sorted, picture->value, pixels * sizeof *picture->value);
    *white = rb_stats_quantile(picture->sorted, pixels, SHOWN);
    for (size_t i = 0; i < pixels; i++) {
        float value = (float)picture->value[i];
        float rgb[3] = {value, value, value};
        if (!raw)
            color(*white > 0 ? picture->value[i] / *white : 0, rgb);
        memcpy(picture->rgb + 3 * i, rgb, sizeof rgb);
    }
    enum rb_status status = format ? rb_output_open(&output, path, error) : RB_INVALID;
    if (status)
        return status;
    if (!rb_image_write(format, output.stream, picture->rgb, picture->width, picture->height)) {
        rb_output_discard(&output);
        return rb_error_memory(error, "the picture");
    }
    return rb_output_commit(&output, error);
}

static void print_legend(const struct picture *picture, const struct rb_cell *cell,
                         const struct rb_heat *heat, const char *path, double white)
{
    size_t pixels = (size_t)picture->width * (size_t)picture->height, most = 0;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        sum += picture->value[i];
        most = picture->value[i] > picture->value[most] ? i : most;
    }
    printf("\n%s: %s per pixel of %s, %s, all kernels and bounces: mean %.4g; white is %.4g and "
           "more; most, %.4g, at pixel (%zu, %zu)%s\n",
           path, heat->name, cell->reference->scene_name, cell->variant->name, sum / (double)pixels,
           white, picture->value[most], most % (size_t)picture->width,
           most / (size_t)picture->width,
           heat->counters ? "" : "; time of blocks of 16 x 16 pixels, the least of five frames");
}

static enum rb_status draw(struct picture *picture, const struct rb_cell *cell,
                           const struct rb_heat *heat, const char *path, struct rb_error *error)
{
    const struct rb_settings *settings = rb_renderer_settings(picture->renderer);
    double white;
    picture->width = settings->width, picture->height = settings->height;
    size_t pixels = (size_t)picture->width * (size_t)picture->height;
    picture->cost = rb_alloc(pixels, sizeof *picture->cost);
    picture->value = rb_alloc(pixels, sizeof *picture->value);
    picture->rgb = rb_alloc(pixels, 3 * sizeof *picture->rgb);
    picture->sorted = rb_alloc(pixels, sizeof *picture->sorted);
    if (!picture->cost || !picture->value || !picture->sorted || !picture->rgb)
        return rb_error_memory(error, "the heat map");
    if (heat->counters)
        count_pixels(picture, heat);
    else
        time_tiles(picture);
    enum rb_status status = paint(picture, path, &white, error);
    if (status == RB_OK)
        print_legend(picture, cell, heat, path, white);
    return status;
}

enum rb_status rb_heat_write(const struct rb_cell *cell, const struct rb_heat *heat,
                             const char *path, struct rb_error *error)
{
    struct rb_scene scene;
    struct picture picture = {.renderer = NULL};
    struct rb_settings settings = cell->settings;
    const struct rb_nff_options options = {0};
    if (heat->counters && !cell->variant->counted)
        return rb_error_set(error, RB_INVALID, "%s has no kernels that count", cell->variant->name);
    if (!heat->counters)
        settings.tile = RB_BLOCK;
    enum rb_status status = rb_scene_load(cell->reference->scene_name, &options, &scene, error);
    if (status)
        return status;
    status = rb_renderer_create(&scene, cell->variant, &settings, &picture.renderer, error);
    if (status == RB_OK)
        status = draw(&picture, cell, heat, path, error);
    rb_free(picture.cost);
    rb_free(picture.value);
    rb_free(picture.sorted);
    rb_free(picture.rgb);
    rb_renderer_free(picture.renderer);
    rb_scene_free(&scene);
    return status;
}
