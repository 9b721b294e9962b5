// Bundles: up to 256 neighbouring rays go through the wide tree together. One vector operation
// holds the 8 boxes of a node against all of them at once, by interval arithmetic over their
// origins and inverse directions (Boulos, Wald, Shirley 2006, "Geometric and arithmetic culling
// methods for entire ray packets"); of the packets in the bundle only the first and the last that
// meet a box are searched for, those in between come along untested (first and last active ray:
// Wald, Boulos, Shirley 2007, "Ray tracing deformable scenes using dynamic bounding volume
// hierarchies"). What is culled is culled safely: float subtraction and multiplication are
// monotone, so an interval's bound holds for every ray in it, rounding included, and the tests of
// primitives decide as in intersect.h.
//
// Rays must go the same way on every axis and be near each other; other chunks go to single rays
// (wide.c). Compiled once per instruction set (Makefile).
#include "accel/wide.h"
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
#include "kernels/packet_trace.h"

#ifndef RB_FRUSTUM_SET
#ifdef __aarch64__
#define RB_FRUSTUM_SET  rb_kernels_frustum_neon
#define RB_FRUSTUM_ELSE rb_kernels_wide_neon
#else
#define RB_FRUSTUM_SET  rb_kernels_frustum_sse2
#define RB_FRUSTUM_ELSE rb_kernels_wide_sse2
#endif
#endif

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(RB_FRUSTUM_SET) = {
    .generate = generate,
    .trace = trace,
    .surface = surface,
    .light = light,
    .trace_shadow = trace_shadow,
};

enum { BUNDLE = 256, PACKETS = BUNDLE / RB_LANES };

typedef float v8float __attribute__((vector_size(4 * RB_WIDE)));
typedef int32_t v8int __attribute__((vector_size(4 * RB_WIDE)));

struct bundle {
    struct packet packet[PACKETS];
    vint active[PACKETS];   // lanes whose answer is wanted, and not known yet
    vfloat limit[PACKETS];  // farthest distance that matters
    int count;              // of packets
    float o_low[3], o_high[3], inv_low[3], inv_high[3];
    int backward[3];
    bool mixed[3]; // both ways: nothing is culled on this axis
};

