// No leaks: no ray slips between two triangles that share an edge or a vertex. No acne: what starts
// on a surface meets what it would meet if it started on the exact surface.
//
// The meshes are grids of vertices bent into rough surfaces. Rays aim at edges and vertices around
// which all triangles face the ray the same way, so that it must hit one of them. The triangle test
// is repeated here with the edge tolerance as a parameter; for every ray the smallest tolerance is
// found at which the ray is caught, and from all of them the leak rate at any fraction of
// RB_EDGE_TOLERANCE. At the tolerance itself the test is compared with the kernels'. An argument
// sets the rays per row: 3400000 makes 10^8 in all, of which the worst needs 5.1 * 2^-24.
//
// Acne is looked for in the six scenes and at the joints of the meshes: shadow, reflected and
// refracted rays as the kernels start them, against those that the double-precision reference
// starts at the exact hit. Limits are rates, because points within rounding of an edge have no
// right answer.
#include "accel/bvh.h"
#include "kernels/intersect.h"
#include "render/queues.h"
#include "render/settings.h"
#include "render/variants.h"
#include "scene/load.h"
#include "tests/support/reference.h"
#include "tests/unit/tap.h"

#include <stdlib.h>
#include <string.h>

enum { BATCH = 4096, GRID = 48, SIDE = GRID + 1, RAYS = 100000, BOUNCES = 4 };

static void give_up(const char *what)
{
    printf("Bail out! %s\n", what);
    exit(1);
}

// A grid of vertices; cell (x, y) is split along the diagonal from (x, y) to (x + 1, y + 1).
struct mesh {
    const char *name;
    double stretch, shift; // scales y; moves everything
    double roughness;      // of the heights, in edges
    bool ball;             // wrapped around a sphere
    float v[SIDE][SIDE][3];
};

static void bend(struct mesh *mesh)
{
    struct ref_random random = {5};
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            double a = x * 2.0 / GRID - 1.0, b = y * 2.0 / GRID - 1.0;
            double rough = ref_between(&random, -1.0, 1.0) * mesh->roughness / GRID;
            double p[3] = {a, b, 0.4 * sin(3.0 * a) * cos(2.0 * b) + rough};
            if (mesh->ball) {
                double height = 2.9 * (y + 0.5) / SIDE + 0.1, angle = 6.0 * x / GRID;
                p[0] = (1.0 + rough) * sin(height) * cos(angle);
                p[1] = (1.0 + rough) * sin(height) * sin(angle);
                p[2] = (1.0 + rough) * cos(height);
            }
            p[1] *= mesh->stretch;
            for (int k = 0; k < 3; k++)
                mesh->v[y][x][k] = (float)(p[k] + mesh->shift);
        }
}

// Triangle 0 (lower right) or 1 (upper left) of a cell, counter-clockwise from above.
static struct rb_triangle triangle_of(const struct mesh *mesh, int x, int y, int which)
{
    const int corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{1, 1}, {0, 1}, {0, 0}}};
    struct rb_triangle triangle;
    for (int i = 0; i < 3; i++) {
        const int *c = corner[which][i];
        memcpy(triangle.v[i], mesh->v[y + c[1]][x + c[0]], sizeof triangle.v[i]);
    }
    return triangle;
}

// Triangles around an edge or a vertex, and the point aimed at.
struct joint {
    struct rb_triangle triangles[6];
    int count;
    double target[3];
};

static void blend(const float a[3], const float b[3], double s, double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = (1.0 - s) * (double)a[k] + s * (double)b[k];
}

