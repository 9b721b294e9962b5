// A packet of RB_LANES rays against one box or one primitive: the tests of intersect.h, lane by
// lane.
#ifndef RB_KERNELS_PACKET_TRACE_H
#define RB_KERNELS_PACKET_TRACE_H

#include "kernels/intersect.h"
#include "kernels/simd.h"

// Inlined whatever the compiler thinks of it: fast only where its arguments are in registers.
#define RB_INLINE static inline __attribute__((always_inline))

// rb_ray, lane by lane. All rays of a packet are of one kind.
struct packet {
    struct vvec o, d, inv;
    vint self;
    bool shadow;
};

// rb_hit, lane by lane.
struct hits {
    vfloat t, u, v;
    vint prim;
};

RB_INLINE struct hits hits_load(const struct rb_hits *hits, uint32_t i)
{
    return (struct hits){vf_load(hits->t + i), vf_load(hits->u + i), vf_load(hits->v + i),
                         vi_load(hits->prim + i)};
}

RB_INLINE void hits_store(struct rb_hits *to, uint32_t i, const struct hits *hits)
{
    vf_store(to->t + i, hits->t);
    vf_store(to->u + i, hits->u);
    vf_store(to->v + i, hits->v);
    vi_store(to->prim + i, hits->prim);
}

struct interval {
    vfloat near, far;
};

static inline vfloat safe_inverse(vfloat d)
{
    vfloat magnitude = vf_max(vf_abs(d), vf_set(RB_DIRECTION_MIN));
    vint sign = (vint)d & vi_set(0x80000000u);
    return 1.0f / (vfloat)((vint)magnitude | sign);
}

static inline struct packet packet_make(struct vvec o, struct vvec d, vint self, bool shadow)
{
    struct vvec inv = {safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z)};
    return (struct packet){o, d, inv, self, shadow};
}

// One ray of the packet, for what is too rare to have a vector form.
static struct rb_ray packet_ray(const struct packet *packet, int lane)
{
    struct rb_vec o = {packet->o.x[lane], packet->o.y[lane], packet->o.z[lane]};
    struct rb_vec d = {packet->d.x[lane], packet->d.y[lane], packet->d.z[lane]};
    return rb_ray_make(o, d, (uint32_t)packet->self[lane],
                       packet->shadow ? RB_SIDES_BOTH : RB_SIDES_VISIBLE);
}

// rb_slab. Which plane is nearer need not be asked: it is the one whose distance is less.
RB_INLINE void slab(float low, float high, vfloat o, vfloat inv, struct interval *range)
{
    vfloat t_low = (low - o) * inv, t_high = (high - o) * inv;
    range->near = vf_max(range->near, vf_min(t_low, t_high));
    range->far = vf_min(range->far, vf_max(t_low, t_high));
}

// rb_box. Rounding is monotone, so scaling the least of the far distances gives the least of the
// scaled ones.
RB_INLINE struct interval box(const float low[3], const float high[3], const struct packet *packet)
{
    struct interval range = {vf_set(0.0f), vf_set(INFINITY)};
    slab(low[0], high[0], packet->o.x, packet->inv.x, &range);
    slab(low[1], high[1], packet->o.y, packet->inv.y, &range);
    slab(low[2], high[2], packet->o.z, packet->inv.z, &range);
    range.far *= RB_FAR_SCALE;
    return range;
}

// The own box comes last: most of what misses a primitive misses its formula.
static inline void count_primitive(enum rb_counter kind, vint active, vint inside, size_t bytes)
{
    (void)kind, (void)active, (void)inside, (void)bytes;
    RB_COUNT_STEP(vi_bits(active), RB_LANES);
    RB_COUNT(rb_counting_rays(kind, vi_bits(active), 1));
    RB_COUNT_RAYS(BOXES, vi_bits(inside), 1);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, bytes);
}

// How the rays of a packet pass a sphere: what rb_sphere_test calls so.
struct sphere_line {
    vfloat b, discriminant;
};

// `l` from the origins to the centre.
RB_INLINE struct sphere_line sphere_pass(struct vvec l, struct vvec d, float square)
{
    vfloat b = vv_dot(l, d);
    struct vvec apart = vv_mad(l, -b, d);
    return (struct sphere_line){b, square - vv_dot(apart, apart)};
}

