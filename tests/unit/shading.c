// Shading against double precision: powers, Snell's law, total internal reflection in a glass
// prism, and the media a ray remembers through nested and overlapping glass.
#include "kernels/shade.h"
#include "render/queues.h"
#include "render/variants.h"
#include "tests/support/reference.h"
#include "tests/unit/tap.h"

#include <stdlib.h>

enum { BATCH = 1024 };

static struct rb_queues queues;
static struct rb_error failure;

static void check(enum rb_status status)
{
    if (status != RB_OK) {
        printf("Bail out! %s\n", failure.text);
        exit(1);
    }
}

// rb_power(x, n) is 2^(n log2 x); the error of the logarithm, half an ulp of the product n log2 x,
// counts in full. So the limit is relative for the result and grows with n log2 x, which is at
// least -126 where the result is not 0.
static void test_power(void)
{
    struct ref_random random = {1};
    double worst = 0.0, worst_x = 0.0, worst_n = 0.0, biggest_small = 0.0;
    for (int i = 0; i < 2000000; i++) {
        float n = (float)pow(10.0, ref_between(&random, 0.0, 5.0));
        // Half of the cosines where the power is not negligible.
        double y = ref_between(&random, 0.0, 126.0) / (double)n;
        float x = (float)(i % 2 ? exp2(-y) : ref_uniform(&random));
        double exact = pow((double)x, (double)n), got = (double)rb_power(x, n);
        if (exact < 0x1p-126) {
            biggest_small = fmax(biggest_small, got);
            continue;
        }
        double exponent = fmax(-log2(exact), 1.0);
        double units = fabs(got - exact) / exact / exponent * 0x1p24;
        if (units > worst)
            worst = units, worst_x = (double)x, worst_n = (double)n;
    }
    note("rb_power: worst relative error %.2f * 2^-24 per unit of the exponent, at %a^%a", worst,
         worst_x, worst_n);
    ok(worst <= 4.0, "powers are within 4 * 2^-24 per unit of the binary exponent");
    ok(biggest_small <= 0x1.1p-126, "powers below the smallest normal number are about 0");
    ok(rb_power(1.0f, 1e5f) == 1.0f && rb_power(2.0f, 1e5f) == 1.0f, "1^n is 1; x is limited to 1");
    ok(rb_power(0.0f, 0.0f) == 1.0f && rb_power(0.0f, 1.0f) == 0.0f, "0^0 is 1, 0^1 is 0");
    ok(rb_power(-1.0f, 3.0f) == 0.0f && rb_power(NAN, 3.0f) == 0.0f, "negative and NaN give 0");
    bool falls = true;
    for (float x = 1.0f, last = 1.0f; x > 0.99f; x = nextafterf(x, 0.0f)) {
        float value = rb_power(x, 1e5f);
        falls = falls && value <= last * (1.0f + 0x1p-20f);
        last = value;
    }
    ok(falls, "x^100000 does not rise as x falls from 1 by single ulps");
}

// Random directions, normals and pairs of media.
static void test_snell(void)
{
    struct ref_random random = {2};
    double worst = 0.0;
    int wrong = 0, total = 0, count = 200000;
    for (int i = 0; i < count; i++) {
        double d[3], n[3];
        ref_direction(&random, d);
        ref_direction(&random, n);
        struct rb_vec df = rb_normalize((struct rb_vec){(float)d[0], (float)d[1], (float)d[2]});
        struct rb_vec nf = rb_normalize((struct rb_vec){(float)n[0], (float)n[1], (float)n[2]});
        float from = (float)ref_between(&random, 1.0, 2.5), to = i % 2 ? 1.0f : 1.2f;
        nf = rb_turned(nf, df);
        double dd[3] = {(double)df.x, (double)df.y, (double)df.z};
        double nn[3] = {(double)nf.x, (double)nf.y, (double)nf.z}, out[3];
        ref_normalize(dd), ref_normalize(nn);
        double cosine = -ref_dot(dd, nn), eta = (double)from / (double)to;
        double k = 1.0 - eta * eta * (1.0 - cosine * cosine);
        struct rb_vec got;
        bool passes = rb_refract(df, nf, from, to, &got);
        total += !passes;
        if (passes != (k >= 0.0)) {
            wrong += fabs(k) > 1e-6;
            continue;
        }
        if (!passes || k < 1e-6)
            continue;
        for (int j = 0; j < 3; j++)
            out[j] = eta * dd[j] + (eta * cosine - sqrt(k)) * nn[j];
        double off[3] = {(double)got.x - out[0], (double)got.y - out[1], (double)got.z - out[2]};
        worst = fmax(worst, ref_length(off) * sqrt(k));
    }
    note("rb_refract: worst error %.2f * 2^-24 / cos(refraction), %d of %d totally reflected",
         worst * 0x1p24, total, count);
    ok(wrong == 0, "total internal reflection where Snell says so");
    ok(worst <= 32 * 0x1p-24, "refracted directions are within 32 * 2^-24 / cosine");
}