// The six triangles around an inner vertex.
static void pick_vertex(const struct mesh *mesh, struct ref_random *random, struct joint *joint)
{
    int x = 1 + (int)ref_below(random, GRID - 1), y = 1 + (int)ref_below(random, GRID - 1);
    const int around[6][3] = {{0, 0, 0},  {0, 0, 1},   {-1, 0, 0},
                              {0, -1, 1}, {-1, -1, 0}, {-1, -1, 1}};
    joint->count = 6;
    for (int i = 0; i < 6; i++)
        joint->triangles[i] = triangle_of(mesh, x + around[i][0], y + around[i][1], around[i][2]);
    blend(mesh->v[y][x], mesh->v[y][x], 0.0, joint->target);
}

// The two triangles at an edge: horizontal, vertical or diagonal.
static void pick_edge(const struct mesh *mesh, struct ref_random *random, struct joint *joint)
{
    int x = 1 + (int)ref_below(random, GRID - 1), y = 1 + (int)ref_below(random, GRID - 1);
    double s = ref_below(random, 4) ? ref_between(random, 0.02, 0.98) : 0.5;
    const float *to;
    joint->count = 2;
    switch (ref_below(random, 3)) {
    case 0:
        joint->triangles[0] = triangle_of(mesh, x, y, 0);
        joint->triangles[1] = triangle_of(mesh, x, y - 1, 1);
        to = mesh->v[y][x + 1];
        break;
    case 1:
        joint->triangles[0] = triangle_of(mesh, x, y, 1);
        joint->triangles[1] = triangle_of(mesh, x - 1, y, 0);
        to = mesh->v[y + 1][x];
        break;
    default:
        joint->triangles[0] = triangle_of(mesh, x, y, 0);
        joint->triangles[1] = triangle_of(mesh, x, y, 1);
        to = mesh->v[y + 1][x + 1];
    }
    blend(mesh->v[y][x], to, s, joint->target);
}

// Where rays come from.
enum origin { EYE, LIGHT, NEAR, ORIGIN_COUNT };
static const char *const origin_names[ORIGIN_COUNT] = {"the eye", "a far light", "nearby"};

static void place_origin(const struct mesh *mesh, struct ref_random *random, enum origin origin,
                         const double target[3], double o[3])
{
    const double eye[3] = {-1.6, 1.6, 1.7}, light[3] = {-100.0, -100.0, 100.0};
    double d[3];
    ref_direction(random, d);
    for (int k = 0; k < 3; k++) {
        double place[ORIGIN_COUNT] = {mesh->shift + eye[k] + 0.1 * d[k],
                                      mesh->shift + light[k] + d[k], 0.0};
        o[k] = place[origin];
    }
    if (origin == NEAR)
        ref_along(target, pow(10.0, ref_between(random, -2.0, 0.3)), d, o);
}

// Do all triangles show the same side, at more than 1e-3 of a right angle?
static bool one_side(const struct joint *joint, const struct ref_ray *ray)
{
    int front = 0, back = 0;
    for (int i = 0; i < joint->count; i++) {
        double e[2][3], n[3];
        for (int k = 0; k < 3; k++) {
            e[0][k] = (double)joint->triangles[i].v[1][k] - (double)joint->triangles[i].v[0][k];
            e[1][k] = (double)joint->triangles[i].v[2][k] - (double)joint->triangles[i].v[0][k];
        }
        ref_cross(e[0], e[1], n);
        ref_normalize(n);
        double facing = ref_dot(n, ray->d);
        front += facing<-1e-3, back += facing> 1e-3;
    }
    return front == joint->count || back == joint->count;
}

// A ray at a joint, rounded to single precision.
static struct rb_ray aim(const struct mesh *mesh, struct ref_random *random, enum origin origin,
                         bool vertices, struct joint *joint)
{
    for (;;) {
        struct ref_ray exact;
        float o[3], d[3];
        (vertices ? pick_vertex : pick_edge)(mesh, random, joint);
        place_origin(mesh, random, origin, joint->target, exact.o);
        for (int k = 0; k < 3; k++) {
            o[k] = (float)exact.o[k];
            exact.d[k] = joint->target[k] - (double)o[k];
        }
        ref_normalize(exact.d);
        for (int k = 0; k < 3; k++)
            d[k] = (float)exact.d[k];
        if (one_side(joint, &exact))
            return rb_ray_make(rb_vec_of(o), rb_vec_of(d), RB_NONE, RB_SIDES_VISIBLE);
    }
}

