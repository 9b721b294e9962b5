// Exactness and identities of the pipeline: whatever the row, the tile size and the number of
// threads, the same pixels and hits; rays of a bounce follow from the hits of the one before.
#include "render/renderer.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <fenv.h>
#include <math.h>
#include <string.h>

#ifdef __x86_64__
#include <immintrin.h>
#endif

static const struct rb_settings plain = {.width = 72, .height = 56};
static const struct rb_settings rich = {.width = 40,
                                        .height = 40,
                                        .aa = 2,
                                        .light_samples = 6,
                                        .light_size = 0.5,
                                        .ambient = 0.1,
                                        .phong = true,
                                        .seed = 7};
static const struct rb_settings spd = {.width = 50, .height = 50, .spd = true};

static struct rb_run_result render(const struct rb_scene *scene, const struct rb_variant *variant,
                                   struct rb_settings settings, int tile, int threads)
{
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    struct rb_run_result result = {0};
    struct rb_run_options options = {.hash_hits = true};
    settings.tile = tile;
    settings.threads = threads;
    if (rb_renderer_create(scene, variant, &settings, &renderer, &error) == RB_OK)
        rb_renderer_run(renderer, &options, &result);
    else
        note("%s", error.text);
    rb_renderer_free(renderer);
    return result;
}

// Every row, three tile sizes, 1 and 2 threads.
static void check_exact(const struct rb_scene *scene, const char *name, const char *what,
                        const struct rb_settings *settings)
{
    struct rb_run_result expected = render(scene, rb_variants, *settings, 64, 1);
    static const int tiles[] = {16, 48, 128};
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++) {
        bool same = true;
        if (!rb_variant_available(variant) || !variant->exact)
            continue;
        for (int i = 0; i < 3; i++)
            for (int threads = 1; threads <= 2; threads++) {
                struct rb_run_result result = render(scene, variant, *settings, tiles[i], threads);
                same = same && result.image_hash == expected.image_hash &&
                       result.hits_hash == expected.hits_hash;
            }
        ok(same && expected.hits_hash, "%s, %s: %s agrees with %s for all tiles and threads", name,
           what, variant->name, rb_variants[0].name);
    }
}

static void check_counts(const struct rb_scene *scene, const char *name)
{
    struct rb_run_result result = render(scene, rb_variant_find("bvh"), plain, 64, 1);
    const struct rb_recorder *r = &result.recorder;
    bool bounces = true, shadows = true, within = true;
    uint64_t camera = r->tally[RB_STAGE_TRACE][0].rays;
    for (int b = 0; b < RB_BOUNCE_MAX; b++) {
        uint64_t traced = r->tally[RB_STAGE_TRACE][b].rays;
        if (b > 0)
            bounces = bounces && traced == r->reflected[b] + r->refracted[b] &&
                      r->reflected[b] <= r->hits[b - 1];
        within = within && r->hits[b] <= traced && r->tally[RB_STAGE_SHADE][b].rays == traced;
        shadows =
            shadows && r->tally[RB_STAGE_TRACE_SHADOW][b].rays <= r->hits[b] * scene->light_count;
    }
    ok(camera == 72 * 56 && r->tally[RB_STAGE_GENERATE][0].rays == camera,
       "%s: one camera ray per pixel", name);
    ok(bounces, "%s: rays of a bounce are the reflected and refracted rays of the one before",
       name);
    ok(within && shadows, "%s: hits and shadow rays stay within what bounds them", name);
}

static void no_shadow(void *user, const struct rb_pixel_ray *ray,
                      const struct rb_pixel_shadow *shadow)
{
    (void)user, (void)ray, (void)shadow;
}

// What the rays of a pixel add up to.
struct walked {
    int rays;
    float sum[3];
};

static void count_ray(void *user, const struct rb_pixel_ray *ray)
{
    (void)ray;
    ((struct walked *)user)->rays++;
}