// ---- scenes

struct stage {
    struct rb_scene scene;
    struct rb_world world;
};

static struct rb_scene_builder begin(void)
{
    return (struct rb_scene_builder){.camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 45.0, 0.01, 8, 8}};
}

static void add_glass(struct rb_scene_builder *builder, double ior)
{
    check(rb_scene_add_material(builder, (const double[3]){1, 1, 1}, 0, 0, 1, 1, ior, &failure));
}

static void finish(struct rb_scene_builder *builder, struct stage *stage)
{
    check(rb_scene_finish(builder, &stage->scene, &failure));
    stage->world = (struct rb_world){.scene = &stage->scene};
}

// One ray, followed through one hit: its refracted child is in the queue of bounce 1 afterwards.
struct step {
    uint32_t prim;
    bool refracted;
    double o[3], d[3];
    uint64_t media;
};

static struct step follow(const struct stage *stage, const double o[3], const double d[3],
                          uint32_t self, uint64_t media)
{
    struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 1, BATCH);
    struct rb_rays reflected = rb_rays_view(&queues.rays[1], 0, 0, BATCH);
    struct rb_rays refracted = rb_rays_view(&queues.rays[1], BATCH, 0, BATCH);
    struct rb_shading shading = {.light_scale = 1.0f};
    uint64_t rgb[3] = {0};
    struct rb_film film = {.rgb = rgb, .width = 1, .height = 1};
    *rays.ox = (float)o[0], *rays.oy = (float)o[1], *rays.oz = (float)o[2];
    *rays.dx = (float)d[0], *rays.dy = (float)d[1], *rays.dz = (float)d[2];
    *rays.weight = 1.0f, *rays.pixel = 0, *rays.path = 1;
    *rays.self = self, *rays.media = media;
    queues.surfaces.count = 0;
    rb_kernels_naive.trace(&stage->world, &rays, &queues.hits);
    rb_kernels_naive.surface(&stage->world, &shading, &rays, &queues.hits, &queues.surfaces,
                             &reflected, &refracted, &film);
    struct step step = {.prim = queues.hits.prim[0], .refracted = refracted.count == 1};
    if (step.refracted) {
        const struct rb_rays *r = &refracted;
        step.media = *r->media;
        step.o[0] = (double)*r->ox, step.o[1] = (double)*r->oy, step.o[2] = (double)*r->oz;
        step.d[0] = (double)*r->dx, step.d[1] = (double)*r->dy, step.d[2] = (double)*r->dz;
    }
    return step;
}

// Index of refraction of the innermost medium.
static double ior_of(const struct stage *stage, uint64_t media)
{
    return (double)stage->scene.media[media & 0xffff];
}

// The medium after each crossing of a straight path along the x axis. Where all crossings are at
// right angles nothing bends.
static void expect_media(const struct stage *stage, const char *name, double start, uint64_t media,
                         const double *expected)
{
    double o[3] = {start, 0, 0}, d[3] = {1, 0, 0};
    uint32_t self = RB_NONE;
    bool right = true;
    int count = 0;
    for (; expected[count] > 0.0; count++) {
        struct step step = follow(stage, o, d, self, media);
        if (!step.refracted || fabs(ior_of(stage, step.media) - expected[count]) > 1e-6) {
            note("crossing %d: primitive %u, refracted %d, medium %g instead of %g", count,
                 step.prim, step.refracted, ior_of(stage, step.media), expected[count]);
            right = false;
            break;
        }
        for (int k = 0; k < 3; k++)
            o[k] = step.o[k], d[k] = step.d[k];
        self = step.prim, media = step.media;
    }
    struct step last = follow(stage, o, d, self, media);
    ok(right && last.prim == RB_NONE, "%s: %d crossings, each into the right medium", name, count);
}

