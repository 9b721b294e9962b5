// Packets: as many rays as the vector has lanes go through the binary BVH together, each box and
// each primitive tested against all of them at once (Wald, Slusallek, Benthin, Wagner 2001,
// "Interactive rendering with coherent ray tracing"). A child is visited if any ray needs it. What
// is gained on coherent rays is lost again where the rays of a packet part; single rays win there
// (bvh.c).
//
// Compiled once per instruction set (Makefile); the object's name of the kernel set comes with it.
#include "accel/bvh.h"
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
#include "kernels/packet_trace.h"

#ifndef RB_PACKET
#ifdef __aarch64__
#define RB_PACKET rb_kernels_packet_neon
#else
#define RB_PACKET rb_kernels_packet_sse2
#endif
#endif

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(RB_PACKET) = {
    .generate = generate,
    .trace = trace,
    .surface = surface,
    .light = light,
    .trace_shadow = trace_shadow,
};

// A child that is still to be visited, and where its box begins for each ray; infinite for rays
// that do not pass it.
struct visit {
    uint32_t child, count; // as in rb_bvh_node
    vfloat near;
};

static inline struct visit visit_child(const struct rb_bvh_node *node, int c,
                                       const struct packet *packet, vfloat limit, vint active)
{
    float low[3] = {node->bounds[0][0][c], node->bounds[1][0][c], node->bounds[2][0][c]};
    float high[3] = {node->bounds[0][1][c], node->bounds[1][1][c], node->bounds[2][1][c]};
    struct interval range = box(low, high, packet);
    vint passes = active & (range.near <= range.far) & (range.near <= limit);
    return (struct visit){node->child[c], node->count[c],
                          vf_select(passes, range.near, vf_set(INFINITY))};
}

// Pushes the children that any ray of the packet needs; the one that more rays reach first on top.
static inline int push_children(const struct rb_bvh_node *node, const struct packet *packet,
                                vfloat limit, vint active, struct visit *stack, int depth)
{
    struct visit a = visit_child(node, 0, packet, limit, active);
    struct visit b = visit_child(node, 1, packet, limit, active);
    RB_COUNT_STEP(vi_bits(active), RB_LANES);
    RB_COUNT_RAYS(NODES, vi_bits(active), 1);
    RB_COUNT_RAYS(BOXES, vi_bits(active), 2);
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    unsigned in_a = vi_bits(a.near < INFINITY), in_b = vi_bits(b.near < INFINITY);
    int a_first = __builtin_popcount(vi_bits(a.near < b.near));
    int b_first = __builtin_popcount(vi_bits(b.near < a.near));
    if (in_b && a_first >= b_first)
        stack[depth++] = b;
    if (in_a)
        stack[depth++] = a;
    if (in_b && a_first < b_first)
        stack[depth++] = b;
    RB_COUNT_DEPTH(depth);
    return depth;
}

static struct hits closest(const struct rb_world *world, const struct packet *packet, vint active)
{
    const struct rb_scene *scene = world->scene;
    const struct rb_bvh *bvh = world->bvh;
    struct hits best = {vf_set(INFINITY), vf_set(0.0f), vf_set(0.0f), vi_set(RB_NONE)}, hit;
    struct visit stack[RB_BVH_DEPTH_MAX + 2];
    int depth = 0;
    for (uint32_t i = 0; i < scene->count[RB_PLANE]; i++) {
        vint found = active & plane_hit(scene, i, packet, active, &hit);
        keep_closest(&best, &hit, found);
    }
    if (bvh->node_count)
        stack[depth++] = (struct visit){0, 0, vf_select(active, vf_set(0.0f), vf_set(INFINITY))};
    while (depth > 0) {
        struct visit visit = stack[--depth];
        vint reached = active & (visit.near <= best.t) & (visit.near < INFINITY);
        if (!vi_any(reached))
            continue;
        if (visit.count == 0)
            depth = push_children(&bvh->nodes[visit.child], packet, best.t, reached, stack, depth);
        RB_COUNT_BYTES(TREE_BYTES, visit.count * sizeof *bvh->refs);
        for (uint32_t i = 0; i < visit.count; i++) {
            vint found = primitive_hit(scene, bvh->refs[visit.child + i], packet, reached, &hit);
            if (vi_any(found))
                keep_closest(&best, &hit, found);
        }
    }
    return best;
}