// The kernels' triangle test up to the decision, and what it decides by.
struct edges {
    float us, vs, area, reach, longest;
};

static struct edges edges_of(const struct rb_triangle *triangle, const struct rb_ray *ray)
{
    struct rb_vec v0 = rb_vec_of(triangle->v[0]);
    struct rb_vec e1 = rb_vec_sub(rb_vec_of(triangle->v[1]), v0);
    struct rb_vec e2 = rb_vec_sub(rb_vec_of(triangle->v[2]), v0);
    struct rb_vec s = rb_vec_sub(ray->o, v0);
    struct rb_vec p = rb_cross(ray->d, e2), q = rb_cross(s, e1);
    float det = rb_dot(e1, p), sign = copysignf(1.0f, det);
    return (struct edges){rb_dot(s, p) * sign, rb_dot(ray->d, q) * sign, det * sign,
                          rb_vec_reach(s), rb_max(rb_vec_reach(e1), rb_vec_reach(e2))};
}

static bool accepts(const struct edges *e, float tolerance)
{
    float slack = tolerance * e->reach * e->longest;
    return e->us >= -slack && e->vs >= -slack && e->us + e->vs <= e->area + slack &&
           e->area >= FLT_MIN;
}

static bool passes_box(const struct rb_triangle *triangle, const struct rb_ray *ray)
{
    float low[3], high[3];
    rb_triangle_bounds(triangle, low, high);
    struct rb_interval range = rb_box(low, high, ray);
    return range.near <= range.far;
}

// The tolerance a ray needs to hit this triangle, in units of 2^-24.
static double need(const struct edges *e)
{
    double outside = fmax(fmax(-(double)e->us, -(double)e->vs), (double)(e->us + e->vs - e->area));
    return fmax(outside, 0.0) / ((double)e->reach * (double)e->longest) * 0x1p24;
}

enum { FRACTIONS = 6 };
static const float fractions[FRACTIONS] = {0.0f, 0.0625f, 0.125f, 0.25f, 0.5f, 1.0f};

struct leaks {
    uint64_t rays, at[FRACTIONS], boxes, unequal;
    double most; // tolerance that catches all
};

static void probe(const struct joint *joint, const struct rb_ray *ray, struct leaks *leaks)
{
    bool hit[FRACTIONS] = {false}, box = false;
    double least = HUGE_VAL;
    for (int i = 0; i < joint->count; i++) {
        const struct rb_triangle *triangle = &joint->triangles[i];
        struct edges e = edges_of(triangle, ray);
        struct rb_hit unused;
        leaks->unequal += accepts(&e, RB_EDGE_TOLERANCE) !=
                          rb_triangle_test(triangle, ray, RB_SIDES_VISIBLE, &unused);
        if (!passes_box(triangle, ray))
            continue;
        box = true;
        least = fmin(least, need(&e));
        for (int f = 0; f < FRACTIONS; f++)
            hit[f] = hit[f] || accepts(&e, fractions[f] * RB_EDGE_TOLERANCE);
    }
    leaks->rays++;
    leaks->boxes += !box;
    leaks->most = fmax(leaks->most, least);
    for (int f = 0; f < FRACTIONS; f++)
        leaks->at[f] += !hit[f];
}

static double per_million(uint64_t count, uint64_t of)
{
    return 1e6 * (double)count / (double)of;
}

