// Every way to use Embree answers recorded rays as the norm does, but for a few; what differs is
// counted; and what it cannot do is refused.
#define _XOPEN_SOURCE 700
#include "embree/embree.h"
#include "bench/replay/record.h"
#include "render/embree_rows.h"
#include "render/renderer.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/raybench-embree-XXXXXX";
static struct rb_scene scene;

// Shares of rays that may be answered otherwise. Measured: 0.013 % or less, and 0.25 % of the
// shadow rays from a far light.
static const double MOST = 0.001, MOST_FROM_LIGHT = 0.01;

static bool record(const char *name)
{
    struct rb_arguments arguments = {
        .positional = {name},
        .positional_count = 1,
        .settings = {.width = 96, .height = 96, .depth = 3},
        .output = path,
        .quiet = true,
        .bench = {.classes = "all"},
    };
    return rb_command_record.run(&arguments) == 0;
}

static const struct {
    enum rb_ray_class ray_class;
    enum rb_stage kernel;
} cells[] = {
    {RB_CLASS_IMAGE, RB_STAGE_TRACE},      {RB_CLASS_IMAGE, RB_STAGE_TRACE_SHADOW},
    {RB_CLASS_DIFFUSE, RB_STAGE_TRACE},    {RB_CLASS_REFLECTION, RB_STAGE_TRACE},
    {RB_CLASS_REFRACTION, RB_STAGE_TRACE}, {RB_CLASS_SHADOW, RB_STAGE_TRACE_SHADOW},
};
enum { CELL_COUNT = sizeof cells / sizeof *cells };

static struct rb_record records[CELL_COUNT];

static struct rb_replay replay_of(int cell)
{
    return (struct rb_replay){cells[cell].kernel, records[cell].batches.data,
                              records[cell].batches.count, 1};
}

static struct rb_replay_difference compare(struct rb_renderer *renderer, int cell)
{
    struct rb_replay replay = replay_of(cell);
    struct rb_replay_difference difference = {0, 0};
    rb_replay_difference(renderer, &replay, 0, replay.count, &difference);
    return difference;
}

static void check_row(const char *name, const struct rb_variant *row)
{
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    double most = strstr(row->name, "-light") ? MOST_FROM_LIGHT : MOST;
    bool few = true;
    if (rb_renderer_create(&scene, row, &records[0].header.settings, &renderer, &error)) {
        ok(false, "%s: %s", row->name, error.text);
        return;
    }
    for (int cell = 0; cell < CELL_COUNT; cell++) {
        struct rb_replay_difference is = compare(renderer, cell);
        if (!is.rays || (double)is.differ > most * (double)is.rays) {
            note("%s, %s: %lu of %lu rays differ", rb_ray_class_names[cells[cell].ray_class],
                 rb_stage_names[cells[cell].kernel], (unsigned long)is.differ,
                 (unsigned long)is.rays);
            few = false;
        }
    }
    ok(few, "%s: %s answers nearly all rays as the norm does", name, row->name);
    ok(rb_renderer_build_ns(renderer) > 0 && rb_renderer_tree_bytes(renderer) > 0,
       "it says what its tree takes");
    rb_renderer_free(renderer);
}

// One distance in the record 1 % off, one answer turned round: exactly these differ.
static void check_differences(void)
{
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    rb_renderer_create(&scene, rb_variant_find("bvh"), &records[0].header.settings, &renderer,
                       &error);
    struct rb_batch *rays = records[0].batches.data, *shadows = records[1].batches.data;
    ok(compare(renderer, 0).differ == 0 && compare(renderer, 1).differ == 0,
       "bvh differs in nothing");
    uint32_t i = 0;
    while (isinf(rays->hits.t[i]))
        i++;
    float t = rays->hits.t[i];
    rays->hits.t[i] = t * 1.01f;
    shadows->shadows.occluded[0] ^= 1;
    ok(compare(renderer, 0).differ == 1 && compare(renderer, 1).differ == 1,
       "a wrong distance and a wrong answer are counted");
    rays->hits.t[i] = INFINITY;
    ok(compare(renderer, 0).differ == 1, "and a miss that should be a hit");
    rays->hits.t[i] = t;
    shadows->shadows.occluded[0] ^= 1;
    rb_renderer_free(renderer);
}

static void check_refusals(void)
{
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    struct rb_settings settings = {.spd = true};
    ok(rb_renderer_create(&scene, rb_variant_find("embree"), &settings, &renderer, &error) ==
               RB_INVALID &&
           strstr(error.text, "SPD"),
       "SPD's rules are refused");
    ok(!rb_variant_find("embree")->exact && rb_variant_fastest()->exact,
       "a yardstick is not the default row");
}

// A ray that is not finite misses, and does not disturb its neighbours.
static void check_not_finite(const struct rb_variant *row)
{
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    struct rb_batch *batch = records[0].batches.data;
    rb_renderer_create(&scene, row, &records[0].header.settings, &renderer, &error);
    uint32_t i = 0;
    while (isinf(batch->hits.t[i]))
        i++;
    float x = batch->rays.dx[i], t = batch->hits.t[i];
    batch->rays.dx[i] = NAN;
    batch->hits.t[i] = INFINITY;
    struct rb_replay_difference is = compare(renderer, 0);
    ok((double)is.differ <= MOST * (double)is.rays, "%s: NaN is a miss", row->name);
    batch->rays.dx[i] = x;
    batch->hits.t[i] = t;
    rb_renderer_free(renderer);
}

static void check_scene(const char *name)
{
    struct rb_error error = {0};
    struct rb_nff_options options = {0};
    bool opened = rb_scene_load(name, &options, &scene, &error) == RB_OK && record(name);
    for (int cell = 0; cell < CELL_COUNT && opened; cell++) {
        const struct rb_record_choice choice = {cells[cell].ray_class, cells[cell].kernel, -1};
        opened = rb_record_read(path, &choice, &records[cell], &error) == RB_OK;
    }
    ok(opened, "%s is recorded%s%s", name, error.text[0] ? ": " : "", error.text);
    for (const struct rb_variant *row = rb_embree_rows; row->name && opened; row++)
        if (rb_variant_available(row))
            check_row(name, row);
    for (int way = 0; way < 14 && opened; way += 2) // those of the first tree
        if (rb_variant_available(&rb_embree_rows[way]))
            check_not_finite(&rb_embree_rows[way]);
    if (opened)
        check_differences();
    for (int cell = 0; cell < CELL_COUNT; cell++) {
        rb_record_free(&records[cell]);
        records[cell] = (struct rb_record){0};
    }
    check_refusals();
    rb_scene_free(&scene);
}

int main(void)
{
    if (!rb_variant_available(rb_variant_find("embree"))) {
        printf("1..0 # SKIP no libembree in this build, or no AVX2\n");
        return 0;
    }
    int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    check_scene("balls3");
    check_scene("mount4");
    unlink(path);
    return done();
}