static void add_local(void *user, const struct rb_pixel_ray *ray, const float added[3])
{
    (void)ray;
    for (int k = 0; k < 3; k++)
        ((struct walked *)user)->sum[k] += added[k];
}

// A pixel walked alone has the colour it has in the frame.
static void check_pixels(const struct rb_scene *scene, const char *name)
{
    static float frame[3 * 40 * 40];
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    struct rb_run_result result;
    if (rb_renderer_create(scene, rb_variant_find("bvh"), &rich, &renderer, &error)) {
        ok(false, "%s: %s", name, error.text);
        return;
    }
    rb_renderer_run(renderer, NULL, &result);
    rb_renderer_pixels(renderer, frame);
    bool same = true, adds_up = true;
    for (int i = 0; i < 40 * 40; i += 37) {
        float color[3];
        struct walked walked = {0};
        struct rb_pixel_observer observer = {&walked, count_ray, no_shadow, add_local};
        rb_renderer_pixel(renderer, i % 40, i / 40, &observer, color);
        same = same && walked.rays > 0 && memcmp(color, frame + 3 * i, sizeof color) == 0;
        for (int k = 0; k < 3; k++) // four samples; sums of up to 100 floats
            adds_up = adds_up && fabsf(walked.sum[k] / 4 - color[k]) <= 1e-5f;
    }
    ok(same, "%s: walked pixels have the colours of the frame", name);
    ok(adds_up, "%s: what the rays of a walked pixel add is its colour", name);
    rb_renderer_free(renderer);
}

// The caller's rounding mode does not matter and is not changed.
static void check_environment(const struct rb_scene *scene)
{
    struct rb_run_result expected = render(scene, rb_variant_find("bvh"), plain, 64, 1);
    fesetround(FE_UPWARD);
    struct rb_run_result result = render(scene, rb_variant_find("bvh"), plain, 64, 1);
    int mode = fegetround();
    fesetround(FE_TONEAREST);
    ok(result.image_hash == expected.image_hash && result.hits_hash == expected.hits_hash,
       "rounding upward in the caller changes nothing");
    ok(mode == FE_UPWARD, "the caller's rounding mode is restored");
#ifdef __x86_64__
    unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040); // flush to zero, denormals are zero
    result = render(scene, rb_variant_fastest(), plain, 64, 2);
    _mm_setcsr(saved);
    ok(result.image_hash == expected.image_hash && result.hits_hash == expected.hits_hash,
       "flushing denormals in the caller changes nothing");
#endif
}

// Deep trees of glass split their queues: 2^depth rays per pixel in batches of bounded size.
static void check_splitting(const struct rb_scene *scene)
{
    struct rb_settings deep = {.width = 32, .height = 32, .depth = 9};
    struct rb_run_result a = render(scene, rb_variant_find("bvh"), deep, 16, 1);
    struct rb_run_result b = render(scene, rb_variant_find("bvh"), deep, 64, 1);
    ok(a.hits_hash == b.hits_hash && a.image_hash == b.image_hash,
       "depth 9 in batches of 256 and of 4096 rays is the same");
}

int main(void)
{
    static const char *const names[] = {"balls_low", "balls_medium", "balls_high", "mount_low",
                                        "mount_high"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct rb_scene scene;
        struct rb_error error = {0};
        if (!ok(rb_scene_load(names[i], NULL, &scene, &error) == RB_OK, "%s: loaded", names[i]))
            continue;
        if (scene.primitive_count < 1000) { // the reference is slow
            check_exact(&scene, names[i], "plain", &plain);
            check_exact(&scene, names[i], "soft shadows and AA", &rich);
            check_exact(&scene, names[i], "SPD rules", &spd);
        } else {
            struct rb_settings small = {.width = 24, .height = 24};
            check_exact(&scene, names[i], "small", &small);
        }
        check_counts(&scene, names[i]);
        check_pixels(&scene, names[i]);
        if (i == 3) {
            check_environment(&scene);
            check_splitting(&scene);
        }
        rb_scene_free(&scene);
    }
    return done();
}
