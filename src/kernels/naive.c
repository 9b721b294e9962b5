// The frozen reference: every ray against every primitive, in the order of ids, without any tree.
// It is the meaning of all other kernel sets; do not make it fast.
#include "kernels/intersect.h"

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(rb_kernels_naive) = {
    .generate = RB_TWIN(rb_scalar_generate),
    .trace = trace,
    .surface = RB_TWIN(rb_scalar_surface),
    .light = RB_TWIN(rb_scalar_light),
    .trace_shadow = trace_shadow,
};

static struct rb_hit closest(const struct rb_scene *scene, const struct rb_ray *ray)
{
    struct rb_hit best = rb_planes_closest(scene, ray), hit;
    for (uint32_t i = 0; i < scene->count[RB_SPHERE]; i++)
        if (rb_sphere_hit(scene, i, ray, &hit) && rb_hit_closer(&hit, &best))
            best = hit;
    for (uint32_t i = 0; i < scene->count[RB_TRIANGLE]; i++)
        if (rb_triangle_hit(scene, i, ray, &hit) && rb_hit_closer(&hit, &best))
            best = hit;
    for (uint32_t i = 0; i < scene->count[RB_CONE]; i++)
        if (rb_cone_hit(scene, i, ray, &hit) && rb_hit_closer(&hit, &best))
            best = hit;
    return best;
}

static bool any(const struct rb_scene *scene, const struct rb_ray *ray, float distance)
{
    struct rb_hit hit;
    for (uint32_t i = 0; i < scene->count[RB_SPHERE]; i++)
        if (rb_sphere_hit(scene, i, ray, &hit) && hit.t < distance)
            return true;
    for (uint32_t i = 0; i < scene->count[RB_TRIANGLE]; i++)
        if (rb_triangle_hit(scene, i, ray, &hit) && hit.t < distance)
            return true;
    for (uint32_t i = 0; i < scene->count[RB_CONE]; i++)
        if (rb_cone_hit(scene, i, ray, &hit) && hit.t < distance)
            return true;
    return rb_planes_any(scene, ray, distance);
}

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        struct rb_ray ray = rb_ray_load(rays, i, world->one_sided);
        RB_COUNT_BEGIN(i);
        struct rb_hit hit = rb_ray_valid(&ray) ? closest(world->scene, &ray) : RB_MISS;
        RB_COUNT_RAYS(HITS, hit.prim != RB_NONE, 1);
        rb_hit_store(hits, i, &hit);
    }
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    for (uint32_t i = 0; i < shadows->count; i++) {
        struct rb_ray ray = rb_shadow_load(shadows, i);
        RB_COUNT_BEGIN(i);
        shadows->occluded[i] = rb_ray_valid(&ray) && any(world->scene, &ray, shadows->distance[i]);
        RB_COUNT_RAYS(OCCLUDED, shadows->occluded[i], 1);
    }
}