static void measure(const struct mesh *mesh, enum origin origin, bool vertices, uint32_t rays)
{
    struct ref_random random = {77};
    struct leaks leaks = {0};
    for (uint32_t i = 0; i < rays; i++) {
        struct joint joint;
        struct rb_ray ray = aim(mesh, &random, origin, vertices, &joint);
        probe(&joint, &ray, &leaks);
    }
    uint64_t n = leaks.rays;
    note("%-9s %-8s from %-11s %9.1f %9.1f %9.1f %7.1f %7.1f %7.1f   %6.3f", mesh->name,
         vertices ? "vertices" : "edges", origin_names[origin], per_million(leaks.at[0], n),
         per_million(leaks.at[1], n), per_million(leaks.at[2], n), per_million(leaks.at[3], n),
         per_million(leaks.at[4], n), per_million(leaks.at[5], n), leaks.most);
    ok(leaks.at[FRACTIONS - 1] == 0 && leaks.boxes == 0, "%s, %s, from %s: no ray leaks",
       mesh->name, vertices ? "vertices" : "edges", origin_names[origin]);
    ok(leaks.unequal == 0, "... and the test here is the kernels'");
}

static struct mesh meshes[] = {
    {.name = "smooth", .stretch = 1.0, .roughness = 0.1},
    {.name = "rough", .stretch = 1.0, .roughness = 3.0},
    {.name = "ball", .stretch = 1.0, .roughness = 0.5, .ball = true},
    {.name = "slivers", .stretch = 100.0, .roughness = 0.5},
    {.name = "off-centre", .stretch = 1.0, .shift = 1000.0, .roughness = 1.0},
};

// ---- no acne

static struct rb_queues queues;
static struct rb_error failure;

static void check(enum rb_status status)
{
    if (status != RB_OK)
        give_up(failure.text);
}

// What a scene's surface points came to.
struct verdicts {
    uint64_t primary, primary_differ, lost;      // lost: camera rays that hit nothing
    uint64_t shadows, false_shadow, false_light; // verdicts on lit-facing points
    uint64_t itself, not_itself; // behind the own sphere or cone; not_itself: lit all the same
    uint64_t reflected, refracted, children_differ;
    uint64_t beyond_total; // refracted where the exact ray is totally reflected
    double gap, depth;     // ulps that the worst wrong verdicts are off
};

struct stage {
    struct rb_scene scene;
    struct rb_bvh bvh;
    struct ref_world reference;
    struct rb_world world;
    struct rb_view view;
    struct rb_shading shading;
    const struct rb_kernels *kernels;
};

static void prepare_stage(struct stage *stage, const struct rb_settings *settings)
{
    check(rb_bvh_build(&stage->scene, 1, &stage->bvh, &failure));
    if (!ref_world_build(&stage->scene, &stage->reference))
        give_up("no memory");
    stage->world = (struct rb_world){&stage->scene, &stage->bvh, false};
    stage->view = rb_view_make(&stage->scene, settings);
    stage->shading = rb_shading_make(&stage->scene, settings);
    stage->kernels = rb_variant_fastest()->kernels;
}

static void open_stage(struct stage *stage, const char *name)
{
    struct rb_settings settings = {0};
    check(rb_scene_load(name, &(struct rb_nff_options){0}, &stage->scene, &failure));
    check(rb_settings_complete(&settings, &stage->scene, &failure));
    prepare_stage(stage, &settings);
}

static void close_stage(struct stage *stage)
{
    rb_bvh_free(&stage->bvh);
    ref_world_free(&stage->reference);
    rb_scene_free(&stage->scene);
}

// A ray's exact hit and the exact point.
struct exact {
    struct ref_hit hit;
    double p[3], n[3], d[3]; // n: shading normal, turned against d
    bool entering, same;     // same: the kernel hit the same primitive
};

static struct ref_ray ref_ray_of(const struct rb_rays *rays, uint32_t i)
{
    return (struct ref_ray){
        .o = {(double)rays->ox[i], (double)rays->oy[i], (double)rays->oz[i]},
        .d = {(double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]},
        .self = rays->self[i],
    };
}

