// The frozen reference: every ray against every primitive, in the order of ids, without any tree.
// It is the meaning of all other kernel sets; do not make it fast.
#include "kernels/one_by_one.h"

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(rb_kernels_naive) = {
    .generate = RB_TWIN(rb_scalar_generate),
    .trace = trace,
    .surface = RB_TWIN(rb_scalar_surface),
    .light = RB_TWIN(rb_scalar_light),
    .trace_shadow = trace_shadow,
};

static struct rb_hit closest(const struct rb_world *world, const struct rb_ray *ray)
{
    const struct rb_scene *scene = world->scene;
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

static bool any(const struct rb_world *world, const struct rb_ray *ray, float distance)
{
    const struct rb_scene *scene = world->scene;
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
    trace_one_by_one(world, rays, hits, closest);
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    trace_shadow_one_by_one(world, shadows, any);
}
