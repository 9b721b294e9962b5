// The float kernels against the double-precision reference, on rays that are meant to break them.
//
// Every kernel set must agree with the first one bit for bit. Against the reference two figures are
// printed per class of rays: how often the answers differ, and the displacement that the worst
// answer needs: how far, in ulps (2^-24 of the largest coordinate involved), the ray or the surface
// would have to be moved to make the kernel's answer the exact one. Rates depend on how many rays a
// class aims at places where nothing can be right; the displacement has a limit.
#include "render/queues.h"
#include "render/variants.h"
#include "tests/support/ray_classes.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <string.h>

enum { BATCH = 4096, KERNELS_MAX = 32 };

static struct rb_queues queues;
static const struct rb_kernels *kernels[KERNELS_MAX]; // distinct sets of the table
static const char *kernel_names[KERNELS_MAX];
static int kernel_count;

static void list_kernels(void)
{
    for (const struct rb_variant *row = rb_variants; row->name; row++) {
        bool known = !rb_variant_available(row) || !row->exact || row->best_of;
        for (int i = 0; i < kernel_count; i++)
            known = known || kernels[i] == row->kernels;
        if (!known && kernel_count < KERNELS_MAX) {
            kernel_names[kernel_count] = row->name;
            kernels[kernel_count++] = row->kernels;
        }
    }
}

// The smallest altitude of a triangle, capped at 1.
static double altitude(const struct rb_triangle *triangle)
{
    double e[3][3], n[3], longest = 0.0;
    for (int i = 0; i < 3; i++) {
        ref_edge(triangle->v[i], triangle->v[(i + 1) % 3], e[i]);
        longest = fmax(longest, ref_length(e[i]));
    }
    ref_cross(e[0], e[1], n);
    return fmin(1.0, ref_length(n) / longest);
}

// What a class of rays came to.
struct tally {
    uint64_t rays, hits, differ, shadows, shadows_differ, inexact;
    double hit_ulps, depth_ulps, shadow_ulps, normal_ulps;
};

// 2^-24 of the largest coordinate involved, from the origin of the ray to the hit at t.
static double ulp_of(const struct rb_scene *scene, const struct ref_ray *ray, double t, uint32_t a,
                     uint32_t b)
{
    double reach = fmax(t, fmax(fabs(ray->o[0]), fmax(fabs(ray->o[1]), fabs(ray->o[2]))));
    if (a != RB_NONE)
        reach = fmax(reach, ref_reach(scene, a));
    if (b != RB_NONE)
        reach = fmax(reach, ref_reach(scene, b));
    return reach * 0x1p-24;
}

static void show(const char *what, const struct rb_rays *rays, uint32_t i, uint32_t prim, double t,
                 const struct ref_hit *exact, double ulps)
{
    static int shown;
    if (shown++ < 12)
        note("%s: {%a, %a, %a}, {%a, %a, %a}, self %u: kernel %u at %.9g, reference %u at %.9g, "
             "%.1f ulps",
             what, (double)rays->ox[i], (double)rays->oy[i], (double)rays->oz[i],
             (double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i], rays->self[i], prim, t,
             exact->prim, exact->t, ulps);
}

// Displacements beyond this are shown, and failed. A triangle may be hit past its edge by the edge
// tolerance, 8 ulps of the distance to its first vertex, more where the ray runs along the edge;
// everything else stays below 13.
#define ULPS_MAX 32.0

static void compare_hit(const struct rb_scene *scene, const struct ref_world *world,
                        const struct rb_rays *rays, const struct rb_hits *hits, uint32_t i,
                        bool one_sided, struct tally *tally)
{
    struct ref_ray ray = stage_ray(rays, i);
    ray.one_sided = one_sided;
    struct ref_hit exact = ref_closest(world, &ray);
    uint32_t prim = hits->prim[i];
    double t = (double)hits->t[i], off = 0.0;
    double ulp = ulp_of(scene, &ray, prim == RB_NONE ? 0.0 : t, prim, exact.prim);
    double limit = prim == RB_NONE ? HUGE_VAL : t;
    tally->rays++;
    tally->hits += prim != RB_NONE;
    if (prim != RB_NONE) {
        off = ref_off(scene, prim, &ray, t) / ulp;
        tally->hit_ulps = fmax(tally->hit_ulps, off);
    }
    bool same = (prim == RB_NONE) == (exact.prim == RB_NONE) &&
                (prim == RB_NONE || fabs(t - exact.t) * exact.cosine <= 16.0 * ulp);
    double depth = same ? 0.0 : ref_depth_before(scene, &ray, limit) / ulp;
    tally->differ += !same;
    tally->depth_ulps = fmax(tally->depth_ulps, depth);
    if (off > ULPS_MAX || depth > ULPS_MAX)
        show("hit", rays, i, prim, t, &exact, fmax(off, depth));
}

