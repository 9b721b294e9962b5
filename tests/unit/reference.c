// The float kernels against the double-precision reference, on rays that are meant to break them.
//
// Every kernel set must agree with the first one bit for bit. Against the reference two figures are
// printed per class of rays: how often the answers differ, and the displacement that the worst
// answer needs: how far, in ulps (2^-24 of the largest coordinate involved), the ray or the surface
// would have to be moved to make the kernel's answer the exact one. Rates depend on how many rays a
// class aims at places where nothing can be right; the displacement has a limit.
#include "tests/support/reference.h"
#include "accel/bvh.h"
#include "render/queues.h"
#include "render/variants.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 4096, KERNELS_MAX = 32 };

static void give_up(const char *what)
{
    printf("Bail out! %s\n", what);
    exit(1);
}

// A scene with everything that traces it.
struct stage {
    struct rb_scene scene;
    struct rb_bvh bvh;
    struct ref_world world;
};

static struct rb_queues queues;
static const struct rb_kernels *kernels[KERNELS_MAX]; // distinct sets of the table
static const char *kernel_names[KERNELS_MAX];
static int kernel_count;

static void list_kernels(void)
{
    for (const struct rb_variant *row = rb_variants; row->name; row++) {
        bool known = !rb_variant_available(row) || !row->exact;
        for (int i = 0; i < kernel_count; i++)
            known = known || kernels[i] == row->kernels;
        if (!known && kernel_count < KERNELS_MAX) {
            kernel_names[kernel_count] = row->name;
            kernels[kernel_count++] = row->kernels;
        }
    }
}

static void open_stage(struct stage *stage)
{
    struct rb_error error;
    if (rb_bvh_build(&stage->scene, 1, &stage->bvh, &error) != RB_OK ||
        !ref_world_build(&stage->scene, &stage->world))
        give_up("no tree");
}

static void close_stage(struct stage *stage)
{
    rb_bvh_free(&stage->bvh);
    ref_world_free(&stage->world);
    rb_scene_free(&stage->scene);
}

// ---- scenes

static struct rb_error failure;

static void check(enum rb_status status)
{
    if (status != RB_OK)
        give_up(failure.text);
}

static void begin_scene(struct rb_scene_builder *builder)
{
    *builder =
        (struct rb_scene_builder){.camera = {{4, 3, 2}, {0, 0, 0}, {0, 0, 1}, 45.0, 0.01, 64, 64}};
    check(rb_scene_add_light(builder, (const double[3]){-100, -100, 100},
                             (const double[3]){1, 1, 1}, &failure));
    check(rb_scene_add_material(builder, (const double[3]){1, 1, 1}, 0.5, 0.5, 10.0, 0.5, 1.2,
                                &failure));
}

static void random_point(struct ref_random *random, double reach, double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = ref_between(random, -reach, reach);
}

// All kinds of primitives, of sizes from 0.01 to 1, within about 3 of `center`.
static void build_soup(struct stage *stage, double center)
{
    struct ref_random random = {11};
    struct rb_scene_builder builder;
    begin_scene(&builder);
    for (int i = 0; i < 40; i++) {
        double size = pow(10.0, ref_between(&random, -2.0, 0.0)), p[3], v[3][3];
        random_point(&random, 2.0, p);
        for (int k = 0; k < 3; k++)
            p[k] += center;
        check(rb_scene_add_sphere(&builder, p, i % 5 ? size : -size, &failure));
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                v[j][k] = p[k] + ref_between(&random, -size, size) * 2.0;
        check(rb_scene_add_triangle(
            &builder, (const double(*)[3])v,
            i % 4 ? NULL : (const double[3][3]){{1, 0, 0}, {1, 1, 0}, {1, 0, 1}}, &failure));
        double sign = i % 6 ? 1.0 : -1.0;
        check(rb_scene_add_cone(&builder, v[0], sign * size * ref_between(&random, 0.0, 0.5), v[1],
                                i % 3 ? sign * size * 0.3 : 0.0, &failure));
    }
    double z = center - 4.0;
    check(rb_scene_add_plane(&builder, (const double[3][3]){{0, 0, z}, {1, 0, z}, {0, 1, z}},
                             &failure));
    check(rb_scene_add_plane(&builder, (const double[3][3]){{z, 1, 0}, {0, z, 1}, {1, 2, z - 1}},
                             &failure));
    check(rb_scene_finish(&builder, &stage->scene, &failure));
    open_stage(stage);
}