// The rest of the test, for lanes of `inside`, whose discriminant is not negative.
RB_INLINE vint sphere_root(const struct sphere_line *line, bool inside_only, const float low[3],
                           const float high[3], const struct packet *packet, vint inside, vint own,
                           struct hits *hit)
{
    vfloat root = vf_sqrt(line->discriminant), b = line->b;
    vfloat near = b - root, far = vf_select(own, b + b, b + root);
    vint take_near = (near > 0.0f) & ~own;
    if (inside_only)
        take_near = vi_set(0);
    vfloat t = vf_select(take_near, near, far);
    struct interval range = box(low, high, packet);
    hit->t = vf_min(vf_max(t, range.near), range.far);
    hit->u = hit->v = vf_set(0.0f);
    inside &= (range.near <= range.far) & (t > 0.0f);
    return packet->shadow ? inside & ~own : inside;
}

// rb_sphere_test, own box from `low` to `high` included, for rays that see both sides or what a
// negative radius leaves.
RB_INLINE vint sphere_hit(const struct rb_sphere *sphere, const float low[3], const float high[3],
                          const struct packet *packet, vint active, vint own, struct hits *hit)
{
    float radius = sphere->radius;
    struct sphere_line line =
        sphere_pass(vv_sub(vv_set(sphere->center), packet->o), packet->d, radius * radius);
    vint inside = active & (line.discriminant >= 0.0f);
    count_primitive(RB_COUNT_SPHERES, active, inside, sizeof *sphere);
    if (!vi_any(inside))
        return inside;
    bool inside_only = radius < 0.0f && !packet->shadow;
    return sphere_root(&line, inside_only, low, high, packet, inside, own, hit);
}

// How the rays of a packet pass the edges of a triangle: what rb_triangle_test calls so.
struct triangle_edges {
    vfloat us, vs, area;
    vint flip; // the sign of the determinant
};

// `q` is s x e1.
RB_INLINE struct triangle_edges triangle_pass(struct vvec s, struct vvec e1, struct vvec e2,
                                              struct vvec q, struct vvec d)
{
    struct triangle_edges edges;
    struct vvec p = vv_cross(d, e2);
    vfloat det = vv_dot(e1, p);
    edges.flip = (vint)det & vi_set(0x80000000u); // a product with the sign of det
    edges.area = vf_abs(det);
    edges.us = (vfloat)((vint)vv_dot(s, p) ^ edges.flip);
    edges.vs = (vfloat)((vint)vv_dot(d, q) ^ edges.flip);
    return edges;
}

RB_INLINE vint triangle_inside(const struct triangle_edges *of, vfloat slack)
{
    return (of->us >= -slack) & (of->vs >= -slack) & (of->us + of->vs <= of->area + slack) &
           (of->area >= FLT_MIN);
}

// The rest of the test, for lanes of `inside`; `along` is e2 . q.
RB_INLINE vint triangle_root(const struct triangle_edges *edges, vfloat along, const float low[3],
                             const float high[3], const struct packet *packet, vint inside,
                             struct hits *hit)
{
    struct interval range = box(low, high, packet);
    vfloat inverse = 1.0f / edges->area, zero = vf_set(0.0f), one = vf_set(1.0f);
    vfloat t = (vfloat)((vint)along ^ edges->flip) * inverse;
    hit->u = vf_min(vf_max(edges->us * inverse, zero), one);
    hit->v = vf_min(vf_max(edges->vs * inverse, zero), one - hit->u);
    hit->t = vf_min(vf_max(t, range.near), range.far);
    return inside & (range.near <= range.far);
}