static void test_media(void)
{
    struct stage stage;
    struct rb_scene_builder builder = begin();
    add_glass(&builder, 1.5);
    check(rb_scene_add_sphere(&builder, (const double[3]){0, 0, 0}, 2.0, &failure));
    add_glass(&builder, 1.2);
    check(rb_scene_add_sphere(&builder, (const double[3]){0, 0, 0}, 1.0, &failure));
    finish(&builder, &stage);
    expect_media(&stage, "nested spheres", -5.0, 0, (const double[]){1.5, 1.2, 1.5, 1.0, 0});
    // A camera inside glass: the ray has entered nothing, so it is outside for what it knows, and
    // leaving a body leads to the outside.
    expect_media(&stage, "camera in the shell", -1.5, 0, (const double[]){1.2, 1.0, 1.0, 0});
    expect_media(&stage, "camera in the core", 0.0, 0, (const double[]){1.0, 1.0, 0});
    rb_scene_free(&stage.scene);

    builder = begin();
    add_glass(&builder, 1.5);
    check(rb_scene_add_sphere(&builder, (const double[3]){0, 0, 0}, 1.0, &failure));
    add_glass(&builder, 1.2);
    check(rb_scene_add_sphere(&builder, (const double[3]){1, 0, 0}, 1.0, &failure));
    finish(&builder, &stage);
    expect_media(&stage, "overlapping spheres", -5.0, 0, (const double[]){1.5, 1.2, 1.2, 1.0, 0});
    rb_scene_free(&stage.scene);

    builder = begin();
    const double twice[] = {1.2, 1.5, 1.2, 1.5, 1.5, 1.0, 0};
    add_glass(&builder, 1.2);
    check(rb_scene_add_sphere(&builder, (const double[3]){0, 0, 0}, 3.0, &failure));
    add_glass(&builder, 1.5); // two bodies of one glass, one of them halfway out of the third
    check(rb_scene_add_sphere(&builder, (const double[3]){-1, 0, 0}, 0.5, &failure));
    check(rb_scene_add_sphere(&builder, (const double[3]){3, 0, 0}, 1.0, &failure));
    finish(&builder, &stage);
    expect_media(&stage, "one glass twice", -5.0, 0, twice);
    rb_scene_free(&stage.scene);
}

// Four nested shells fill the stack; a fifth pushes the outermost out.
static void test_depth_of_stack(void)
{
    struct stage stage;
    struct rb_scene_builder builder = begin();
    for (int i = 0; i < 4; i++) {
        add_glass(&builder, 1.1 + 0.1 * i);
        check(rb_scene_add_sphere(&builder, (const double[3]){0, 0, 0}, 4.0 - i, &failure));
    }
    finish(&builder, &stage);
    expect_media(&stage, "four shells", -9.0, 0,
                 (const double[]){1.1, 1.2, 1.3, 1.4, 1.3, 1.2, 1.1, 1.0, 0});
    rb_scene_free(&stage.scene);
}

// Shadow rays that the light at (x, 0, 0) gets from a ray that starts at the origin along +x,
// inside a closed surface of radius 1: 0 if the surface hides the light from its own inside.
static uint32_t lights_from_inside(double x, bool cylinder, double t)
{
    struct stage stage;
    struct rb_scene_builder builder = begin();
    struct rb_shading shading = {
        .light_scale = 1, .light_samples = 1, .strata_x = 1, .strata_y = 1};
    const double white[3] = {1, 1, 1}, light[3] = {x, 0, 0}, origin[3] = {0, 0, 0};
    check(rb_scene_add_light(&builder, light, white, &failure));
    check(rb_scene_add_material(&builder, white, 1, 0, 1, t, 1.2, &failure));
    check(cylinder ? rb_scene_add_cone(&builder, (const double[3]){0, 0, -1}, 1,
                                       (const double[3]){0, 0, 1}, 1, &failure)
                   : rb_scene_add_sphere(&builder, origin, 1, &failure));
    finish(&builder, &stage);
    follow(&stage, origin, (const double[3]){1, 0, 0}, RB_NONE, 0);
    queues.shadows.count = 0;
    rb_kernels_naive.light(&stage.world, &shading, &queues.surfaces, &(struct rb_light_sample){0},
                           &queues.shadows);
    uint32_t count = queues.shadows.count;
    if (count) {
        rb_kernels_naive.trace_shadow(&stage.world, &queues.shadows);
        count = !queues.shadows.occluded[0];
    }
    rb_scene_free(&stage.scene);
    return count;
}

