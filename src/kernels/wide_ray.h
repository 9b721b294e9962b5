// One ray against 8 boxes or 8 primitives at a time, for the kernels that traverse the wide tree:
// rb_box, rb_sphere_hit and rb_triangle_hit of intersect.h, lane by lane, in RB_WIDE / RB_LANES
// vectors. What a block's primitives must pass is a conjunction, so they are tested first and their
// own boxes, which most rays that get this far pass, only where one of them was hit.
#ifndef RB_KERNELS_WIDE_RAY_H
#define RB_KERNELS_WIDE_RAY_H

#include "accel/wide.h"
#include "kernels/intersect.h"
#include "kernels/simd.h"

// Everything here is small only where its arguments are in registers.
#define RB_INLINE static inline __attribute__((always_inline))

// Vectors per node or block.
enum { WIDE_PARTS = RB_WIDE / RB_LANES };

// A ray, the same in all lanes.
struct wide_ray {
    struct vvec o, d, inv;
    int backward[3]; // 1 where the direction is negative: which of two planes is nearer
    vint self;
    enum rb_sides sides;
    const struct rb_ray *one;
};

RB_INLINE void wide_ray_make(const struct rb_ray *ray, struct wide_ray *wide)
{
    wide->o = (struct vvec){vf_set(ray->o.x), vf_set(ray->o.y), vf_set(ray->o.z)};
    wide->d = (struct vvec){vf_set(ray->d.x), vf_set(ray->d.y), vf_set(ray->d.z)};
    wide->inv = (struct vvec){vf_set(ray->inv.x), vf_set(ray->inv.y), vf_set(ray->inv.z)};
    wide->backward[0] = ray->inv.x < 0.0f;
    wide->backward[1] = ray->inv.y < 0.0f;
    wide->backward[2] = ray->inv.z < 0.0f;
    wide->self = vi_set(ray->self);
    wide->sides = ray->sides;
    wide->one = ray;
}

// `r` >= 0 with the sign of `direction`.
RB_INLINE vfloat wide_signed(vfloat r, vfloat direction)
{
    return (vfloat)((vint)r | ((vint)direction & vi_set(0x80000000u)));
}

// rb_safe_inverse
RB_INLINE vfloat wide_inverse(vfloat d)
{
    vfloat magnitude = vf_max(vf_abs(d), vf_set(RB_DIRECTION_MIN));
    return 1.0f / wide_signed(magnitude, d);
}

// rb_box. Rounding is monotone, so scaling the least of the far distances gives the least of the
// scaled ones.
RB_INLINE void wide_slabs(struct vvec near, struct vvec far, const struct wide_ray *ray,
                          vfloat *from, vfloat *to)
{
    near = vv_sub(near, ray->o), far = vv_sub(far, ray->o);
    vfloat near_xy = vf_max(near.x * ray->inv.x, near.y * ray->inv.y);
    vfloat far_xy = vf_min(far.x * ray->inv.x, far.y * ray->inv.y);
    *from = vf_max(vf_max(near_xy, near.z * ray->inv.z), vf_set(0.0f));
    *to = vf_min(far_xy, far.z * ray->inv.z) * RB_FAR_SCALE;
}

// The children that the ray reaches no farther than `limit`, one bit each, and where.
RB_INLINE unsigned wide_node(const struct rb_wide_node *node, const struct wide_ray *ray,
                             vfloat limit, float reach[RB_WIDE])
{
    unsigned bits = 0;
    const int *b = ray->backward;
    for (int lane = 0; lane < RB_WIDE; lane += RB_LANES) {
        struct vvec near = {vf_load(node->bounds[0][b[0]] + lane),
                            vf_load(node->bounds[1][b[1]] + lane),
                            vf_load(node->bounds[2][b[2]] + lane)};
        struct vvec far = {vf_load(node->bounds[0][!b[0]] + lane),
                           vf_load(node->bounds[1][!b[1]] + lane),
                           vf_load(node->bounds[2][!b[2]] + lane)};
        vfloat from, to;
        wide_slabs(near, far, ray, &from, &to);
        vf_store(reach + lane, from);
        bits |= vi_bits(from <= vf_min(to, limit)) << lane;
    }
    RB_COUNT_STEP((1u << node->count) - 1, RB_WIDE);
    RB_COUNT_RAYS(NODES, 1, 1);
    RB_COUNT_RAYS(BOXES, 1, node->count);
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    return bits;
}