static void compare_shadow(const struct rb_scene *scene, const struct ref_world *world,
                           const struct rb_rays *rays, const struct rb_shadows *shadows, uint32_t i,
                           struct tally *tally)
{
    struct ref_ray ray = stage_ray(rays, i);
    ray.shadow = true;
    double distance = (double)shadows->distance[i];
    bool exact = ref_occluded(world, &ray, distance);
    tally->shadows++;
    if (exact == (bool)shadows->occluded[i])
        return;
    tally->shadows_differ++;
    double wrong =
        exact ? ref_depth_before(scene, &ray, distance) : ref_gap_before(scene, &ray, distance);
    double p[3], reach = 0.0;
    ref_along(ray.o, fmin(distance, 1e4), ray.d, p);
    for (int k = 0; k < 3; k++)
        reach = fmax(reach, fmax(fabs(ray.o[k]), fabs(p[k])));
    wrong /= reach * 0x1p-24;
    tally->shadow_ulps = fmax(tally->shadow_ulps, wrong);
    if (wrong > ULPS_MAX)
        show(exact ? "light leaks" : "false shadow", rays, i, shadows->occluded[i], distance,
             &(struct ref_hit){.prim = exact}, wrong);
}

// Shadow rays along the same lines, some ending before, some beyond what is hit.
static void fill_shadows(const struct rb_rays *rays, const struct rb_hits *hits,
                         struct ref_random *random, struct rb_shadows *shadows)
{
    size_t bytes = rays->count * sizeof(float);
    memcpy(shadows->ox, rays->ox, bytes), memcpy(shadows->dx, rays->dx, bytes);
    memcpy(shadows->oy, rays->oy, bytes), memcpy(shadows->dy, rays->dy, bytes);
    memcpy(shadows->oz, rays->oz, bytes), memcpy(shadows->dz, rays->dz, bytes);
    memcpy(shadows->self, rays->self, rays->count * sizeof *rays->self);
    for (uint32_t i = 0; i < rays->count; i++) {
        float t = hits->prim[i] == RB_NONE ? 10.0f : hits->t[i];
        shadows->distance[i] = t * (float)ref_between(random, 0.5, 3.0);
    }
    shadows->count = rays->count;
}

// Traces the batch with every kernel set; the results of the first one remain in the queues.
static uint64_t trace_all(const struct stage *stage, bool one_sided, const struct rb_rays *rays,
                          struct ref_random *random)
{
    struct rb_world world = stage->world;
    struct rb_hits *hits = &queues.hits;
    struct rb_shadows *shadows = &queues.shadows;
    static struct {
        float t[BATCH], u[BATCH], v[BATCH];
        uint32_t prim[BATCH];
        uint8_t occluded[BATCH];
    } first;
    uint64_t inexact = 0;
    world.one_sided = one_sided;
    for (int k = kernel_count - 1; k >= 0; k--) {
        kernels[k]->trace(&world, rays, hits);
        if (k == kernel_count - 1)
            fill_shadows(rays, hits, random, shadows);
        kernels[k]->trace_shadow(&world, shadows);
        for (uint32_t i = 0; k < kernel_count - 1 && i < rays->count; i++)
            inexact += memcmp(&first.t[i], &hits->t[i], sizeof(float)) != 0 ||
                       memcmp(&first.u[i], &hits->u[i], sizeof(float)) != 0 ||
                       memcmp(&first.v[i], &hits->v[i], sizeof(float)) != 0 ||
                       first.prim[i] != hits->prim[i] || first.occluded[i] != shadows->occluded[i];
        size_t bytes = rays->count * sizeof(float);
        memcpy(first.t, hits->t, bytes), memcpy(first.u, hits->u, bytes);
        memcpy(first.v, hits->v, bytes), memcpy(first.prim, hits->prim, bytes);
        memcpy(first.occluded, shadows->occluded, rays->count);
    }
    return inexact;
}