// rb_triangle_test, own box from `low` to `high` included.
RB_INLINE vint triangle_hit(const struct rb_triangle *triangle, const float low[3],
                            const float high[3], const struct packet *packet, vint active, vint own,
                            struct hits *hit)
{
    struct rb_vec corner = rb_vec_of(triangle->v[0]);
    struct rb_vec edge1 = rb_vec_sub(rb_vec_of(triangle->v[1]), corner);
    struct rb_vec edge2 = rb_vec_sub(rb_vec_of(triangle->v[2]), corner);
    struct vvec e1 = {vf_set(edge1.x), vf_set(edge1.y), vf_set(edge1.z)};
    struct vvec e2 = {vf_set(edge2.x), vf_set(edge2.y), vf_set(edge2.z)};
    struct vvec s = vv_sub(packet->o, vv_set(triangle->v[0]));
    struct vvec q = vv_cross(s, e1);
    struct triangle_edges edges = triangle_pass(s, e1, e2, q, packet->d);
    vfloat slack =
        RB_EDGE_TOLERANCE * vv_reach(s) * rb_max(rb_vec_reach(edge1), rb_vec_reach(edge2));
    vint inside = active & triangle_inside(&edges, slack) & ~own;
    count_primitive(RB_COUNT_TRIANGLES, active, inside, sizeof *triangle);
    if (!vi_any(inside))
        return inside;
    return triangle_root(&edges, vv_dot(e2, q), low, high, packet, inside, hit);
}

// Cones are rare: one ray after the other.
static vint cone_hit(const struct rb_scene *scene, uint32_t index, const struct packet *packet,
                     vint active, struct hits *hit)
{
    vint found = vi_set(0);
    for (int lane = 0; lane < RB_LANES; lane++) {
        struct rb_ray ray = packet_ray(packet, lane);
        struct rb_hit one;
        RB_COUNT_LANE(lane);
        if (active[lane] && rb_cone_hit(scene, index, &ray, &one)) {
            found[lane] = -1;
            hit->t[lane] = one.t;
        }
        RB_COUNT_LANE(-lane);
    }
    hit->u = hit->v = vf_set(0.0f);
    return found;
}

// Lanes of `active` that hit bounded primitive `id`, at a positive distance.
static inline vint primitive_hit(const struct rb_scene *scene, uint32_t id,
                                 const struct packet *packet, vint active, struct hits *hit)
{
    const struct rb_sphere *sphere = &scene->spheres[id];
    const struct rb_triangle *triangle = &scene->triangles[id - scene->first[RB_TRIANGLE]];
    vint own = packet->self == vi_set(id), found;
    float low[3], high[3];
    hit->prim = vi_set(id);
    hit->t = vf_set(0.0f);
    switch (rb_scene_kind(scene, id)) {
    case RB_SPHERE:
        rb_sphere_bounds(sphere, low, high);
        found = sphere_hit(sphere, low, high, packet, active, own, hit);
        break;
    case RB_TRIANGLE:
        rb_triangle_bounds(triangle, low, high);
        found = triangle_hit(triangle, low, high, packet, active, own, hit);
        break;
    default:
        found = cone_hit(scene, id - scene->first[RB_CONE], packet, active, hit);
        break;
    }
    return found & active & (hit->t > 0.0f);
}

// rb_plane_hit
RB_INLINE vint plane_hit(const struct rb_scene *scene, uint32_t index, const struct packet *packet,
                         vint active, struct hits *hit)
{
    const struct rb_plane *plane = &scene->planes[index];
    struct vvec n = vv_set(plane->normal);
    RB_COUNT_STEP(vi_bits(active), RB_LANES);
    RB_COUNT_RAYS(PLANES,
                  vi_bits(active & (packet->self != vi_set(scene->first[RB_PLANE] + index))), 1);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, sizeof *plane);
    hit->prim = vi_set(scene->first[RB_PLANE] + index);
    hit->t = (plane->distance - vv_dot(n, packet->o)) / vv_dot(n, packet->d);
    hit->u = hit->v = vf_set(0.0f);
    return (hit->t > 0.0f) & (hit->t < INFINITY) & (packet->self != hit->prim);
}

// Takes over the lanes of `found` that are closer, or as close with a lower id.
RB_INLINE void keep_closest(struct hits *best, const struct hits *hit, vint found)
{
    vint lower = (vint)((vuint)hit->prim < (vuint)best->prim);
    vint closer = found & ((hit->t < best->t) | ((hit->t == best->t) & lower));
    best->t = vf_select(closer, hit->t, best->t);
    best->u = vf_select(closer, hit->u, best->u);
    best->v = vf_select(closer, hit->v, best->v);
    best->prim = vi_select(closer, hit->prim, best->prim);
}

#endif
