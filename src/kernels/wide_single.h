// A single ray through the wide tree, from a node on: for wide.c, and for the tails of stream.c.
#ifndef RB_KERNELS_WIDE_SINGLE_H
#define RB_KERNELS_WIDE_SINGLE_H

#include "kernels/wide_ray.h"

// A child that is still to be visited: where the ray meets its box, as the bits of the float, which
// for distances order like it; then the child.
RB_INLINE uint64_t visit_make(float near, rb_wide_child child)
{
    uint32_t bits;
    memcpy(&bits, &near, sizeof bits);
    return (uint64_t)bits << 32 | child;
}

RB_INLINE float visit_near(uint64_t visit)
{
    uint32_t bits = (uint32_t)(visit >> 32);
    float near;
    memcpy(&near, &bits, sizeof near);
    return near;
}

// Puts the children of `bits` on the stack, the nearest on top.
RB_INLINE int push_sorted(const struct rb_wide_node *node, unsigned bits, const float near[RB_WIDE],
                          uint64_t *stack, int depth)
{
    int bottom = depth;
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits), at = depth++;
        uint64_t visit = visit_make(near[lane], node->child[lane]);
        for (; at > bottom && stack[at - 1] < visit; at--)
            stack[at] = stack[at - 1];
        stack[at] = visit;
    }
    RB_COUNT_DEPTH(depth);
    return depth;
}

// One primitive after the other, for what has no vector form: cones, and SPD's one-sided surfaces.
static struct rb_hit leaf_one_by_one(const struct rb_world *world, const uint32_t id[RB_WIDE],
                                     const struct rb_ray *ray, struct rb_hit best)
{
    struct rb_hit hit;
    for (int lane = 0; lane < RB_WIDE && id[lane] != RB_NONE; lane++)
        if (rb_primitive_hit(world->scene, id[lane], ray, &hit) && rb_hit_closer(&hit, &best))
            best = hit;
    return best;
}

RB_INLINE struct wide_hits leaf_part(const struct rb_wide *wide, rb_wide_child leaf, int lane,
                                     const struct wide_ray *ray)
{
    uint32_t index = rb_wide_index_of(leaf);
    if (rb_wide_kind_of(leaf) == RB_WIDE_SPHERES) {
        struct wide_spheres spheres = wide_spheres_load(&wide->spheres[index], lane);
        return wide_spheres_hit(&spheres, ray);
    }
    struct wide_triangles triangles = wide_triangles_load(&wide->triangles[index], lane);
    return wide_triangles_hit(&triangles, ray);
}

RB_INLINE void count_leaf(const struct rb_wide *wide, rb_wide_child leaf)
{
    bool spheres = rb_wide_kind_of(leaf) == RB_WIDE_SPHERES;
    unsigned lanes = wide_lanes(rb_wide_ids(wide, leaf));
    uint32_t count = (uint32_t)__builtin_popcount(lanes);
    (void)lanes, (void)count, (void)spheres;
    RB_COUNT_STEP(lanes, RB_WIDE);
    RB_COUNT_RAYS(BOXES, 1, count);
    RB_COUNT_RAYS(SPHERES, spheres, count);
    RB_COUNT_RAYS(TRIANGLES, !spheres, count);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, spheres ? sizeof *wide->spheres : sizeof *wide->triangles);
}

// The best of the hits and what was best before.
RB_INLINE struct rb_hit keep_closest(const struct wide_hits *hits, struct rb_hit best)
{
    float t[RB_LANES], u[RB_LANES], v[RB_LANES];
    uint32_t prim[RB_LANES];
    unsigned bits = vi_bits(hits->found & (hits->t <= best.t));
    if (!bits)
        return best;
    vf_store(t, hits->t), vf_store(u, hits->u), vf_store(v, hits->v);
    vi_store(prim, hits->prim);
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        struct rb_hit hit = {t[lane], u[lane], v[lane], prim[lane]};
        if (rb_hit_closer(&hit, &best))
            best = hit;
    }
    return best;
}

RB_INLINE struct rb_hit leaf_closest(const struct rb_world *world, rb_wide_child leaf,
                                     const struct wide_ray *ray, struct rb_hit best)
{
    if (rb_wide_kind_of(leaf) == RB_WIDE_OTHERS || ray->sides == RB_SIDES_FRONT)
        return leaf_one_by_one(world, rb_wide_ids(world->wide, leaf), ray->one, best);
    for (int lane = 0; lane < RB_WIDE; lane += RB_LANES) {
        struct wide_hits hits = leaf_part(world->wide, leaf, lane, ray);
        if (vi_any(hits.found))
            best = keep_closest(&hits, best);
    }
    RB_COUNT(count_leaf(world->wide, leaf));
    return best;
}

// The closest hit of `best` and what is below `from`.
static struct rb_hit single_closest(const struct rb_world *world, rb_wide_child from,
                                    const struct wide_ray *ray, struct rb_hit best)
{
    uint64_t stack[RB_WIDE_STACK];
    int depth = 0;
    stack[depth++] = visit_make(0.0f, from);
    while (depth > 0) {
        uint64_t visit = stack[--depth];
        rb_wide_child child = (rb_wide_child)visit;
        if (visit_near(visit) > best.t)
            continue;
        if (rb_wide_kind_of(child) != RB_WIDE_NODE) {
            best = leaf_closest(world, child, ray, best);
            continue;
        }
        const struct rb_wide_node *node = &world->wide->nodes[child];
        float near[RB_WIDE];
        unsigned bits = wide_node(node, ray, vf_set(best.t), near);
        depth = push_sorted(node, bits, near, stack, depth);
    }
    return best;
}

RB_INLINE bool leaf_any(const struct rb_world *world, rb_wide_child leaf,
                        const struct wide_ray *ray, float distance)
{
    if (rb_wide_kind_of(leaf) == RB_WIDE_OTHERS)
        return leaf_one_by_one(world, rb_wide_ids(world->wide, leaf), ray->one, RB_MISS).t <
               distance;
    RB_COUNT(count_leaf(world->wide, leaf));
    for (int lane = 0; lane < RB_WIDE; lane += RB_LANES) {
        struct wide_hits hits = leaf_part(world->wide, leaf, lane, ray);
        if (vi_any(hits.found) && vi_any(hits.found & (hits.t < distance)))
            return true;
    }
    return false;
}

// Is anything below `from` closer than `distance`?
static bool single_any(const struct rb_world *world, rb_wide_child from, const struct wide_ray *ray,
                       float distance)
{
    rb_wide_child stack[RB_WIDE_STACK];
    int depth = 0;
    stack[depth++] = from;
    while (depth > 0) {
        rb_wide_child child = stack[--depth];
        if (rb_wide_kind_of(child) != RB_WIDE_NODE) {
            if (leaf_any(world, child, ray, distance))
                return true;
            continue;
        }
        const struct rb_wide_node *node = &world->wide->nodes[child];
        float near[RB_WIDE];
        for (unsigned bits = wide_node(node, ray, vf_set(distance), near); bits; bits &= bits - 1)
            stack[depth++] = node->child[__builtin_ctz(bits)];
        RB_COUNT_DEPTH(depth);
    }
    return false;
}

#endif