static inline v8float v8_load(const float *from)
{
    v8float v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline v8float v8_min(v8float a, v8float b)
{
    v8int less = a < b;
    return (v8float)((less & (v8int)a) | (~less & (v8int)b));
}

static inline v8float v8_max(v8float a, v8float b)
{
    v8int more = a > b;
    return (v8float)((more & (v8int)a) | (~more & (v8int)b));
}

static inline unsigned v8_bits(v8int mask)
{
#ifdef __AVX__
    return (unsigned)_mm256_movemask_ps((__m256)mask);
#else
    unsigned bits = 0;
    for (int i = 0; i < RB_WIDE; i++)
        bits |= (mask[i] ? 1u : 0u) << i;
    return bits;
#endif
}

// Lower bound of where any ray of the bundle enters each of 8 boxes, upper bound of where it
// leaves.
static inline void bundle_boxes(const struct bundle *bundle, const v8float near[3],
                                const v8float far[3], v8float *from, v8float *to)
{
    v8float zero = {0}, enter = zero, leave = zero + INFINITY;
    for (int k = 0; k < 3; k++) {
        if (bundle->mixed[k])
            continue;
        float first = bundle->backward[k] ? bundle->o_low[k] : bundle->o_high[k];
        float last = bundle->backward[k] ? bundle->o_high[k] : bundle->o_low[k];
        v8float n = near[k] - first, f = far[k] - last;
        enter = v8_max(enter, v8_min(n * bundle->inv_low[k], n * bundle->inv_high[k]));
        leave = v8_min(leave, v8_max(f * bundle->inv_low[k], f * bundle->inv_high[k]));
    }
    *from = enter;
    *to = leave * RB_FAR_SCALE;
}

static inline unsigned bundle_node(const struct bundle *bundle, const struct rb_wide_node *node,
                                   float limit, float reach[RB_WIDE])
{
    const int *b = bundle->backward;
    const v8float near[3] = {v8_load(node->bounds[0][b[0]]), v8_load(node->bounds[1][b[1]]),
                             v8_load(node->bounds[2][b[2]])};
    const v8float far[3] = {v8_load(node->bounds[0][!b[0]]), v8_load(node->bounds[1][!b[1]]),
                            v8_load(node->bounds[2][!b[2]])};
    v8float from, to;
    bundle_boxes(bundle, near, far, &from, &to);
    memcpy(reach, &from, sizeof from);
    return v8_bits((from <= to) & (from <= limit)) & ((1u << node->count) - 1);
}

// Does any ray of the packet need the box?
static inline bool meets(const struct bundle *bundle, int p, const float low[3],
                         const float high[3])
{
    struct interval range = box(low, high, &bundle->packet[p]);
    return vi_any(bundle->active[p] & (range.near <= range.far) &
                  (range.near <= bundle->limit[p]));
}

// Of the packets in `set` those from the first to the last one that meet the child.
static inline uint64_t narrow(const struct bundle *bundle, uint64_t set,
                              const struct rb_wide_node *node, int c)
{
    float low[3], high[3];
    for (int k = 0; k < 3; k++)
        low[k] = node->bounds[k][0][c], high[k] = node->bounds[k][1][c];
    while (set && !meets(bundle, __builtin_ctzll(set), low, high))
        set &= set - 1;
    while (set & (set - 1)) {
        int last = 63 - __builtin_clzll(set);
        if (meets(bundle, last, low, high))
            break;
        set &= ~((uint64_t)1 << last);
    }
    return set;
}

struct visit {
    uint64_t set; // packets that need it
    float near;   // lower bound
    rb_wide_child child;
};

// Puts the children that are needed on the stack, the nearest on top.
static inline int push(const struct bundle *bundle, const struct rb_wide_node *node, uint64_t set,
                       float limit, struct visit *stack, int depth)
{
    float reach[RB_WIDE];
    int bottom = depth;
    for (unsigned bits = bundle_node(bundle, node, limit, reach); bits; bits &= bits - 1) {
        int c = __builtin_ctz(bits), at;
        struct visit visit = {narrow(bundle, set, node, c), reach[c], node->child[c]};
        if (!visit.set)
            continue;
        for (at = depth++; at > bottom && stack[at - 1].near < visit.near; at--)
            stack[at] = stack[at - 1];
        stack[at] = visit;
    }
    return depth;
}

// Own boxes of a block's primitives that the bundle may meet.
static inline unsigned bundle_spheres(const struct bundle *bundle,
                                      const struct rb_wide_spheres *block, float limit)
{
    v8float near[3], far[3], from, to, radius = v8_load(block->radius);
    v8float r = v8_max(radius, -radius);
    for (int k = 0; k < 3; k++) {
        v8float c = v8_load(block->center[k]);
        near[k] = bundle->backward[k] ? c + r : c - r;
        far[k] = bundle->backward[k] ? c - r : c + r;
    }
    bundle_boxes(bundle, near, far, &from, &to);
    return v8_bits((from <= to) & (from <= limit) & (radius == radius));
}

static inline unsigned bundle_triangles(const struct bundle *bundle,
                                        const struct rb_wide_triangles *block, float limit)
{
    v8float near[3], far[3], from, to, x = v8_load(block->v[0][0]);
    for (int k = 0; k < 3; k++) {
        v8float a = v8_load(block->v[0][k]), b = v8_load(block->v[1][k]);
        v8float c = v8_load(block->v[2][k]);
        v8float low = v8_min(v8_min(a, b), c), high = v8_max(v8_max(a, b), c);
        near[k] = bundle->backward[k] ? high : low;
        far[k] = bundle->backward[k] ? low : high;
    }
    bundle_boxes(bundle, near, far, &from, &to);
    return v8_bits((from <= to) & (from <= limit) & (x == x));
}

static unsigned bundle_leaf(const struct bundle *bundle, const struct rb_wide *wide,
                            rb_wide_child leaf, float limit)
{
    uint32_t index = rb_wide_index_of(leaf);
    switch (rb_wide_kind_of(leaf)) {
    case RB_WIDE_SPHERES:
        return bundle_spheres(bundle, &wide->spheres[index], limit);
    case RB_WIDE_TRIANGLES:
        return bundle_triangles(bundle, &wide->triangles[index], limit);
    default: {
        unsigned bits = 0;
        for (int lane = 0; lane < RB_WIDE; lane++)
            bits |= (wide->others[index].id[lane] != RB_NONE ? 1u : 0u) << lane;
        return bits;
    }
    }
}

static float widest(const vfloat *limit, const vint *active, int count)
{
    vfloat most = vf_set(-INFINITY);
    float lanes[RB_LANES], all = -INFINITY;
    for (int p = 0; p < count; p++)
        most = vf_max(most, vf_select(active[p], limit[p], most));
    vf_store(lanes, most);
    for (int lane = 0; lane < RB_LANES; lane++)
        all = lanes[lane] > all ? lanes[lane] : all;
    return all;
}

static uint64_t all_packets(const struct bundle *bundle)
{
    return bundle->count == 64 ? ~(uint64_t)0 : ((uint64_t)1 << bundle->count) - 1;
}

static void closest(const struct rb_world *world, struct bundle *bundle, struct hits *best)
{
    const struct rb_wide *wide = world->wide;
    struct visit stack[RB_WIDE_STACK];
    int depth = 0;
    if (wide->count[RB_WIDE_NODE])
        stack[depth++] = (struct visit){all_packets(bundle), 0.0f, 0};
    float limit = widest(bundle->limit, bundle->active, bundle->count);
    while (depth > 0) {
        struct visit visit = stack[--depth];
        if (visit.near > limit)
            continue;
        if (rb_wide_kind_of(visit.child) == RB_WIDE_NODE) {
            depth = push(bundle, &wide->nodes[visit.child], visit.set, limit, stack, depth);
            continue;
        }
        const uint32_t *ids = rb_wide_ids(wide, visit.child);
        bool any = false;
        for (unsigned bits = bundle_leaf(bundle, wide, visit.child, limit); bits; bits &= bits - 1)
            for (uint64_t set = visit.set; set; set &= set - 1) {
                int p = __builtin_ctzll(set);
                struct hits hit;
                vint found = primitive_hit(world->scene, ids[__builtin_ctz(bits)],
                                           &bundle->packet[p], bundle->active[p], &hit);
                if (vi_any(found)) {
                    keep_closest(&best[p], &hit, found);
                    bundle->limit[p] = best[p].t;
                    any = true;
                }
            }
        if (any)
            limit = widest(bundle->limit, bundle->active, bundle->count);
    }
}

// Packets with lanes whose answer is not known.
static uint64_t open_packets(const struct bundle *bundle)
{
    uint64_t open = 0;
    for (int p = 0; p < bundle->count; p++)
        open |= (uint64_t)vi_any(bundle->active[p]) << p;
    return open;
}

// Lanes that are found to be occluded cease to be active.
static void any(const struct rb_world *world, struct bundle *bundle)
{
    const struct rb_wide *wide = world->wide;
    struct visit stack[RB_WIDE_STACK];
    int depth = 0;
    uint64_t open = open_packets(bundle);
    if (wide->count[RB_WIDE_NODE])
        stack[depth++] = (struct visit){open, 0.0f, 0};
    float limit = widest(bundle->limit, bundle->active, bundle->count);
    while (depth > 0) {
        struct visit visit = stack[--depth];
        visit.set &= open;
        if (!visit.set)
            continue;
        if (rb_wide_kind_of(visit.child) == RB_WIDE_NODE) {
            depth = push(bundle, &wide->nodes[visit.child], visit.set, limit, stack, depth);
            continue;
        }
        const uint32_t *ids = rb_wide_ids(wide, visit.child);
        for (unsigned bits = bundle_leaf(bundle, wide, visit.child, limit); bits; bits &= bits - 1)
            for (uint64_t set = visit.set & open; set; set &= set - 1) {
                int p = __builtin_ctzll(set);
                struct hits hit;
                vint found = primitive_hit(world->scene, ids[__builtin_ctz(bits)],
                                           &bundle->packet[p], bundle->active[p], &hit);
                bundle->active[p] &= ~(found & (hit.t < bundle->limit[p]));
                if (!vi_any(bundle->active[p]))
                    open &= ~((uint64_t)1 << p);
            }
    }
}

static void extend(float *low, float *high, vfloat lanes, vint active)
{
    float value[RB_LANES];
    vf_store(value, lanes);
    for (unsigned bits = vi_bits(active); bits; bits &= bits - 1) {
        float x = value[__builtin_ctz(bits)];
        *low = x < *low ? x : *low;
        *high = x > *high ? x : *high;
    }
}

// Intervals of the bundle's active rays. False if they go different ways.
static bool bound(struct bundle *bundle)
{
    for (int k = 0; k < 3; k++) {
        vfloat o_low = vf_set(INFINITY), o_high = vf_set(-INFINITY), i_low = o_low, i_high = o_high;
        bundle->o_low[k] = bundle->inv_low[k] = INFINITY;
        bundle->o_high[k] = bundle->inv_high[k] = -INFINITY;
        for (int p = 0; p < bundle->count; p++) {
            const struct packet *packet = &bundle->packet[p];
            vint on = bundle->active[p];
            vfloat o = k == 0 ? packet->o.x : k == 1 ? packet->o.y : packet->o.z;
            vfloat inv = k == 0 ? packet->inv.x : k == 1 ? packet->inv.y : packet->inv.z;
            o_low = vf_min(o_low, vf_select(on, o, o_low));
            o_high = vf_max(o_high, vf_select(on, o, o_high));
            i_low = vf_min(i_low, vf_select(on, inv, i_low));
            i_high = vf_max(i_high, vf_select(on, inv, i_high));
        }
        vint all = vi_set(0xffffffffu);
        extend(&bundle->o_low[k], &bundle->o_high[k], o_low, all);
        extend(&bundle->o_low[k], &bundle->o_high[k], o_high, all);
        extend(&bundle->inv_low[k], &bundle->inv_high[k], i_low, all);
        extend(&bundle->inv_low[k], &bundle->inv_high[k], i_high, all);
        bundle->mixed[k] = (bundle->inv_low[k] < 0.0f) != (bundle->inv_high[k] < 0.0f);
        bundle->backward[k] = bundle->inv_low[k] < 0.0f;
    }
    return bundle->mixed[0] + bundle->mixed[1] + bundle->mixed[2] <= 1;
}

static void load_rays(struct bundle *bundle, const struct rb_rays *rays, uint32_t first,
                      uint32_t end)
{
    bundle->count = 0;
    for (uint32_t i = first; i < end; i += RB_LANES) {
        int p = bundle->count++;
        struct vvec o = {vf_load(rays->ox + i), vf_load(rays->oy + i), vf_load(rays->oz + i)};
        struct vvec d = {vf_load(rays->dx + i), vf_load(rays->dy + i), vf_load(rays->dz + i)};
        bundle->packet[p] = packet_make(o, d, vi_load(rays->self + i), false);
        bundle->active[p] = vi_first(end - i) & vv_finite(o) & vv_finite(d);
    }
}

static void planes_closest(const struct rb_world *world, struct bundle *bundle, struct hits *best)
{
    const struct rb_scene *scene = world->scene;
    struct hits hit;
    for (int p = 0; p < bundle->count; p++) {
        best[p] = (struct hits){vf_set(INFINITY), vf_set(0.0f), vf_set(0.0f), vi_set(RB_NONE)};
        for (uint32_t i = 0; i < scene->count[RB_PLANE]; i++) {
            vint found = bundle->active[p] &
                         plane_hit(scene, i, &bundle->packet[p], bundle->active[p], &hit);
            keep_closest(&best[p], &hit, found);
        }
        bundle->limit[p] = best[p].t;
    }
}

static struct rb_hits hits_view(const struct rb_hits *h, uint32_t first)
{
    return (struct rb_hits){h->t + first, h->u + first, h->v + first, h->prim + first};
}

static struct rb_rays rays_view(const struct rb_rays *r, uint32_t first, uint32_t count)
{
    return (struct rb_rays){
        r->ox + first,   r->oy + first,   r->oz + first,     r->dx + first,
        r->dy + first,   r->dz + first,   r->weight + first, r->pixel + first,
        r->path + first, r->self + first, r->media + first,  count,
        count,
    };
}

static void trace_chunk(const struct rb_world *world, const struct rb_rays *rays, uint32_t first,
                        uint32_t end, uint32_t size, struct rb_hits *hits)
{
    struct bundle bundle;
    struct hits best[PACKETS];
    load_rays(&bundle, rays, first, end);
    if (!bound(&bundle)) {
        if (size / 4 < 64) {
            struct rb_rays some = rays_view(rays, first, end - first);
            struct rb_hits answers = hits_view(hits, first);
            RB_TWIN(RB_FRUSTUM_ELSE).trace(world, &some, &answers);
            return;
        }
        for (uint32_t at = first; at < end; at += size / 4)
            trace_chunk(world, rays, at, at + size / 4 < end ? at + size / 4 : end, size / 4, hits);
        return;
    }
    planes_closest(world, &bundle, best);
    closest(world, &bundle, best);
    for (int p = 0; p < bundle.count; p++) {
        uint32_t i = first + (uint32_t)p * RB_LANES;
        vf_store(hits->t + i, best[p].t);
        vf_store(hits->u + i, best[p].u);
        vf_store(hits->v + i, best[p].v);
        vi_store(hits->prim + i, best[p].prim);
    }
}

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    if (world->one_sided) {
        RB_TWIN(RB_FRUSTUM_ELSE).trace(world, rays, hits);
        return;
    }
    for (uint32_t i = 0; i < rays->count; i += BUNDLE)
        trace_chunk(world, rays, i, i + BUNDLE < rays->count ? i + BUNDLE : rays->count, BUNDLE,
                    hits);
}

