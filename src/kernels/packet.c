// Packets: as many rays as the vector has lanes go through the binary BVH together, each box and
// each primitive tested against all of them at once (Wald, Slusallek, Benthin, Wagner 2001,
// "Interactive rendering with coherent ray tracing"). A child is visited if any ray needs it. What
// is gained on coherent rays is lost again where the rays of a packet part; single rays win there
// (bvh.c).
//
// Compiled once per instruction set (Makefile); the object's name of the kernel set comes with it.
#include "accel/bvh.h"
#include "kernels/intersect.h"
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
#include "kernels/simd.h"

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

// rb_ray, lane by lane. All rays of a packet are of one kind.
struct packet {
    struct vvec o, d, inv;
    vint backward[3]; // lanes whose direction is negative on that axis
    vint self;
    bool shadow;
};

// rb_hit, lane by lane.
struct hits {
    vfloat t, u, v;
    vint prim;
};

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
    return (struct packet){o, d, inv, {inv.x < 0.0f, inv.y < 0.0f, inv.z < 0.0f}, self, shadow};
}

// One ray of the packet, for what is too rare to have a vector form.
static struct rb_ray packet_ray(const struct packet *packet, int lane)
{
    struct rb_vec o = {packet->o.x[lane], packet->o.y[lane], packet->o.z[lane]};
    struct rb_vec d = {packet->d.x[lane], packet->d.y[lane], packet->d.z[lane]};
    return rb_ray_make(o, d, (uint32_t)packet->self[lane],
                       packet->shadow ? RB_SIDES_BOTH : RB_SIDES_VISIBLE);
}

// rb_slab
static inline void slab(float low, float high, vfloat o, vfloat inv, vint backward,
                        struct interval *range)
{
    vfloat t_low = (low - o) * inv, t_high = (high - o) * inv;
    vfloat near = vf_select(backward, t_high, t_low), far = vf_select(backward, t_low, t_high);
    range->near = vf_max(range->near, near);
    range->far = vf_min(range->far, far * RB_FAR_SCALE);
}

// rb_box
static inline struct interval box(const float low[3], const float high[3],
                                  const struct packet *packet)
{
    struct interval range = {vf_set(0.0f), vf_set(INFINITY)};
    slab(low[0], high[0], packet->o.x, packet->inv.x, packet->backward[0], &range);
    slab(low[1], high[1], packet->o.y, packet->inv.y, packet->backward[1], &range);
    slab(low[2], high[2], packet->o.z, packet->inv.z, packet->backward[2], &range);
    return range;
}

// rb_count_primitive
static inline void count_primitive(vint active, size_t bytes)
{
    (void)active, (void)bytes;
    RB_COUNT_STEP(vi_bits(active), RB_LANES);
    RB_COUNT_RAYS(BOXES, vi_bits(active), 1);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, bytes);
}

// rb_sphere_test, own box included, for rays that see both sides or what a negative radius leaves.
static inline vint sphere_hit(const struct rb_sphere *sphere, const struct packet *packet,
                              vint active, vint own, struct hits *hit)
{
    float low[3], high[3];
    rb_sphere_bounds(sphere, low, high);
    struct interval range = box(low, high, packet);
    vint passes = active & (range.near <= range.far);
    count_primitive(active, sizeof *sphere);
    if (!vi_any(passes))
        return passes;
    RB_COUNT_RAYS(SPHERES, vi_bits(passes), 1);
    struct vvec l = vv_sub(vv_set(sphere->center), packet->o);
    vfloat b = vv_dot(l, packet->d);
    struct vvec apart = vv_mad(l, -b, packet->d);
    vfloat discriminant = sphere->radius * sphere->radius - vv_dot(apart, apart);
    vfloat root = vf_sqrt(discriminant);
    vfloat near = b - root, far = vf_select(own, b + b, b + root);
    vint take_near = (near > 0.0f) & ~own;
    if (sphere->radius < 0.0f && !packet->shadow)
        take_near = vi_set(0);
    vfloat t = vf_select(take_near, near, far);
    vint found = passes & (discriminant >= 0.0f) & (t > 0.0f);
    hit->t = vf_min(vf_max(t, range.near), range.far);
    hit->u = hit->v = vf_set(0.0f);
    return packet->shadow ? found & ~own : found;
}