// rb_hit of part of a block, lane by lane.
struct wide_hits {
    vfloat t, u, v;
    vint prim, found;
};

// The primitives there are in a block, one bit each.
RB_INLINE unsigned wide_lanes(const uint32_t id[RB_WIDE])
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane++)
        bits |= (id[lane] != RB_NONE ? 1u : 0u) << lane;
    return bits;
}

// Own box, for the lanes that were hit.
RB_INLINE void wide_clamp(struct vvec near, struct vvec far, const struct wide_ray *ray,
                          struct wide_hits *hits)
{
    vfloat from, to;
    wide_slabs(near, far, ray, &from, &to);
    hits->t = vf_min(vf_max(hits->t, from), to);
    hits->found &= (from <= to) & (hits->t > 0.0f);
}

// Part of a block of spheres.
struct wide_spheres {
    struct vvec center;
    vfloat radius;
    vint prim;
};

RB_INLINE struct wide_spheres wide_spheres_load(const struct rb_wide_spheres *block, int lane)
{
    return (struct wide_spheres){
        {vf_load(block->center[0] + lane), vf_load(block->center[1] + lane),
         vf_load(block->center[2] + lane)},
        vf_load(block->radius + lane),
        vi_load(block->id + lane),
    };
}

// Spheres that the ray may hit, its own one excepted. It leaves none of those it hits behind b +
// reach, since rounding is monotone, and so is the root.
RB_INLINE vint wide_spheres_ahead(const struct wide_spheres *spheres, const struct wide_ray *ray)
{
    vfloat square = spheres->radius * spheres->radius, reach = vf_sqrt(square);
    struct vvec l = vv_sub(spheres->center, ray->o);
    vfloat b = vv_dot(l, ray->d);
    struct vvec apart = vv_mad(l, -b, ray->d);
    vfloat discriminant = square - vv_dot(apart, apart);
    return (discriminant >= 0.0f) & (b + reach > 0.0f) & (spheres->prim != ray->self);
}

// rb_sphere_hit
RB_INLINE struct wide_hits wide_spheres_hit(const struct wide_spheres *spheres,
                                            const struct wide_ray *ray)
{
    struct vvec center = spheres->center;
    vfloat radius = spheres->radius;
    struct vvec l = vv_sub(center, ray->o);
    vfloat b = vv_dot(l, ray->d);
    struct vvec apart = vv_mad(l, -b, ray->d);
    vfloat discriminant = radius * radius - vv_dot(apart, apart);
    struct wide_hits hits;
    hits.found = discriminant >= 0.0f;
    hits.prim = spheres->prim;
    vint own = hits.prim == ray->self;
    vfloat root = vf_sqrt(discriminant);
    vfloat enter = b - root, leave = vf_select(own, b + b, b + root);
    vint take_enter = (enter > 0.0f) & ~own;
    if (ray->sides == RB_SIDES_BOTH)
        hits.found &= ~own;
    else
        take_enter &= ~(radius < 0.0f);
    hits.t = vf_select(take_enter, enter, leave);
    hits.found &= hits.t > 0.0f;
    hits.u = hits.v = vf_set(0.0f);
    vfloat r = vf_abs(radius);
    struct vvec toward = {wide_signed(r, ray->inv.x), wide_signed(r, ray->inv.y),
                          wide_signed(r, ray->inv.z)};
    struct vvec near = vv_sub(center, toward);
    struct vvec far = {center.x + toward.x, center.y + toward.y, center.z + toward.z};
    wide_clamp(near, far, ray, &hits);
    return hits;
}