static void find_exact(const struct stage *stage, const struct rb_rays *rays, uint32_t i,
                       struct exact *exact)
{
    struct ref_ray ray = ref_ray_of(rays, i);
    ref_normalize(ray.d);
    memcpy(exact->d, ray.d, sizeof exact->d);
    exact->hit = ref_closest(&stage->reference, &ray);
    exact->same = exact->hit.prim == queues.hits.prim[i];
    if (exact->hit.prim == RB_NONE)
        return;
    ref_along(ray.o, exact->hit.t, ray.d, exact->p);
    ref_normal(&stage->scene, exact->hit.prim, exact->p, exact->n);
    exact->entering = ref_dot(exact->hit.normal, ray.d) < 0.0;
    if (ref_dot(exact->n, ray.d) > 0.0)
        for (int k = 0; k < 3; k++)
            exact->n[k] = -exact->n[k];
}

static void count_wrong(const struct stage *stage, const struct exact *e, struct ref_ray ray,
                        bool dark, struct verdicts *v)
{
    double ulp = 0x1p-24 * fmax(1.0, ref_length(e->p)), length = ref_length(ray.d);
    if (dark) {
        v->false_light++;
        v->depth = fmax(v->depth, ref_depth_before(&stage->scene, &ray, 1.0) / ulp);
        return;
    }
    ref_normalize(ray.d);
    v->false_shadow++;
    v->gap = fmax(v->gap, ref_gap_before(&stage->scene, &ray, length) / ulp);
}

// The kernels' verdicts by ray, whose number stands in `pixel`: dark unless there is a shadow ray
// and it is not occluded.
static const bool *kernel_verdicts(void)
{
    static bool dark[BATCH];
    for (uint32_t i = 0; i < queues.surfaces.count; i++)
        dark[queues.surfaces.pixel[i]] = true;
    for (uint32_t i = 0; i < queues.shadows.count; i++)
        dark[queues.shadows.pixel[i]] = queues.shadows.occluded[i];
    return dark;
}

// On all points that face the light by more than rounding can turn them.
static void compare_shadows(const struct stage *stage, const struct exact *exact, uint32_t light,
                            struct verdicts *v)
{
    const bool *dark = kernel_verdicts();
    for (uint32_t i = 0; i < queues.surfaces.count; i++) {
        uint32_t number = queues.surfaces.pixel[i];
        const struct exact *e = &exact[number];
        struct ref_ray ray = {.self = e->hit.prim, .shadow = true};
        memcpy(ray.o, e->p, sizeof ray.o);
        for (int k = 0; k < 3; k++)
            ray.d[k] = (double)stage->scene.lights[light].position[k] - e->p[k];
        if (!e->same || !(ref_dot(ray.d, e->n) > 1e-5 * ref_length(ray.d)))
            continue;
        v->shadows++;
        bool itself = ref_shadows_itself(&stage->scene, &ray, 1.0);
        if (itself)
            v->itself += dark[number], v->not_itself += !dark[number];
        else if (ref_occluded(&stage->reference, &ray, 1.0) != dark[number])
            count_wrong(stage, e, ray, !dark[number], v);
    }
}

// The mirrored direction, or Snell's; false on total internal reflection.
static bool exact_child(const struct exact *e, bool refracted, double from, double to,
                        struct ref_ray *child)
{
    double cosine = -ref_dot(e->d, e->n), eta = from / to;
    memcpy(child->o, e->p, sizeof child->o);
    child->self = e->hit.prim;
    if (!refracted) {
        ref_along(e->d, 2.0 * cosine, e->n, child->d);
        return true;
    }
    double k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (k < 0.0)
        return false;
    for (int i = 0; i < 3; i++)
        child->d[i] = eta * e->d[i] + (eta * cosine - sqrt(k)) * e->n[i];
    return true;
}