// Lanes of `active` with something closer than `distance`.
static vint any(const struct rb_world *world, const struct packet *packet, vfloat distance,
                vint active)
{
    const struct rb_scene *scene = world->scene;
    const struct rb_bvh *bvh = world->bvh;
    struct hits hit;
    struct visit stack[RB_BVH_DEPTH_MAX + 2];
    int depth = 0;
    vint open = active; // nothing found yet
    for (uint32_t i = 0; i < scene->count[RB_PLANE]; i++) {
        vint found = plane_hit(scene, i, packet, open, &hit);
        open &= ~(found & (hit.t < distance));
    }
    if (bvh->node_count)
        stack[depth++] = (struct visit){0, 0, vf_set(0.0f)};
    while (depth > 0) {
        struct visit visit = stack[--depth];
        vint reached = open & (visit.near < INFINITY);
        if (!vi_any(reached))
            continue;
        if (visit.count == 0)
            depth =
                push_children(&bvh->nodes[visit.child], packet, distance, reached, stack, depth);
        RB_COUNT_BYTES(TREE_BYTES, visit.count * sizeof *bvh->refs);
        for (uint32_t i = 0; i < visit.count; i++) {
            vint found = primitive_hit(scene, bvh->refs[visit.child + i], packet, reached, &hit);
            open &= ~(found & (hit.t < distance));
        }
    }
    return active & ~open;
}

// SPD's one-sided surfaces are a matter of tests, not of speed: single rays do.
static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    if (world->one_sided) {
        RB_TWIN(rb_kernels_bvh).trace(world, rays, hits);
        return;
    }
    for (uint32_t i = 0; i < rays->count; i += RB_LANES) {
        struct vvec o = {vf_load(rays->ox + i), vf_load(rays->oy + i), vf_load(rays->oz + i)};
        struct vvec d = {vf_load(rays->dx + i), vf_load(rays->dy + i), vf_load(rays->dz + i)};
        struct packet packet = packet_make(o, d, vi_load(rays->self + i), false);
        vint active = vi_first(rays->count - i) & vv_finite(o) & vv_finite(d);
        RB_COUNT_BEGIN(i);
        struct hits best = closest(world, &packet, active);
        RB_COUNT_END(vi_bits(active));
        RB_COUNT_RAYS(HITS, vi_bits(best.prim != vi_set(RB_NONE)), 1);
        hits_store(hits, i, &best);
    }
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    for (uint32_t i = 0; i < shadows->count; i += RB_LANES) {
        struct vvec o = {vf_load(shadows->ox + i), vf_load(shadows->oy + i),
                         vf_load(shadows->oz + i)};
        struct vvec d = {vf_load(shadows->dx + i), vf_load(shadows->dy + i),
                         vf_load(shadows->dz + i)};
        struct packet packet = packet_make(o, d, vi_load(shadows->self + i), true);
        vint active = vi_first(shadows->count - i) & vv_finite(o) & vv_finite(d);
        RB_COUNT_BEGIN(i);
        unsigned occluded = vi_bits(any(world, &packet, vf_load(shadows->distance + i), active));
        RB_COUNT_END(vi_bits(active));
        RB_COUNT_RAYS(OCCLUDED, occluded, 1);
        for (uint32_t lane = 0; lane < RB_LANES && i + lane < shadows->count; lane++)
            shadows->occluded[i + lane] = occluded >> lane & 1;
    }
}