// Lower and upper ends of an axis of boxes, as rb_triangle_bounds has them, swapped for rays that
// go backward.
RB_INLINE void wide_ends(vfloat a, vfloat b, vfloat c, vfloat inv, vfloat *near, vfloat *far)
{
    vfloat low = vf_min(vf_min(a, b), c), high = vf_max(vf_max(a, b), c);
    *near = vf_select(inv < 0.0f, high, low);
    *far = vf_select(inv < 0.0f, low, high);
}

RB_INLINE struct vvec wide_vertex(const struct rb_wide_triangles *block, int i, int lane)
{
    return (struct vvec){vf_load(block->v[i][0] + lane), vf_load(block->v[i][1] + lane),
                         vf_load(block->v[i][2] + lane)};
}

// Part of a block of triangles, with what of them does not depend on the ray.
struct wide_triangles {
    struct vvec v0, v1, v2, e1, e2;
    vfloat reach; // of the edges
    vint prim;
};

RB_INLINE struct wide_triangles wide_triangles_load(const struct rb_wide_triangles *block, int lane)
{
    struct wide_triangles of;
    of.v0 = wide_vertex(block, 0, lane);
    of.v1 = wide_vertex(block, 1, lane);
    of.v2 = wide_vertex(block, 2, lane);
    of.e1 = vv_sub(of.v1, of.v0);
    of.e2 = vv_sub(of.v2, of.v0);
    of.reach = vf_max(vv_reach(of.e1), vv_reach(of.e2));
    of.prim = vi_load(block->id + lane);
    return of;
}

// How the ray passes the edges of triangles: what rb_triangle_test calls so.
struct wide_edges {
    vfloat us, vs, area, t; // t times area
    vint found;
};

RB_INLINE struct wide_edges wide_triangles_edges(const struct wide_triangles *of,
                                                 const struct wide_ray *ray)
{
    struct vvec s = vv_sub(ray->o, of->v0), p = vv_cross(ray->d, of->e2), q = vv_cross(s, of->e1);
    vfloat det = vv_dot(of->e1, p), area = vf_abs(det);
    vint flip = (vint)det & vi_set(0x80000000u); // a product with the sign of det
    vfloat us = (vfloat)((vint)vv_dot(s, p) ^ flip);
    vfloat vs = (vfloat)((vint)vv_dot(ray->d, q) ^ flip);
    vfloat t = (vfloat)((vint)vv_dot(of->e2, q) ^ flip);
    vfloat slack = RB_EDGE_TOLERANCE * vv_reach(s) * of->reach;
    vint found = (us >= -slack) & (vs >= -slack) & (us + vs <= area + slack) & (area >= FLT_MIN) &
                 (of->prim != ray->self);
    return (struct wide_edges){us, vs, area, t, found};
}

// rb_triangle_hit
RB_INLINE struct wide_hits wide_triangles_hit(const struct wide_triangles *of,
                                              const struct wide_ray *ray)
{
    struct wide_edges edges = wide_triangles_edges(of, ray);
    struct wide_hits hits = {.found = edges.found, .prim = of->prim};
    if (!vi_any(hits.found))
        return hits;
    vfloat inverse = 1.0f / edges.area, zero = vf_set(0.0f), one = vf_set(1.0f);
    hits.t = edges.t * inverse;
    hits.u = vf_min(vf_max(edges.us * inverse, zero), one);
    hits.v = vf_min(vf_max(edges.vs * inverse, zero), one - hits.u);
    struct vvec near, far;
    wide_ends(of->v0.x, of->v1.x, of->v2.x, ray->inv.x, &near.x, &far.x);
    wide_ends(of->v0.y, of->v1.y, of->v2.y, ray->inv.y, &near.y, &far.y);
    wide_ends(of->v0.z, of->v1.z, of->v2.z, ray->inv.z, &near.z, &far.z);
    wide_clamp(near, far, ray, &hits);
    return hits;
}

#endif