// Spheres of radius 0.001, 10 to 1000 away from `center` in all directions.
static void build_tiny(struct stage *stage, double center)
{
    struct ref_random random = {12};
    struct rb_scene_builder builder;
    begin_scene(&builder);
    for (int i = 0; i < 100; i++) {
        double d[3], p[3], c[3] = {center, center, center};
        ref_direction(&random, d);
        ref_along(c, pow(10.0, ref_between(&random, 1.0, 3.0)), d, p);
        check(rb_scene_add_sphere(&builder, p, 1e-3, &failure));
    }
    check(rb_scene_finish(&builder, &stage->scene, &failure));
    open_stage(stage);
}

static void load_stage(struct stage *stage, const char *name)
{
    check(rb_scene_load(name, &(struct rb_nff_options){0}, &stage->scene, &failure));
    open_stage(stage);
}

// ---- rays

struct aim {
    double o[3], target[3];
};

typedef void aim_fn(struct ref_random *random, const struct rb_scene *scene, struct aim *aim);

static void widen(const float a[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k];
}

static void origin_near(struct ref_random *random, double reach, struct aim *aim)
{
    double d[3], o[3] = {aim->target[0], aim->target[1], aim->target[2]};
    ref_direction(random, d);
    ref_along(o, reach * ref_between(random, 0.1, 1.0), d, aim->o);
}

static const struct rb_triangle *any_triangle(struct ref_random *random,
                                              const struct rb_scene *scene)
{
    return &scene->triangles[ref_below(random, scene->count[RB_TRIANGLE])];
}

static void blend(const struct rb_triangle *triangle, const double weight[3], double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = weight[0] * (double)triangle->v[0][k] + weight[1] * (double)triangle->v[1][k] +
               weight[2] * (double)triangle->v[2][k];
}

static void aim_random(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    float low[3], high[3];
    rb_scene_bounds(scene, ref_below(random, scene->bounded_count), low, high);
    for (int k = 0; k < 3; k++)
        aim->target[k] = ref_between(random, (double)low[k], (double)high[k]);
    origin_near(random, 4.0, aim);
}

static void aim_edge(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    double s = ref_uniform(random), weight[3] = {s, 1.0 - s, 0.0};
    blend(any_triangle(random, scene), weight, aim->target);
    origin_near(random, 4.0, aim);
}

static void aim_midpoint(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    blend(any_triangle(random, scene), (const double[3]){0.0, 0.5, 0.5}, aim->target);
    origin_near(random, 4.0, aim);
}

static void aim_vertex(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    widen(any_triangle(random, scene)->v[ref_below(random, 3)], aim->target);
    origin_near(random, 4.0, aim);
}

// From where a light would stand: sqrt(3) 100 away.
static void aim_far(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    (ref_below(random, 2) ? aim_vertex : aim_edge)(random, scene, aim);
    for (int k = 0; k < 3; k++)
        aim->o[k] = k == 2 ? 100.0 : -100.0;
}

// Nearly in the plane of a triangle: the sine of the angle is 1e-8 to 1e-2.
static void aim_grazing(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_triangle *triangle = any_triangle(random, scene);
    double a = ref_uniform(random), b = ref_uniform(random) * (1.0 - a), along[3], e[3], f[3], n[3];
    blend(triangle, (const double[3]){a, b, 1.0 - a - b}, aim->target);
    for (int k = 0; k < 3; k++) {
        e[k] = (double)triangle->v[1][k] - (double)triangle->v[0][k];
        f[k] = (double)triangle->v[2][k] - (double)triangle->v[0][k];
        along[k] = ref_uniform(random) * e[k] - ref_uniform(random) * f[k];
    }
    ref_cross(e, f, n);
    ref_normalize(n);
    ref_normalize(along);
    ref_along(along, pow(10.0, ref_between(random, -8.0, -2.0)), n, along);
    ref_along(aim->target, ref_between(random, 0.1, 4.0), along, aim->o);
}

// Past a sphere at 1 +- 1e-8 to 1e-2 of its radius.
static void aim_tangent(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_sphere *sphere = &scene->spheres[ref_below(random, scene->count[RB_SPHERE])];
    double c[3], out[3], other[3], across[3];
    double share = pow(10.0, ref_between(random, -8.0, -2.0)) * (ref_below(random, 2) ? 1.0 : -1.0);
    widen(sphere->center, c);
    ref_direction(random, out);
    ref_direction(random, other);
    ref_cross(out, other, across);
    ref_normalize(across);
    ref_along(c, fabs((double)sphere->radius) * (1.0 + share), out, aim->target);
    ref_along(aim->target, ref_between(random, 0.1, 4.0), across, aim->o);
}