// The children of one kind: where do they go, compared with those of the exact points?
static void compare_children(const struct stage *stage, const struct rb_rays *parents,
                             const struct rb_rays *children, const struct exact *exact,
                             bool refracted, struct verdicts *v)
{
    const struct rb_scene *scene = &stage->scene;
    stage->kernels->trace(&stage->world, children, &queues.hits);
    for (uint32_t i = 0; i < children->count; i++) {
        uint32_t parent = children->pixel[i];
        const struct exact *e = &exact[parent];
        struct ref_ray ray = {0};
        double from = (double)scene->media[parents->media[parent] & 0xffff];
        if (refracted && !e->entering && children->media[i] == parents->media[parent])
            from = (double)scene->materials[scene->material_of[children->self[i]]].ior;
        double to = (double)scene->media[children->media[i] & 0xffff];
        v->reflected += !refracted, v->refracted += refracted;
        if (!e->same)
            continue;
        if (!exact_child(e, refracted, from, to, &ray)) {
            v->beyond_total++;
            continue;
        }
        struct ref_hit hit = ref_closest(&stage->reference, &ray);
        double reach = 1.0 + ref_length(e->p) + (hit.prim == RB_NONE ? 0.0 : hit.t);
        bool differs = hit.prim == RB_NONE || queues.hits.prim[i] == RB_NONE
                           ? hit.prim != queues.hits.prim[i]
                           : fabs(hit.t - (double)queues.hits.t[i]) * hit.cosine > 1e-4 * reach;
        v->children_differ += differs;
    }
}

static unsigned long long ull(uint64_t x)
{
    return x;
}

static void report(const char *name, const struct verdicts *v)
{
    uint64_t wrong = v->false_shadow + v->false_light + v->not_itself;
    // Of a Poisson count; 3 of n where none was seen.
    double upper = ((double)wrong + 3.0 + 2.0 * sqrt((double)wrong)) / (double)v->shadows;
    note("%s: %llu rays, %llu hit another primitive than the reference", name, ull(v->primary),
         ull(v->primary_differ));
    note("  %llu verdicts on lit-facing points, %llu falsely dark (worst %.1f ulps), %llu falsely "
         "lit (worst %.1f ulps): right on %.4f %%, at least %.4f %% with 95 %% confidence",
         ull(v->shadows), ull(v->false_shadow), v->gap, ull(v->false_light), v->depth,
         100.0 - 100.0 * (double)wrong / (double)v->shadows, 100.0 - 100.0 * upper);
    note("  %llu of them in the shadow of their own surface, %llu lit all the same",
         ull(v->itself + v->not_itself), ull(v->not_itself));
    note("  %llu reflected, %llu refracted rays, %llu go elsewhere than the exact ones",
         ull(v->reflected), ull(v->refracted), ull(v->children_differ));
}

static void judge(const struct stage *stage, struct rb_rays *rays, int bounce, struct verdicts *v);

// The next bounce, one kind of children after the other, so that parents are unique.
static void judge_children(const struct stage *stage, struct rb_rays *parents,
                           struct rb_rays *children, const struct exact *exact, bool refracted,
                           int bounce, struct verdicts *v)
{
    if (children->count == 0)
        return;
    compare_children(stage, parents, children, exact, refracted, v);
    judge(stage, children, bounce, v);
}