// The displacement of a point that turns the normal by one radian: the radius of curvature, 1 for
// what is flat; less on a triangle seen edge-on, where places mean little.
static double radius_at(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                        const double p[3])
{
    double normal[3], base[3], axis[3], l[3];
    switch (rb_scene_kind(scene, prim)) {
    case RB_SPHERE:
        return fabs((double)scene->spheres[prim].radius);
    case RB_TRIANGLE: {
        uint32_t index = prim - scene->first[RB_TRIANGLE];
        ref_widen(scene->triangle_normals[index], normal);
        return fabs(ref_dot(normal, ray->d)) * altitude(&scene->triangles[index]);
    }
    case RB_CONE: {
        const struct rb_cone *cone = &scene->cones[prim - scene->first[RB_CONE]];
        ref_widen(cone->base, base);
        ref_widen(cone->axis, axis);
        ref_subtract(p, base, l);
        ref_along(l, -ref_dot(l, axis), axis, l);
        return ref_length(l);
    }
    default:
        return 1.0;
    }
}

// Normals of the surface kernel, as a displacement of the point.
static void compare_normals(const struct rb_scene *scene, const struct rb_rays *rays,
                            const struct rb_hits *hits, const struct rb_surfaces *surfaces,
                            struct tally *tally)
{
    for (uint32_t i = 0, s = 0; i < rays->count; i++) {
        uint32_t prim = hits->prim[i];
        if (prim == RB_NONE)
            continue;
        struct ref_ray ray = stage_ray(rays, i);
        double p[3], n[3],
            got[3] = {(double)surfaces->nx[s], (double)surfaces->ny[s], (double)surfaces->nz[s]};
        s++;
        ref_along(ray.o, (double)hits->t[i], ray.d, p);
        ref_normal(scene, prim, p, n);
        ref_along(got, ref_dot(n, got) < 0.0 ? 1.0 : -1.0, n, n);
        double radius = radius_at(scene, prim, &ray, p);
        double ulps = ref_length(n) * radius /
                      fmax(ulp_of(scene, &ray, (double)hits->t[i], prim, prim), 0x1p-24 * radius);
        tally->normal_ulps = fmax(tally->normal_ulps, ulps);
        if (ulps > ULPS_MAX)
            show("normal", rays, i, prim, (double)hits->t[i], &(struct ref_hit){0}, ulps);
    }
}

// Surfaces of the batch that was just traced, and its secondary rays, in the queue of bounce 1.
static void spawn(const struct stage *stage, const struct rb_rays *rays, struct rb_rays *children,
                  struct tally *tally)
{
    struct rb_shading shading = {
        .light_scale = 1.0f, .light_samples = 1, .strata_x = 1, .strata_y = 1};
    struct rb_rays refracted = rb_rays_view(&queues.rays[1], BATCH, 0, BATCH);
    uint64_t rgb[3] = {0};
    struct rb_film film = {.rgb = rgb, .width = 1, .height = 1};
    *children = rb_rays_view(&queues.rays[1], 0, 0, BATCH);
    queues.surfaces.count = 0;
    kernels[0]->surface(&stage->world, &shading, rays, &queues.hits, &queues.surfaces, children,
                        &refracted, &film);
    compare_normals(&stage->scene, rays, &queues.hits, &queues.surfaces, tally);
    if (children->count > BATCH / 2)
        children->count = BATCH / 2;
    uint32_t kept = refracted.count < BATCH / 2 ? refracted.count : BATCH / 2;
    rb_rays_move(&queues.rays[1], children->count, BATCH, kept);
    children->count += kept;
}

static void compare_batch(const struct stage *stage, const struct rb_rays *rays, bool one_sided,
                          struct tally *tally)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        compare_hit(&stage->scene, &stage->reference, rays, &queues.hits, i, one_sided, tally);
        compare_shadow(&stage->scene, &stage->reference, rays, &queues.shadows, i, tally);
    }
}

static void report(const char *scene, const char *name, const struct tally *t)
{
    note("%-9s %-15s %7llu rays %6.2f %% hit, %8.4f %% differ, worst %6.2f ulps off, %6.2f missed; "
         "shadows %8.4f %% differ, worst %6.2f; normals %5.1f",
         scene, name, (unsigned long long)t->rays, 100.0 * (double)t->hits / (double)t->rays,
         100.0 * (double)t->differ / (double)t->rays, t->hit_ulps, t->depth_ulps,
         100.0 * (double)t->shadows_differ / (double)t->shadows, t->shadow_ulps, t->normal_ulps);
}