// From the middle of the scene at a disc a little larger than a sphere far away.
static void aim_tiny(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_sphere *sphere = &scene->spheres[ref_below(random, scene->count[RB_SPHERE])];
    double center = ref_reach(scene, 0) > 2000.0 ? 5000.0 : 0.0, offset[3];
    widen(sphere->center, aim->target);
    random_point(random, 1.1 * (double)sphere->radius, offset);
    for (int k = 0; k < 3; k++) {
        aim->o[k] = center + ref_between(random, -1.0, 1.0);
        aim->target[k] += offset[k];
    }
}

// Past or at a cone: its rims, its tip, its silhouette, its axis.
static void aim_cone(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_cone *cone = &scene->cones[ref_below(random, scene->count[RB_CONE])];
    static const double heights[5] = {0.0, 1.0, 0.5, 0.99, 0.25};
    double axis[3], base[3], out[3], across[3];
    double z = heights[ref_below(random, 5)] * (double)cone->height;
    widen(cone->axis, axis);
    widen(cone->base, base);
    ref_direction(random, out);
    ref_cross(axis, out, across);
    ref_normalize(across);
    ref_along(base, z, axis, aim->target);
    double r = (double)cone->base_radius + (double)cone->slope * z;
    ref_along(aim->target, r * (double)ref_below(random, 2), across, aim->target);
    origin_near(random, 4.0, aim);
    if (ref_below(random, 2)) // in the tangent plane
        ref_along(aim->target, ref_between(random, 0.1, 4.0), out, aim->o);
    if (ref_below(random, 8) == 0) // along the axis
        ref_along(aim->target, ref_between(random, 0.1, 4.0), axis, aim->o);
}

// Starts inside a sphere or a cone.
static void aim_inside(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    double d[3];
    if (ref_below(random, 2)) {
        const struct rb_sphere *sphere =
            &scene->spheres[ref_below(random, scene->count[RB_SPHERE])];
        widen(sphere->center, aim->o);
        ref_direction(random, d);
        ref_along(aim->o, 0.999999 * ref_uniform(random) * fabs((double)sphere->radius), d, aim->o);
    } else {
        const struct rb_cone *cone = &scene->cones[ref_below(random, scene->count[RB_CONE])];
        double axis[3];
        widen(cone->base, aim->o);
        widen(cone->axis, axis);
        ref_along(aim->o, ref_uniform(random) * (double)cone->height, axis, aim->o);
    }
    ref_direction(random, d);
    ref_along(aim->o, 1.0, d, aim->target);
}

// Parallel to one axis or to the plane of two, zeros of both signs, often through a vertex.
static void aim_axis(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    (ref_below(random, 2) ? aim_vertex : aim_random)(random, scene, aim);
    uint32_t axis = ref_below(random, 3), kept = ref_below(random, 3);
    for (uint32_t k = 0; k < 3; k++) {
        aim->target[k] = (double)(float)aim->target[k];
        if (k != axis && k != kept)
            aim->o[k] = aim->target[k];
    }
    if (aim->o[axis] == aim->target[axis])
        aim->o[axis] += 1.0;
}

// Rounds an aim to a ray of the queue, as a camera would.
static void push_ray(struct rb_rays *rays, const struct aim *aim, struct ref_random *random)
{
    uint32_t i = rays->count++;
    float *o[3] = {&rays->ox[i], &rays->oy[i], &rays->oz[i]};
    float *d[3] = {&rays->dx[i], &rays->dy[i], &rays->dz[i]};
    double direction[3];
    for (int k = 0; k < 3; k++) {
        *o[k] = (float)aim->o[k];
        direction[k] = aim->target[k] - (double)*o[k];
    }
    ref_normalize(direction);
    for (int k = 0; k < 3; k++) {
        *d[k] = (float)direction[k];
        if (direction[k] == 0.0 && ref_below(random, 2))
            *d[k] = -0.0f;
    }
    rays->weight[i] = 1.0f;
    rays->pixel[i] = 0;
    rays->path[i] = 1;
    rays->self[i] = RB_NONE;
    rays->media[i] = 0;
}

static struct ref_ray ref_ray_of(const struct rb_rays *rays, uint32_t i, bool one_sided)
{
    return (struct ref_ray){
        .o = {(double)rays->ox[i], (double)rays->oy[i], (double)rays->oz[i]},
        .d = {(double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]},
        .self = rays->self[i],
        .one_sided = one_sided,
    };
}