static struct rb_shadows shadows_view(const struct rb_shadows *s, uint32_t first, uint32_t count)
{
    return (struct rb_shadows){
        s->ox + first,    s->oy + first,   s->oz + first,       s->dx + first, s->dy + first,
        s->dz + first,    s->distance + first, s->r + first, s->g + first, s->b + first,
        s->pixel + first, s->self + first, s->occluded + first, count,         count,
    };
}

static void load_shadows(struct bundle *bundle, const struct rb_shadows *shadows, uint32_t first,
                         uint32_t end)
{
    bundle->count = 0;
    for (uint32_t i = first; i < end; i += RB_LANES) {
        int p = bundle->count++;
        struct vvec o = {vf_load(shadows->ox + i), vf_load(shadows->oy + i),
                         vf_load(shadows->oz + i)};
        struct vvec d = {vf_load(shadows->dx + i), vf_load(shadows->dy + i),
                         vf_load(shadows->dz + i)};
        bundle->packet[p] = packet_make(o, d, vi_load(shadows->self + i), true);
        bundle->active[p] = vi_first(end - i) & vv_finite(o) & vv_finite(d);
        bundle->limit[p] = vf_load(shadows->distance + i);
    }
}

static void shadow_chunk(const struct rb_world *world, struct rb_shadows *shadows, uint32_t first,
                         uint32_t end, uint32_t size)
{
    struct bundle bundle;
    vint wanted[PACKETS];
    load_shadows(&bundle, shadows, first, end);
    if (!bound(&bundle)) {
        if (size / 4 < 64) {
            struct rb_shadows some = shadows_view(shadows, first, end - first);
            RB_TWIN(RB_FRUSTUM_ELSE).trace_shadow(world, &some);
            return;
        }
        for (uint32_t at = first; at < end; at += size / 4)
            shadow_chunk(world, shadows, at, at + size / 4 < end ? at + size / 4 : end, size / 4);
        return;
    }
    for (int p = 0; p < bundle.count; p++) {
        struct hits hit;
        wanted[p] = bundle.active[p];
        for (uint32_t i = 0; i < world->scene->count[RB_PLANE]; i++) {
            vint found = plane_hit(world->scene, i, &bundle.packet[p], bundle.active[p], &hit);
            bundle.active[p] &= ~(found & (hit.t < bundle.limit[p]));
        }
    }
    any(world, &bundle);
    for (int p = 0; p < bundle.count; p++) {
        uint32_t i = first + (uint32_t)p * RB_LANES;
        unsigned occluded = vi_bits(wanted[p] & ~bundle.active[p]);
        for (uint32_t lane = 0; lane < RB_LANES && i + lane < end; lane++)
            shadows->occluded[i + lane] = occluded >> lane & 1;
    }
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    for (uint32_t i = 0; i < shadows->count; i += BUNDLE)
        shadow_chunk(world, shadows, i, i + BUNDLE < shadows->count ? i + BUNDLE : shadows->count,
                     BUNDLE);
}
