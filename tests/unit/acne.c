// No acne: what starts on a surface meets what it would meet if it started on the exact surface.
//
// Looked for in the six scenes and at the joints of the meshes: shadow, reflected and refracted
// rays as the kernels start them, against those that the double-precision reference starts at the
// exact hit. Limits are rates, because points within rounding of an edge have no right answer.
#include "render/queues.h"
#include "render/settings.h"
#include "render/variants.h"
#include "tests/support/meshes.h"
#include "tests/support/stage.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <string.h>

enum { BATCH = 4096, BOUNCES = 4 };

static struct rb_queues queues;
static const struct rb_kernels *kernels;
static struct rb_shading shading; // of the scene on stage

// What a scene's surface points came to.
struct verdicts {
    uint64_t primary, primary_differ, lost;      // lost: camera rays that hit nothing
    uint64_t shadows, false_shadow, false_light; // verdicts on lit-facing points
    uint64_t itself, not_itself; // behind the own sphere or cone; not_itself: lit all the same
    uint64_t reflected, refracted, children_differ;
    uint64_t beyond_total; // refracted where the exact ray is totally reflected
    double gap, depth;     // ulps that the worst wrong verdicts are off
};

// Sets the shading of a scene; returns its view.
static struct rb_view light_up(const struct rb_scene *scene)
{
    struct rb_settings settings = {0};
    stage_check(rb_settings_complete(&settings, scene, &stage_failure));
    shading = rb_shading_make(scene, &settings);
    return rb_view_make(scene, &settings);
}

// A ray's exact hit and the exact point.
struct exact {
    struct ref_hit hit;
    double p[3], n[3], d[3]; // n: shading normal, turned against d
    bool entering, same;     // same: the kernel hit the same primitive
};

static void find_exact(const struct stage *stage, const struct rb_rays *rays, uint32_t i,
                       struct exact *exact)
{
    struct ref_ray ray = stage_ray(rays, i);
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
    kernels->trace(&stage->world, children, &queues.hits);
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
    kernels->trace(&stage->world, rays, &queues.hits);
    for (uint32_t i = 0; i < rays->count; i++) {
        rays->pixel[i] = i;
        find_exact(stage, rays, i, &exact[bounce][i]);
        v->primary += bounce == 0;
        v->primary_differ += bounce == 0 && !exact[bounce][i].same;
        v->lost += bounce == 0 && queues.hits.prim[i] == RB_NONE;
    }
    queues.surfaces.count = 0;
    kernels->surface(&stage->world, &shading, rays, &queues.hits, &queues.surfaces, &reflected,
                     &refracted, &film);
    struct rb_light_sample sample = {0};
    for (; sample.light < stage->scene.light_count; sample.light++) {
        queues.shadows.count = 0;
        kernels->light(&stage->world, &shading, &queues.surfaces, &sample, &queues.shadows);
        kernels->trace_shadow(&stage->world, &queues.shadows);
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
    double s = mesh->shift;
    struct rb_scene_builder builder = {
        .camera = {{s - 1.6, s + 1.6, s + 1.7}, {s, s, s}, {0, 0, 1}, 45.0, 0.01, 64, 64}};
    const double white[3] = {1, 1, 1}, light[3] = {s - 100, s - 100, s + 100};
    stage_check(rb_scene_add_light(&builder, light, white, &stage_failure));
    stage_check(rb_scene_add_material(&builder, white, 0.5, 0.1, 10.0, 0.9, 1.2, &stage_failure));
    for (int y = 0; y < GRID; y++)
        for (int x = 0; x < GRID; x++)
            for (int which = 0; which < 2; which++) {
                struct rb_triangle triangle = mesh_triangle(mesh, x, y, which);
                double v[3][3];
                for (int i = 0; i < 9; i++)
                    v[i / 3][i % 3] = (double)triangle.v[i / 3][i % 3];
                stage_check(
                    rb_scene_add_triangle(&builder, (const double(*)[3])v, NULL, &stage_failure));
            }
    stage_build(stage, &builder);
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
    light_up(&stage.scene);
    for (int batch = 0; batch < batches; batch++) {
        struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
        while (rays.count < BATCH) {
            struct joint joint;
            enum origin origin = (enum origin)ref_below(&random, ORIGIN_COUNT);
            struct rb_ray ray = mesh_aim(mesh, &random, origin, ref_below(&random, 2), &joint);
            stage_push(&rays, ray.o, ray.d);
        }
        judge(&stage, &rays, 0, &v);
    }
    report(mesh->name, &v);
    ok(v.lost == 0, "%s: every ray aimed at a joint hits the mesh", mesh->name);
    ok((double)(v.false_shadow + v.false_light + v.not_itself) <= JOINT_RATE * (double)v.shadows,
       "%s: at most %g of the verdicts at joints are wrong", mesh->name, JOINT_RATE);
    ok((double)v.children_differ <= JOINT_RATE * (double)(v.reflected + v.refracted),
       "%s: at most %g of the rays from joints go elsewhere", mesh->name, JOINT_RATE);
    stage_close(&stage);
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
    stage_load(&stage, name);
    struct rb_view view = light_up(&stage.scene);
    for (int done_blocks = 0; done_blocks < blocks;) {
        struct rb_rays rays = rb_rays_view(&queues.rays[0], 0, 0, BATCH);
        for (; rays.count < BATCH && done_blocks < blocks; done_blocks++) {
            int x = 16 * (int)ref_below(&random, (uint32_t)view.width / 16);
            int y = 16 * (int)ref_below(&random, (uint32_t)view.height / 16);
            struct rb_span span = {x, y, x + 16, y + 16, 0};
            kernels->generate(&view, &span, &rays);
        }
        judge(&stage, &rays, 0, &v);
    }
    check_scene(name, &v);
    stage_close(&stage);
}

int main(void)
{
    stage_check(rb_queues_alloc(&queues, BATCH, BOUNCES + 1, &stage_failure));
    kernels = rb_variant_fastest()->kernels;
    for (int m = 0; m < MESH_COUNT; m++)
        run_joints(mesh_make(m), 1);
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
