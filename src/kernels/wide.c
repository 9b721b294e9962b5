// One ray at a time through the wide tree: 8 boxes of a node, 8 primitives of a leaf, by one
// vector operation each (Wald, Benthin, Boulos 2008, "Getting rid of packets"). Unlike packets it
// needs no coherence between rays. Children are visited nearest first and culled again when their
// turn comes; an order given by the octant of the direction alone was rejected, it visits more.
//
// Compiled once per instruction set (Makefile); the object's name of the kernel set comes with it.
#include "kernels/wide_lanes.h"

#include "kernels/one_by_one.h"
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
#include "kernels/wide_single.h"

#ifndef RB_WIDE_SET
#ifdef __aarch64__
#define RB_WIDE_SET rb_kernels_wide_neon
#else
#define RB_WIDE_SET rb_kernels_wide_sse2
#endif
#endif

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(RB_WIDE_SET) = {
    .generate = generate,
    .trace = trace,
    .surface = surface,
    .light = light,
    .trace_shadow = trace_shadow,
};

static struct rb_hit closest(const struct rb_world *world, const struct rb_ray *one)
{
    struct rb_hit best = rb_planes_closest(world->scene, one);
    struct wide_ray ray;
    wide_ray_make(one, &ray);
    return world->wide->count[RB_WIDE_NODE] ? single_closest(world, 0, &ray, best) : best;
}

static bool any(const struct rb_world *world, const struct rb_ray *one, float distance)
{
    struct wide_ray ray;
    wide_ray_make(one, &ray);
    return rb_planes_any(world->scene, one, distance) ||
           (world->wide->count[RB_WIDE_NODE] && single_any(world, 0, &ray, distance));
}

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    trace_one_by_one(world, rays, hits, closest);
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    trace_shadow_one_by_one(world, shadows, any);
}
