// The primitives of a leaf against the packets of a bundle. What none of the rays can meet is found
// out for 8 primitives and all rays at once, then for one primitive and all packets at once.
#ifndef RB_KERNELS_FRUSTUM_LEAF_H
#define RB_KERNELS_FRUSTUM_LEAF_H

#include "kernels/frustum_bundle.h"

// A leaf with the own boxes of its primitives.
struct leaf {
    const struct rb_wide *wide;
    enum rb_wide_kind kind;
    uint32_t block;
    const uint32_t *ids;
    float bounds[3][2][RB_WIDE];
};

RB_INLINE void sphere_bounds(struct leaf *leaf)
{
    const struct rb_wide_spheres *block = &leaf->wide->spheres[leaf->block];
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        vfloat radius = vf_abs(vf_load8(block->radius + lane));
        for (int k = 0; k < 3; k++) {
            vfloat center = vf_load8(block->center[k] + lane);
            vfloat low = center - radius, high = center + radius;
            vf_store8(leaf->bounds[k][0] + lane, low);
            vf_store8(leaf->bounds[k][1] + lane, high);
        }
    }
}

RB_INLINE void triangle_bounds(struct leaf *leaf)
{
    const struct rb_wide_triangles *block = &leaf->wide->triangles[leaf->block];
    for (int lane = 0; lane < RB_WIDE; lane += BOXES)
        for (int k = 0; k < 3; k++) {
            vfloat a = vf_load8(block->v[0][k] + lane), b = vf_load8(block->v[1][k] + lane);
            vfloat c = vf_load8(block->v[2][k] + lane);
            vfloat low = vf_min(vf_min(a, b), c), high = vf_max(vf_max(a, b), c);
            vf_store8(leaf->bounds[k][0] + lane, low);
            vf_store8(leaf->bounds[k][1] + lane, high);
        }
}

// The primitives there are, one bit each.
static unsigned leaf_lanes(const uint32_t ids[RB_WIDE])
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane++)
        bits |= (ids[lane] != RB_NONE ? 1u : 0u) << lane;
    return bits;
}

// Opens a leaf for the packets of `set`, and finds which of them may meet which primitive. The
// bounds of missing ones are NaN, and no beam meets them.
RB_INLINE void leaf_open(const struct bundle *bundle, int parts, const struct rb_wide *wide,
                         rb_wide_child child, enum rb_wide_kind kind, uint64_t set,
                         struct leaf *leaf, struct reach *reach)
{
    leaf->wide = wide;
    leaf->kind = kind;
    leaf->block = rb_wide_index_of(child);
    leaf->ids = rb_wide_ids(wide, child);
    if (kind == RB_WIDE_SPHERES)
        sphere_bounds(leaf);
    else if (kind == RB_WIDE_TRIANGLES)
        triangle_bounds(leaf);
    if (kind == RB_WIDE_OTHERS) {
        reach->boxes = leaf_lanes(leaf->ids);
        for (int lane = 0; lane < RB_WIDE; lane++)
            reach->set[lane] = set;
        return;
    }
    struct planes planes = planes_of(bundle, leaf->bounds[0][0]);
    bundle_reach(bundle, parts, set, &planes, reach);
}

// One primitive of a leaf; of `sphere` and `triangle` that which it is.
struct primitive {
    struct rb_sphere sphere;
    struct rb_triangle triangle;
    float low[3], high[3];
    uint32_t id;
};

RB_INLINE struct primitive leaf_primitive(const struct leaf *leaf, int lane)
{
    struct primitive primitive = {.id = leaf->ids[lane]};
    if (leaf->kind == RB_WIDE_SPHERES) {
        const struct rb_wide_spheres *block = &leaf->wide->spheres[leaf->block];
        primitive.sphere = (struct rb_sphere){
            {block->center[0][lane], block->center[1][lane], block->center[2][lane]},
            block->radius[lane]};
    } else if (leaf->kind == RB_WIDE_TRIANGLES) {
        const struct rb_wide_triangles *block = &leaf->wide->triangles[leaf->block];
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++)
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++)
                primitive.triangle.v[i][k] = block->v[i][k][lane];
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        primitive.low[k] = leaf->bounds[k][0][lane];
        primitive.high[k] = leaf->bounds[k][1][lane];
    }
    return primitive;
}

// Lanes of packet p that meet a primitive.
RB_INLINE vint leaf_hit(const struct rb_world *world, struct bundle *bundle, enum rb_wide_kind kind,
                        const struct primitive *with, int p, bool shadow, struct hits *hit)
{
    struct packet packet = bundle_packet(bundle, p, shadow);
    vint active = bundle->active[p], found;
    RB_COUNT_AT(bundle_place(bundle, p));
    *hit = (struct hits){.prim = vi_set(with->id)};
    vint own = packet.self == hit->prim;
    if (kind == RB_WIDE_SPHERES)
        found = sphere_hit(&with->sphere, with->low, with->high, &packet, active, own, hit);
    else if (kind == RB_WIDE_TRIANGLES)
        found = triangle_hit(&with->triangle, with->low, with->high, &packet, active, own, hit);
    else
        found = primitive_hit(world->scene, with->id, &packet, active, hit);
    found &= hit->t > 0.0f;
    if (!vi_any(found))
        bundle_in_vain(bundle, p);
    return found;
}

#endif