static void run_class(const struct stage *stage, const char *scene, const struct ray_class *class)
{
    struct ref_random random = {1000};
    struct tally tally = {0};
    for (int batch = 0; batch < class->batches; batch++) {
        struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
        while (rays.count < BATCH) {
            struct aim aim;
            class->aim(&random, &stage->scene, &aim);
            aim_push(&rays, &aim, &random);
        }
        tally.inexact += trace_all(stage, class->one_sided, &rays, &random);
        struct rb_rays children;
        if (!class->children)
            compare_batch(stage, &rays, class->one_sided, &tally);
        spawn(stage, &rays, &children, &tally);
        if (class->children) {
            tally.inexact += trace_all(stage, false, &children, &random);
            compare_batch(stage, &children, false, &tally);
        }
    }
    report(scene, class->name, &tally);
    double worst =
        fmax(fmax(tally.hit_ulps, tally.depth_ulps), fmax(tally.shadow_ulps, tally.normal_ulps));
    ok(tally.inexact == 0, "%s, %s: all kernel sets agree bit for bit", scene, class->name);
    ok(worst <= ULPS_MAX, "%s, %s: within %.0f ulps of the reference", scene, class->name,
       ULPS_MAX);
}

// The reference's tree must not change its answers.
static void check_reference(const struct stage *stage, const char *name)
{
    struct ref_random random = {2000};
    int wrong = 0;
    for (int i = 0; i < 2000; i++) {
        struct aim aim;
        struct ref_ray ray = {.self = RB_NONE};
        (i % 2 && stage->scene.count[RB_TRIANGLE] ? aim_axis : aim_random)(&random, &stage->scene,
                                                                           &aim);
        memcpy(ray.o, aim.o, sizeof ray.o);
        ref_along(aim.target, -1.0, aim.o, ray.d);
        struct ref_hit brute = ref_closest_brute(&stage->scene, &ray);
        struct ref_hit tree = ref_closest(&stage->reference, &ray);
        ray.shadow = true;
        wrong += brute.prim != tree.prim || brute.t != tree.t;
        wrong += ref_occluded(&stage->reference, &ray, HUGE_VAL) !=
                 (ref_closest_brute(&stage->scene, &ray).prim != RB_NONE);
    }
    ok(wrong == 0, "%s: the reference's tree agrees with its brute force", name);
}

// A NaN or an infinity in any component: no hit, no shadow, and none for the rays beside it
// changed.
static void check_non_finite(const struct stage *stage)
{
    static const float poisons[] = {NAN, -NAN, INFINITY, -INFINITY};
    struct ref_random random = {3000};
    struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
    float *components[6] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
    while (rays.count < 512) {
        struct aim aim;
        aim_random(&random, &stage->scene, &aim);
        aim_push(&rays, &aim, &random);
    }
    for (uint32_t i = 0; i < rays.count; i += 2)
        components[i / 2 % 6][i] = poisons[i / 12 % 4];
    for (int k = 0; k < kernel_count; k++) {
        int wrong = 0, hits = 0;
        kernels[k]->trace(&stage->world, &rays, &queues.hits);
        fill_shadows(&rays, &queues.hits, &random, &queues.shadows);
        kernels[k]->trace_shadow(&stage->world, &queues.shadows);
        for (uint32_t i = 0; i < rays.count; i++) {
            wrong += i % 2 == 0 && (queues.hits.prim[i] != RB_NONE || queues.shadows.occluded[i] ||
                                    queues.hits.t[i] != INFINITY);
            hits += i % 2 && queues.hits.prim[i] != RB_NONE;
        }
        ok(wrong == 0 && hits > 200, "%s: rays that are not finite miss, the others do not",
           kernel_names[k]);
    }
}

static void run_classes(struct stage *stage, const char *name, const struct ray_class *class)
{
    check_reference(stage, name);
    for (; class->name; class ++)
        run_class(stage, name, class);
    stage_close(stage);
}

int main(void)
{
    struct stage stage = {0};
    stage_check(rb_queues_alloc(&queues, BATCH, 2, &stage_failure));
    list_kernels();
    stage_soup(&stage, 0.0);
    check_non_finite(&stage);
    run_classes(&stage, "soup", ray_classes_soup);
    stage_soup(&stage, 1000.0);
    run_classes(&stage, "soup+1000", ray_classes_shifted);
    stage_tiny(&stage, 0.0);
    run_classes(&stage, "tiny", ray_classes_tiny);
    stage_tiny(&stage, 5000.0);
    run_classes(&stage, "tiny+5000", ray_classes_tiny);
    stage_load(&stage, "mount3");
    run_classes(&stage, "mount3", ray_classes_mesh);
    stage_load(&stage, "balls2");
    run_classes(&stage, "balls2", ray_classes_spheres);
    rb_queues_free(&queues);
    return done();
}