// ---- comparison

// The smallest altitude of a triangle, capped at 1.
static double altitude(const struct rb_triangle *triangle)
{
    double e[3][3], n[3], longest = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)triangle->v[(i + 1) % 3][k] - (double)triangle->v[i][k];
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
    struct ref_ray ray = ref_ray_of(rays, i, one_sided);
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
    struct ref_ray ray = ref_ray_of(rays, i, false);
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
    struct rb_world world = {&stage->scene, &stage->bvh, one_sided};
    struct rb_hits *hits = &queues.hits;
    struct rb_shadows *shadows = &queues.shadows;
    static struct {
        float t[BATCH], u[BATCH], v[BATCH];
        uint32_t prim[BATCH];
        uint8_t occluded[BATCH];
    } first;
    uint64_t inexact = 0;
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

// Cosine between a triangle's plane normal and a ray: seen edge-on, places on it mean little.
static double edge_on(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray)
{
    const float *n = scene->triangle_normals[prim - scene->first[RB_TRIANGLE]];
    double normal[3];
    widen(n, normal);
    return fabs(ref_dot(normal, ray->d));
}

// Normals of the surface kernel, as a displacement of the point: the angle off, times the radius of
// curvature (1 for what is flat).
static void compare_normals(const struct rb_scene *scene, const struct rb_rays *rays,
                            const struct rb_hits *hits, const struct rb_surfaces *surfaces,
                            struct tally *tally)
{
    for (uint32_t i = 0, s = 0; i < rays->count; i++) {
        uint32_t prim = hits->prim[i];
        if (prim == RB_NONE)
            continue;
        struct ref_ray ray = ref_ray_of(rays, i, false);
        double p[3], n[3],
            got[3] = {(double)surfaces->nx[s], (double)surfaces->ny[s], (double)surfaces->nz[s]};
        s++;
        ref_along(ray.o, (double)hits->t[i], ray.d, p);
        ref_normal(scene, prim, p, n);
        double sign = ref_dot(n, got) < 0.0 ? 1.0 : -1.0, radius = 1.0;
        ref_along(got, sign, n, n);
        if (rb_scene_kind(scene, prim) == RB_SPHERE)
            radius = fabs((double)scene->spheres[prim].radius);
        if (rb_scene_kind(scene, prim) == RB_TRIANGLE)
            radius = edge_on(scene, prim, &ray) *
                     altitude(&scene->triangles[prim - scene->first[RB_TRIANGLE]]);
        if (rb_scene_kind(scene, prim) == RB_CONE) {
            const struct rb_cone *cone = &scene->cones[prim - scene->first[RB_CONE]];
            double base[3], axis[3], l[3];
            widen(cone->base, base);
            widen(cone->axis, axis);
            ref_along(p, -1.0, base, l);
            ref_along(l, -ref_dot(l, axis), axis, l);
            radius = ref_length(l);
        }
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
    struct rb_world world = {&stage->scene, &stage->bvh, false};
    struct rb_shading shading = {
        .light_scale = 1.0f, .light_samples = 1, .strata_x = 1, .strata_y = 1};
    struct rb_rays refracted = rb_rays_view(&queues.rays[1], BATCH, 0, BATCH);
    uint64_t rgb[3] = {0};
    struct rb_film film = {.rgb = rgb, .width = 1, .height = 1};
    *children = rb_rays_view(&queues.rays[1], 0, 0, BATCH);
    queues.surfaces.count = 0;
    kernels[0]->surface(&world, &shading, rays, &queues.hits, &queues.surfaces, children,
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
        compare_hit(&stage->scene, &stage->world, rays, &queues.hits, i, one_sided, tally);
        compare_shadow(&stage->scene, &stage->world, rays, &queues.shadows, i, tally);
    }
}

// ---- classes

struct ray_class {
    const char *name;
    aim_fn *aim;
    int count;
    bool one_sided, children; // children: the secondary rays of these rays instead
};

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
    for (int done = 0; done < class->count; done += BATCH) {
        struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
        while (rays.count < BATCH) {
            struct aim aim;
            class->aim(&random, &stage->scene, &aim);
            push_ray(&rays, &aim, &random);
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

static const struct ray_class soup_classes[] = {
    {"random", aim_random, 3 * BATCH, false, false},
    {"one-sided", aim_random, BATCH, true, false},
    {"edges", aim_edge, 2 * BATCH, false, false},
    {"edge midpoints", aim_midpoint, 2 * BATCH, false, false},
    {"vertices", aim_vertex, 2 * BATCH, false, false},
    {"far light", aim_far, 2 * BATCH, false, false},
    {"grazing", aim_grazing, 2 * BATCH, false, false},
    {"tangent", aim_tangent, 2 * BATCH, false, false},
    {"cones", aim_cone, 2 * BATCH, false, false},
    {"inside", aim_inside, 2 * BATCH, false, false},
    {"axis-parallel", aim_axis, 2 * BATCH, false, false},
    {"secondary", aim_random, 3 * BATCH, false, true},
    {0},
};
static const struct ray_class mesh_classes[] = {
    {"random", aim_random, BATCH, false, false},   {"edges", aim_edge, BATCH, false, false},
    {"vertices", aim_vertex, BATCH, false, false}, {"far light", aim_far, BATCH, false, false},
    {"grazing", aim_grazing, BATCH, false, false}, {"axis-parallel", aim_axis, BATCH, false, false},
    {"secondary", aim_random, BATCH, false, true}, {0},
};
static const struct ray_class sphere_classes[] = {
    {"random", aim_random, BATCH, false, false},
    {"tangent", aim_tangent, BATCH, false, false},
    {"secondary", aim_random, BATCH, false, true},
    {0},
};
static const struct ray_class shifted_classes[] = {
    {"random", aim_random, BATCH, false, false},
    {"edges", aim_edge, BATCH, false, false},
    {"vertices", aim_vertex, BATCH, false, false},
    {"grazing", aim_grazing, BATCH, false, false},
    {"tangent", aim_tangent, BATCH, false, false},
    {"cones", aim_cone, BATCH, false, false},
    {"inside", aim_inside, BATCH, false, false},
    {"axis-parallel", aim_axis, BATCH, false, false},
    {"secondary", aim_random, 2 * BATCH, false, true},
    {0},
};
static const struct ray_class tiny_classes[] = {
    {"tiny far spheres", aim_tiny, 2 * BATCH, false, false},
    {"from them", aim_tiny, 2 * BATCH, false, true},
    {0},
};

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
        struct ref_hit tree = ref_closest(&stage->world, &ray);
        ray.shadow = true;
        wrong += brute.prim != tree.prim || brute.t != tree.t;
        wrong += ref_occluded(&stage->world, &ray, HUGE_VAL) !=
                 (ref_closest_brute(&stage->scene, &ray).prim != RB_NONE);
    }
    ok(wrong == 0, "%s: the reference's tree agrees with its brute force", name);
}

// A NaN or an infinity in any component: no hit, no shadow, and none for the rays beside it
// changed.
static void check_non_finite(const struct stage *stage)
{
    static const float poisons[] = {NAN, -NAN, INFINITY, -INFINITY};
    struct rb_world world = {&stage->scene, &stage->bvh, false};
    struct ref_random random = {3000};
    struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
    float *components[6] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
    while (rays.count < 512) {
        struct aim aim;
        aim_random(&random, &stage->scene, &aim);
        push_ray(&rays, &aim, &random);
    }
    for (uint32_t i = 0; i < rays.count; i += 2)
        components[i / 2 % 6][i] = poisons[i / 12 % 4];
    for (int k = 0; k < kernel_count; k++) {
        int wrong = 0, hits = 0;
        kernels[k]->trace(&world, &rays, &queues.hits);
        fill_shadows(&rays, &queues.hits, &random, &queues.shadows);
        kernels[k]->trace_shadow(&world, &queues.shadows);
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
    close_stage(stage);
}

int main(void)
{
    struct rb_error error;
    struct stage stage = {0};
    if (rb_queues_alloc(&queues, BATCH, 2, &error) != RB_OK)
        give_up("no memory");
    list_kernels();
    build_soup(&stage, 0.0);
    check_non_finite(&stage);
    run_classes(&stage, "soup", soup_classes);
    build_soup(&stage, 1000.0);
    run_classes(&stage, "soup+1000", shifted_classes);
    build_tiny(&stage, 0.0);
    run_classes(&stage, "tiny", tiny_classes);
    build_tiny(&stage, 5000.0);
    run_classes(&stage, "tiny+5000", tiny_classes);
    load_stage(&stage, "mount3");
    run_classes(&stage, "mount3", mesh_classes);
    load_stage(&stage, "balls2");
    run_classes(&stage, "balls2", sphere_classes);
    rb_queues_free(&queues);
    return done();
}
