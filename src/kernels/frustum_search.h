// A bundle on its way through the wide tree, nearest children first: to the closest hits of its
// rays, or until all of them are known to be occluded.
#ifndef RB_KERNELS_FRUSTUM_SEARCH_H
#define RB_KERNELS_FRUSTUM_SEARCH_H

#include "kernels/frustum_eye.h"
#include "kernels/frustum_leaf.h"

// A child that is still to be visited.
struct visit {
    uint64_t set; // packets that need it, one bit each
    float enter;  // no ray of the bundle enters it before
    rb_wide_child child;
};

static void count_node(const struct bundle *bundle, uint64_t set)
{
    for (; set; set &= set - 1) {
        int p = __builtin_ctzll(set);
        RB_COUNT_AT(bundle_place(bundle, p));
        RB_COUNT_RAYS(NODES, vi_bits(bundle->active[p]), 1);
    }
}

static void count_end(const struct bundle *bundle, uint64_t set)
{
    for (; set; set &= set - 1) {
        int p = __builtin_ctzll(set);
        RB_COUNT_AT(bundle_place(bundle, p));
        RB_COUNT_END(bundle->lanes[p]);
    }
}

// Few packets on the plane meet children there.
RB_INLINE void node_reach(const struct bundle *bundle, int parts, uint64_t set,
                          const struct rb_wide_node *node, struct reach *reach)
{
    if (bundle->frame == FRAME_KNOWN && __builtin_popcountll(set) <= FEW_EYE) {
        rects_reach(bundle, set, node, reach);
        return;
    }
    struct planes planes = planes_of(bundle, node->bounds[0][0]);
    bundle_reach(bundle, parts, set, &planes, reach);
}

// Puts the children that are needed on the stack, the nearest on top.
RB_INLINE int push(const struct rb_wide *wide, const struct bundle *bundle, int parts,
                   struct visit from, struct visit *stack, int depth)
{
    const struct rb_wide_node *node = &wide->nodes[from.child];
    struct reach reach;
    int bottom = depth;
    RB_COUNT(count_node(bundle, from.set));
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    node_reach(bundle, parts, from.set, node, &reach);
    unsigned bits = reach.boxes & ((1u << node->count) - 1);
    for (; bits; bits &= bits - 1) {
        int c = __builtin_ctz(bits), at;
        struct visit visit = {reach.set[c], reach.enter[c], node->child[c]};
        rb_wide_prefetch(wide, visit.child);
        for (at = depth++; at > bottom && stack[at - 1].enter < visit.enter; at--)
            stack[at] = stack[at - 1];
        stack[at] = visit;
    }
    RB_COUNT_DEPTH(depth);
    return depth;
}

// Tests the primitives of a leaf.
RB_INLINE void leaf_closest(const struct rb_world *world, struct bundle *bundle, struct visit visit,
                            enum rb_wide_kind kind, struct rb_hits *hits)
{
    struct leaf leaf;
    struct reach reach;
    uint64_t closer = 0;
    leaf_open(bundle, WHOLES, world->wide, visit.child, kind, visit.set, &leaf, &reach);
    for (unsigned bits = reach.boxes; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        struct primitive with = leaf_primitive(&leaf, lane);
        for (uint64_t set = reach.set[lane] & bundle->open; set; set &= set - 1) {
            int p = __builtin_ctzll(set);
            struct hits hit;
            vint found = leaf_hit(world, bundle, kind, &with, p, false, &hit);
            if (!vi_any(found))
                continue;
            keep_hit(bundle, p, &hit, found, hits);
            closer |= (uint64_t)1 << p;
        }
    }
    bundle_closer(bundle, closer);
}

// The same for rays of one origin. Pairs of a packet and a primitive, a byte for each packet, are
// gone through in one loop: its end is mispredicted once, those of loops within loops each time.
RB_INLINE void leaf_eye(const struct rb_world *world, struct bundle *bundle, struct visit visit,
                        enum rb_wide_kind kind, struct rb_hits *hits)
{
    struct eye_leaf leaf;
    uint64_t pairs[PACKETS / 8] = {0}, closer = 0;
    eye_open(bundle, world->wide, visit.child, kind, &leaf);
    for (uint64_t set = visit.set; set; set &= set - 1) {
        int p = __builtin_ctzll(set);
        pairs[p / 8] |= (uint64_t)eye_meet(bundle, &leaf, p) << p % 8 * 8;
    }
    for (int eight = 0; eight < PACKETS / 8; eight++)
        for (uint64_t left = pairs[eight]; left; left &= left - 1) {
            int pair = __builtin_ctzll(left), p = eight * 8 + pair / 8;
            struct hits hit;
            vint found = eye_hit(bundle, &leaf, pair % 8, p, &hit);
            if (!vi_any(found))
                continue;
            keep_hit(bundle, p, &hit, found, hits);
            closer |= (uint64_t)1 << p;
        }
    bundle_closer(bundle, closer);
}