static void judge(const struct stage *stage, struct rb_rays *rays, int bounce, struct verdicts *v)
{
    static struct exact exact[BOUNCES][BATCH];
    static uint64_t rgb[3 * BATCH];
    struct rb_film film = {.rgb = rgb, .width = BATCH, .height = 1};
    struct rb_rays *next = &queues.rays[bounce + 1];
    struct rb_rays reflected = rb_rays_view(next, 0, 0, BATCH);
    struct rb_rays refracted = rb_rays_view(next, BATCH, 0, BATCH);
    stage->kernels->trace(&stage->world, rays, &queues.hits);
    for (uint32_t i = 0; i < rays->count; i++) {
        rays->pixel[i] = i;
        find_exact(stage, rays, i, &exact[bounce][i]);
        v->primary += bounce == 0;
        v->primary_differ += bounce == 0 && !exact[bounce][i].same;
        v->lost += bounce == 0 && queues.hits.prim[i] == RB_NONE;
    }
    queues.surfaces.count = 0;
    stage->kernels->surface(&stage->world, &stage->shading, rays, &queues.hits, &queues.surfaces,
                            &reflected, &refracted, &film);
    struct rb_light_sample sample = {0};
    for (; sample.light < stage->scene.light_count; sample.light++) {
        queues.shadows.count = 0;
        stage->kernels->light(&stage->world, &stage->shading, &queues.surfaces, &sample,
                              &queues.shadows);
        stage->kernels->trace_shadow(&stage->world, &queues.shadows);
        compare_shadows(stage, exact[bounce], sample.light, v);
    }
    if (bounce + 1 == BOUNCES)
        return;
    judge_children(stage, rays, &reflected, exact[bounce], false, bounce + 1, v);
    judge_children(stage, rays, &refracted, exact[bounce], true, bounce + 1, v);
}

// The mesh as a scene of glass, lit from far away.
static void open_mesh(struct stage *stage, const struct mesh *mesh)
{
    struct rb_settings settings = {0};
    double s = mesh->shift;
    struct rb_scene_builder builder = {
        .camera = {{s - 1.6, s + 1.6, s + 1.7}, {s, s, s}, {0, 0, 1}, 45.0, 0.01, 64, 64}};
    const double white[3] = {1, 1, 1}, light[3] = {s - 100, s - 100, s + 100};
    check(rb_scene_add_light(&builder, light, white, &failure));
    check(rb_scene_add_material(&builder, white, 0.5, 0.1, 10.0, 0.9, 1.2, &failure));
    for (int y = 0; y < GRID; y++)
        for (int x = 0; x < GRID; x++)
            for (int which = 0; which < 2; which++) {
                struct rb_triangle triangle = triangle_of(mesh, x, y, which);
                double v[3][3];
                for (int i = 0; i < 9; i++)
                    v[i / 3][i % 3] = (double)triangle.v[i / 3][i % 3];
                check(rb_scene_add_triangle(&builder, (const double(*)[3])v, NULL, &failure));
            }
    check(rb_scene_finish(&builder, &stage->scene, &failure));
    check(rb_settings_complete(&settings, &stage->scene, &failure));
    prepare_stage(stage, &settings);
}

static void push_ray(struct rb_rays *rays, const struct rb_ray *ray)
{
    uint32_t i = rays->count++;
    rays->ox[i] = ray->o.x, rays->oy[i] = ray->o.y, rays->oz[i] = ray->o.z;
    rays->dx[i] = ray->d.x, rays->dy[i] = ray->d.y, rays->dz[i] = ray->d.z;
    rays->weight[i] = 1.0f;
    rays->path[i] = 1;
    rays->self[i] = RB_NONE;
    rays->media[i] = 0;
}

// Of rays that hit edges and vertices from everywhere. Rays that start within rounding of a fold
// may start on either side of the neighbour; nothing can be promised but that they are few.
#define JOINT_RATE 0.02

static void run_joints(const struct mesh *mesh, int batches)
{
    struct stage stage;
    struct verdicts v = {0};
    struct ref_random random = {31};
    open_mesh(&stage, mesh);
    for (int batch = 0; batch < batches; batch++) {
        struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
        while (rays.count < BATCH) {
            struct joint joint;
            enum origin origin = (enum origin)ref_below(&random, ORIGIN_COUNT);
            struct rb_ray ray = aim(mesh, &random, origin, ref_below(&random, 2), &joint);
            push_ray(&rays, &ray);
        }
        judge(&stage, &rays, 0, &v);
    }
    report(mesh->name, &v);
    ok(v.lost == 0, "%s: every ray aimed at a joint hits the mesh", mesh->name);
    ok((double)(v.false_shadow + v.false_light + v.not_itself) <= JOINT_RATE * (double)v.shadows,
       "%s: at most %g of the verdicts at joints are wrong", mesh->name, JOINT_RATE);
    ok((double)v.children_differ <= JOINT_RATE * (double)(v.reflected + v.refracted),
       "%s: at most %g of the rays from joints go elsewhere", mesh->name, JOINT_RATE);
    close_stage(&stage);
}