// rb_triangle_test, own box included.
static inline vint triangle_hit(const struct rb_triangle *triangle, const struct packet *packet,
                                vint active, vint own, struct hits *hit)
{
    float low[3], high[3];
    rb_triangle_bounds(triangle, low, high);
    struct interval range = box(low, high, packet);
    vint passes = active & (range.near <= range.far) & ~own;
    count_primitive(active, sizeof *triangle);
    if (!vi_any(passes))
        return passes;
    RB_COUNT_RAYS(TRIANGLES, vi_bits(passes), 1);
    struct rb_vec corner = rb_vec_of(triangle->v[0]);
    struct rb_vec edge1 = rb_vec_sub(rb_vec_of(triangle->v[1]), corner);
    struct rb_vec edge2 = rb_vec_sub(rb_vec_of(triangle->v[2]), corner);
    struct vvec e1 = {vf_set(edge1.x), vf_set(edge1.y), vf_set(edge1.z)};
    struct vvec e2 = {vf_set(edge2.x), vf_set(edge2.y), vf_set(edge2.z)};
    struct vvec s = vv_sub(packet->o, vv_set(triangle->v[0]));
    struct vvec p = vv_cross(packet->d, e2), q = vv_cross(s, e1);
    vfloat det = vv_dot(e1, p);
    vint flip = (vint)det & vi_set(0x80000000u); // a product with the sign of det
    vfloat area = vf_abs(det);
    vfloat us = (vfloat)((vint)vv_dot(s, p) ^ flip);
    vfloat vs = (vfloat)((vint)vv_dot(packet->d, q) ^ flip);
    vfloat slack =
        RB_EDGE_TOLERANCE * vv_reach(s) * rb_max(rb_vec_reach(edge1), rb_vec_reach(edge2));
    vint inside =
        passes & (us >= -slack) & (vs >= -slack) & (us + vs <= area + slack) & (area >= FLT_MIN);
    if (!vi_any(inside))
        return inside;
    vfloat inverse = 1.0f / area, zero = vf_set(0.0f), one = vf_set(1.0f);
    vfloat t = (vfloat)((vint)vv_dot(e2, q) ^ flip) * inverse;
    hit->u = vf_min(vf_max(us * inverse, zero), one);
    hit->v = vf_min(vf_max(vs * inverse, zero), one - hit->u);
    hit->t = vf_min(vf_max(t, range.near), range.far);
    return inside;
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
    vint own = packet->self == vi_set(id), found;
    hit->prim = vi_set(id);
    hit->t = vf_set(0.0f);
    switch (rb_scene_kind(scene, id)) {
    case RB_SPHERE:
        found = sphere_hit(&scene->spheres[id], packet, active, own, hit);
        break;
    case RB_TRIANGLE:
        found = triangle_hit(&scene->triangles[id - scene->first[RB_TRIANGLE]], packet, active, own,
                             hit);
        break;
    default:
        found = cone_hit(scene, id - scene->first[RB_CONE], packet, active, hit);
        break;
    }
    return found & active & (hit->t > 0.0f);
}

// rb_plane_hit
static vint plane_hit(const struct rb_scene *scene, uint32_t index, const struct packet *packet,
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
static inline void keep_closest(struct hits *best, const struct hits *hit, vint found)
{
    vint lower = (vint)((vuint)hit->prim < (vuint)best->prim);
    vint closer = found & ((hit->t < best->t) | ((hit->t == best->t) & lower));
    best->t = vf_select(closer, hit->t, best->t);
    best->u = vf_select(closer, hit->u, best->u);
    best->v = vf_select(closer, hit->v, best->v);
    best->prim = vi_select(closer, hit->prim, best->prim);
}

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
        vf_store(hits->t + i, best.t);
        vf_store(hits->u + i, best.u);
        vf_store(hits->v + i, best.v);
        vi_store(hits->prim + i, best.prim);
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