// Lanes that are found to be occluded cease to be active, and packets without others to be open.
RB_INLINE void leaf_any(const struct rb_world *world, struct bundle *bundle, struct visit visit,
                        enum rb_wide_kind kind)
{
    struct leaf leaf;
    struct reach reach;
    leaf_open(bundle, bundle_parts(bundle), world->wide, visit.child, kind, visit.set, &leaf,
              &reach);
    for (unsigned bits = reach.boxes; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        struct primitive with = leaf_primitive(&leaf, lane);
        for (uint64_t set = reach.set[lane] & bundle->open; set; set &= set - 1) {
            int p = __builtin_ctzll(set);
            struct hits hit;
            vint found = leaf_hit(world, bundle, kind, &with, p, true, &hit);
            if (!vi_any(found))
                continue;
            bundle->active[p] &= ~(found & (hit.t < bundle_limits(bundle, p)));
            if (!vi_any(bundle->active[p]))
                bundle->open &= ~((uint64_t)1 << p);
        }
    }
}

typedef void closest_fn(const struct rb_world *world, struct bundle *bundle, struct visit visit,
                        struct rb_hits *hits);
typedef void any_fn(const struct rb_world *world, struct bundle *bundle, struct visit visit);

// Defines the two searches of leaves of one kind.
#define LEAF(kind, name)                                                                           \
    static void name##_closest(const struct rb_world *world, struct bundle *bundle,                \
                               struct visit visit, struct rb_hits *hits)                           \
    {                                                                                              \
        if (kind != RB_WIDE_OTHERS && bundle_framed(bundle))                                       \
            leaf_eye(world, bundle, visit, kind, hits);                                            \
        else                                                                                       \
            leaf_closest(world, bundle, visit, kind, hits);                                        \
    }                                                                                              \
    static void name##_any(const struct rb_world *world, struct bundle *bundle,                    \
                           struct visit visit)                                                     \
    {                                                                                              \
        leaf_any(world, bundle, visit, kind);                                                      \
    }
LEAF(RB_WIDE_SPHERES, spheres)
LEAF(RB_WIDE_TRIANGLES, triangles)
LEAF(RB_WIDE_OTHERS, others)

static closest_fn *const leaf_closest_of[] = {
    [RB_WIDE_SPHERES] = spheres_closest,
    [RB_WIDE_TRIANGLES] = triangles_closest,
    [RB_WIDE_OTHERS] = others_closest,
};

static any_fn *const leaf_any_of[] = {
    [RB_WIDE_SPHERES] = spheres_any,
    [RB_WIDE_TRIANGLES] = triangles_any,
    [RB_WIDE_OTHERS] = others_any,
};

static void closest(const struct rb_world *world, struct bundle *bundle, struct rb_hits *hits)
{
    const struct rb_wide *wide = world->wide;
    struct visit stack[RB_WIDE_STACK];
    int depth = 0;
    if (wide->count[RB_WIDE_NODE])
        stack[depth++] = (struct visit){bundle->open, 0.0f, 0};
    RB_COUNT_BEGIN(0);
    while (depth > 0) {
        struct visit visit = stack[--depth];
        visit.set &= bundle->open;
        if (visit.enter > bundle->all.limit[0] || !visit.set)
            continue;
        enum rb_wide_kind kind = rb_wide_kind_of(visit.child);
        if (kind == RB_WIDE_NODE)
            depth = push(wide, bundle, WHOLES, visit, stack, depth);
        else
            leaf_closest_of[kind](world, bundle, visit, hits);
    }
}

static void any(const struct rb_world *world, struct bundle *bundle)
{
    const struct rb_wide *wide = world->wide;
    struct visit stack[RB_WIDE_STACK];
    int depth = 0, parts = bundle_parts(bundle);
    if (wide->count[RB_WIDE_NODE])
        stack[depth++] = (struct visit){bundle->open, 0.0f, 0};
    RB_COUNT_BEGIN(0);
    while (depth > 0) {
        struct visit visit = stack[--depth];
        visit.set &= bundle->open;
        if (!visit.set)
            continue;
        enum rb_wide_kind kind = rb_wide_kind_of(visit.child);
        if (kind == RB_WIDE_NODE)
            depth = push(wide, bundle, parts, visit, stack, depth);
        else
            leaf_any_of[kind](world, bundle, visit);
    }
}

#endif