// The norm's target for shadow verdicts; and for secondary rays, which small spheres scatter: the
// normal of a sphere of radius 1/162 turns by 160 times the displacement of the point.
#define VERDICT_RATE 1e-4
#define CHILD_RATE   1e-3
#define OTHER_RATE   2e-3 // camera rays that hit the neighbour of the triangle they should

static void check_scene(const char *name, const struct verdicts *v)
{
    uint64_t children = v->reflected + v->refracted;
    report(name, v);
    ok((double)(v->false_shadow + v->false_light + v->not_itself) <=
           VERDICT_RATE * (double)v->shadows,
       "%s: shadow verdicts right on %g %%", name, 100.0 - 100.0 * VERDICT_RATE);
    ok((double)v->primary_differ <= OTHER_RATE * (double)v->primary,
       "%s: camera rays hit the right primitive", name);
    ok((double)v->children_differ <= CHILD_RATE * (double)children,
       "%s: secondary rays go where they should", name);
    ok(v->beyond_total == 0, "%s: nothing is refracted beyond total reflection", name);
    if (strncmp(name, "mount", 5) == 0)
        ok(v->reflected == v->refracted && v->refracted > 0, "%s: no false total reflection", name);
}

// Random blocks of pixels of one of the scenes.
static void run_scene(const char *name, int blocks)
{
    struct stage stage;
    struct verdicts v = {0};
    struct ref_random random = {9};
    open_stage(&stage, name);
    for (int done_blocks = 0; done_blocks < blocks;) {
        struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
        for (; rays.count < BATCH && done_blocks < blocks; done_blocks++) {
            int x = 16 * (int)ref_below(&random, (uint32_t)stage.view.width / 16);
            int y = 16 * (int)ref_below(&random, (uint32_t)stage.view.height / 16);
            struct rb_span span = {x, y, x + 16, y + 16, 0};
            stage.kernels->generate(&stage.view, &span, &rays);
        }
        judge(&stage, &rays, 0, &v);
    }
    check_scene(name, &v);
    close_stage(&stage);
}

int main(int argc, char **argv)
{
    uint32_t rays = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : RAYS;
    if (rb_queues_alloc(&queues, BATCH, BOUNCES + 1, &failure) != RB_OK)
        give_up("no memory");
    note("Leaks per million rays at fractions of the edge tolerance, %g * 2^-24; the least "
         "tolerance without any",
         (double)RB_EDGE_TOLERANCE * 0x1p24);
    note("%-37s %9s %9s %9s %7s %7s %7s   %6s", "", "0", "1/16", "1/8", "1/4", "1/2", "1", "2^-24");
    for (size_t m = 0; m < sizeof meshes / sizeof *meshes; m++) {
        bend(&meshes[m]);
        for (int origin = 0; origin < ORIGIN_COUNT; origin++)
            for (int vertices = 0; vertices < 2; vertices++)
                measure(&meshes[m], (enum origin)origin, vertices, rays);
    }
    for (size_t m = 0; m < sizeof meshes / sizeof *meshes; m++)
        run_joints(&meshes[m], 1);
    run_scene("balls_low", 64);
    run_scene("balls_medium", 64);
    run_scene("balls_high", 64);
    run_scene("mount_low", 64);
    run_scene("mount_high", 320);
    run_scene("mount_very_high", 128);
    run_scene("mount9", 64);
    rb_queues_free(&queues);
    return done();
}
