// The kernels trace and trace_shadow of sets that answer one ray after the other. Their answers
// come from two functions, which are known where these are inlined.
#ifndef RB_KERNELS_ONE_BY_ONE_H
#define RB_KERNELS_ONE_BY_ONE_H

#include "kernels/intersect.h"

// The closest hit of a ray; whether it hits anything before a distance.
typedef struct rb_hit one_closest_fn(const struct rb_world *world, const struct rb_ray *ray);
typedef bool one_any_fn(const struct rb_world *world, const struct rb_ray *ray, float distance);

static inline __attribute__((always_inline)) void trace_one_by_one(const struct rb_world *world,
                                                                   const struct rb_rays *rays,
                                                                   struct rb_hits *hits,
                                                                   one_closest_fn *closest)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        struct rb_ray ray = rb_ray_load(rays, i, world->one_sided);
        RB_COUNT_BEGIN(i);
        struct rb_hit hit = rb_ray_valid(&ray) ? closest(world, &ray) : RB_MISS;
        RB_COUNT_END(1);
        RB_COUNT_RAYS(HITS, hit.prim != RB_NONE, 1);
        rb_hit_store(hits, i, &hit);
    }
}

static inline __attribute__((always_inline)) void
trace_shadow_one_by_one(const struct rb_world *world, struct rb_shadows *shadows, one_any_fn *any)
{
    for (uint32_t i = 0; i < shadows->count; i++) {
        struct rb_ray ray = rb_shadow_load(shadows, i);
        RB_COUNT_BEGIN(i);
        shadows->occluded[i] = rb_ray_valid(&ray) && any(world, &ray, shadows->distance[i]);
        RB_COUNT_END(1);
        RB_COUNT_RAYS(OCCLUDED, shadows->occluded[i], 1);
    }
}

#endif
