// A row that is wrong gets no time. This program brings its own table of variants instead of
// src/render/variants.c: one with a kernel set that is off by an ulp at one hit in a thousand, and
// one whose shadows are wrong.
#define _POSIX_C_SOURCE 200809L
#include "bench/csv.h"
#include "bench/scene_bench.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void trace_almost(const struct rb_world *world, const struct rb_rays *rays,
                         struct rb_hits *hits)
{
    rb_kernels_naive.trace(world, rays, hits);
    for (uint32_t i = 0; i < rays->count; i++)
        if (rays->pixel[i] % 1000 == 999 && hits->prim[i] != RB_NONE)
            hits->t[i] = nextafterf(hits->t[i], 0.0f);
}

static void shadow_almost(const struct rb_world *world, struct rb_shadows *shadows)
{
    rb_kernels_naive.trace_shadow(world, shadows);
    for (uint32_t i = 0; i < shadows->count; i++)
        shadows->occluded[i] ^= shadows->pixel[i] % 1000 == 999;
}

static void trace_naive(const struct rb_world *world, const struct rb_rays *rays,
                        struct rb_hits *hits)
{
    rb_kernels_naive.trace(world, rays, hits);
}

static void shadow_naive(const struct rb_world *world, struct rb_shadows *shadows)
{
    rb_kernels_naive.trace_shadow(world, shadows);
}

static const struct rb_kernels wrong_hits = {rb_scalar_generate, trace_almost, rb_scalar_surface,
                                             rb_scalar_light, shadow_naive};
static const struct rb_kernels wrong_shadows = {rb_scalar_generate, trace_naive, rb_scalar_surface,
                                                rb_scalar_light, shadow_almost};

const struct rb_variant rb_variants[] = {
    {"naive", "", "naive", &rb_kernels_naive, RB_ACCEL_NONE, rb_schedule_serial, "", true, NULL},
    {"wrong", "", "naive", &wrong_hits, RB_ACCEL_NONE, rb_schedule_serial, "", true, NULL},
    {"dark", "", "naive", &wrong_shadows, RB_ACCEL_NONE, rb_schedule_serial, "", true, NULL},
    {"bvh", "", "wrong", &rb_kernels_bvh, RB_ACCEL_BVH, rb_schedule_serial, "", true, NULL},
    {.name = NULL},
};

const struct rb_variant *rb_variant_find(const char *name)
{
    (void)name;
    return NULL;
}

const struct rb_variant *rb_variant_fastest(void)
{
    return rb_variants;
}

bool rb_variant_available(const struct rb_variant *variant)
{
    (void)variant;
    return true;
}

const struct rb_variant *rb_variant_resolve(const struct rb_variant *variant)
{
    return variant;
}

bool rb_variant_parallel(const struct rb_variant *variant)
{
    (void)variant;
    return false;
}

static void check_csv(const struct rb_scene_bench *bench)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    rb_csv_rows(stream, bench);
    fclose(stream);
    const char *line = strstr(text, ",wrong,");
    ok(line && strstr(line, ",trace,0,2304,,,,,0,invalid"),
       "its line in the CSV has no time and says why");
    ok(strstr(text, ",bvh,1,trace,0,2304,") != NULL, "others have theirs");
    free(text);
}

int main(void)
{
    static struct rb_scene_bench bench;
    struct rb_settings settings = {.width = 48, .height = 48};
    struct rb_error error = {0};
    struct rb_scene scene;
    if (rb_scene_load("balls_low", NULL, &scene, &error) ||
        rb_scene_bench_run(&bench, "balls_low", &scene, &settings, 0.1, &error)) {
        ok(false, "%s", error.text);
        return done();
    }
    const struct rb_row *wrong = rb_scene_bench_row(&bench, "wrong");
    const struct rb_row *dark = rb_scene_bench_row(&bench, "dark");
    ok(bench.mismatch, "the benchmark knows that a row disagrees");
    ok(wrong->state == RB_ROW_INVALID && !rb_row_has_time(wrong), "hits off by an ulp: no time");
    ok(dark->state == RB_ROW_INVALID && !rb_row_has_time(dark), "wrong shadows: no time");
    ok(rb_row_has_time(rb_scene_bench_row(&bench, "naive")), "the reference has its time");
    ok(rb_row_has_time(rb_scene_bench_row(&bench, "bvh")), "a row that agrees has its time");
    check_csv(&bench);
    rb_scene_bench_free(&bench);
    rb_scene_free(&scene);
    return done();
}