static void test_own_shadow(void)
{
    for (int cylinder = 0; cylinder < 2; cylinder++) {
        const char *name = cylinder ? "cylinder" : "sphere";
        ok(lights_from_inside(0.5, cylinder, 0) == 1, "a lamp inside a %s lights its wall", name);
        ok(lights_from_inside(-5, cylinder, 0) == 0, "a lamp outside of a %s does not", name);
        ok(lights_from_inside(-5, cylinder, 1) == 1, "unless the %s is of glass", name);
    }
}

static void add_quad(struct rb_scene_builder *builder, const double a[3], const double b[3],
                     const double c[3], const double d[3])
{
    double v[2][3][3];
    for (int k = 0; k < 3; k++) {
        v[0][0][k] = a[k], v[0][1][k] = b[k], v[0][2][k] = c[k];
        v[1][0][k] = c[k], v[1][1][k] = d[k], v[1][2][k] = a[k];
    }
    check(rb_scene_add_triangle(builder, (const double(*)[3])v[0], NULL, &failure));
    check(rb_scene_add_triangle(builder, (const double(*)[3])v[1], NULL, &failure));
}

// A right-angled prism of index 1.5 along z: legs x = 0 and y = 0, hypotenuse x + y = 1.
static void build_prism(struct stage *stage)
{
    const double low = -10.0, high = 10.0;
    const double a[3] = {0, 0, low}, b[3] = {1, 0, low}, c[3] = {0, 1, low};
    const double d[3] = {0, 0, high}, e[3] = {1, 0, high}, f[3] = {0, 1, high};
    const double ends[2][3][3] = {{{0, 0, low}, {0, 1, low}, {1, 0, low}},
                                  {{0, 0, high}, {1, 0, high}, {0, 1, high}}};
    struct rb_scene_builder builder = begin();
    add_glass(&builder, 1.5);
    add_quad(&builder, a, b, e, d);
    add_quad(&builder, b, c, f, e);
    add_quad(&builder, c, a, d, f);
    check(rb_scene_add_triangle(&builder, ends[0], NULL, &failure));
    check(rb_scene_add_triangle(&builder, ends[1], NULL, &failure));
    finish(&builder, stage);
}

// Rays through the leg y = 0 meet the hypotenuse from inside at angles around the critical one,
// asin(1 / 1.5) = 41.81 degrees. In the plane of the section: the ray enters at angle a to the
// leg's normal, is bent to b, and meets the hypotenuse at 45 degrees - b.
static void test_prism(void)
{
    struct stage stage;
    struct ref_random random = {3};
    int wrong = 0, total = 0, count = 20000;
    double worst = 0.0;
    build_prism(&stage);
    for (int i = 0; i < count; i++) {
        double a = ref_between(&random, -0.6, 0.6), x = ref_between(&random, 0.4, 0.9);
        double d[3] = {sin(a), cos(a), 0}, target[3] = {x, 0, ref_between(&random, -1, 1)}, o[3];
        ref_along(target, -1.0, d, o);
        struct step first = follow(&stage, o, d, RB_NONE, 0);
        double b = asin(sin(a) / 1.5), meets = acos(-1.0) / 4.0 - b, sine = 1.5 * sin(meets);
        double across = x + (1.0 - x) * sin(b) / (sin(b) + cos(b)); // where it meets it
        if (!first.refracted || fabs(sine - 1.0) < 1e-5 || across < 0.01 || across > 0.99)
            continue;
        worst = fmax(worst, fabs(first.d[0] - sin(b)) + fabs(first.d[1] - cos(b)));
        struct step second = follow(&stage, first.o, first.d, first.prim, first.media);
        total += sine > 1.0;
        wrong += second.prim / 2 != 1 || second.refracted != (sine < 1.0) ||
                 (second.refracted && ior_of(&stage, second.media) != 1.0);
    }
    note("prism: %d of %d rays totally reflected; directions inside within %.2g", total, count,
         worst);
    ok(total > count / 4 && total < 3 * count / 4, "both kinds of rays occur");
    ok(wrong == 0, "each is totally reflected or leaves the prism as Snell says");
    ok(worst < 1e-6, "directions inside the prism agree with Snell's law");
    rb_scene_free(&stage.scene);
}

int main(void)
{
    check(rb_queues_alloc(&queues, BATCH, 2, &failure));
    test_power();
    test_snell();
    test_media();
    test_depth_of_stack();
    test_own_shadow();
    test_prism();
    rb_queues_free(&queues);
    return done();
}
