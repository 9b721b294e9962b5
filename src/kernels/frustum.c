// Bundles: up to 256 neighbouring rays go through the wide tree together. One vector operation
// holds the 8 boxes of a node against all of them at once, by interval arithmetic over their
// origins and inverse directions (Boulos, Wald, Shirley 2006, "Geometric and arithmetic culling
// methods for entire ray packets"). Of the packets in a bundle only the first and the last that
// need a box are searched for, those in between come along untested (after Wald, Boulos, Shirley
// 2007, "Ray tracing deformable scenes using dynamic bounding volume hierarchies").
//
// A bundle may go both ways on one axis at most. Other rays wait for each other and go on as a
// stream (stream.c). Compiled once per instruction set (Makefile).
#include "kernels/frustum_bundle.h"
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
#include "kernels/part.h"

#ifndef RB_FRUSTUM
#ifdef __aarch64__
#define RB_FRUSTUM      rb_kernels_frustum_neon
#define RB_FRUSTUM_ELSE rb_kernels_stream_neon
#else
#define RB_FRUSTUM      rb_kernels_frustum_sse2
#define RB_FRUSTUM_ELSE rb_kernels_stream_sse2
#endif
#endif

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(RB_FRUSTUM) = {
    .generate = generate,
    .trace = trace,
    .surface = surface,
    .light = light,
    .trace_shadow = trace_shadow,
};

// Axes on which rays may go both ways; rays of the smallest bundle that is tried. A bundle falls
// apart where, after TRIALS tests of a packet against a box, fewer than one lane in USEFUL needed
// what was tested: a stream does not test what no ray needs. First guesses, not tuned: with them
// shadow rays of balls_high from bounce 2 on took 100 to 108 ns, without 210 to 440, streams alone
// 83 to 189 (least times of `raybench bench`, Zen 4, a busy machine).
enum { MIXED_MAX = 1, BUNDLE_MIN = 64, TRIALS = 64, USEFUL = 8 };

static inline bool falls_apart(const struct bundle *bundle)
{
    return bundle->tests >= TRIALS && bundle->useful * USEFUL < bundle->tests * RB_LANES;
}

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
        RB_COUNT_LANE(p * RB_LANES);
        RB_COUNT_RAYS(NODES, vi_bits(bundle->active[p]), 1);
        RB_COUNT_LANE(-p * RB_LANES);
    }
}

// Puts the children that are needed on the stack, the nearest on top.
static inline int push(struct bundle *bundle, const struct rb_wide_node *node, uint64_t set,
                       float limit, struct visit *stack, int depth)
{
    float enter[RB_WIDE];
    int bottom = depth;
    RB_COUNT(count_node(bundle, set));
    for (unsigned bits = bundle_node(bundle, node, limit, enter); bits; bits &= bits - 1) {
        int c = __builtin_ctz(bits), at;
        struct visit visit = {bundle_narrow(bundle, set, node, c), enter[c], node->child[c]};
        if (!visit.set)
            continue;
        for (at = depth++; at > bottom && stack[at - 1].enter < visit.enter; at--)
            stack[at] = stack[at - 1];
        stack[at] = visit;
    }
    RB_COUNT_DEPTH(depth);
    return depth;
}

static inline vint hit_lanes(const struct rb_world *world, const struct bundle *bundle, int p,
                             uint32_t id, struct hits *hit)
{
    RB_COUNT_LANE(p * RB_LANES);
    vint found = primitive_hit(world->scene, id, &bundle->packet[p], bundle->active[p], hit);
    RB_COUNT_LANE(-p * RB_LANES);
    return found;
}

// Tests the primitives of a leaf. Is any ray's closest hit closer now?
static bool leaf_closest(const struct rb_world *world, struct bundle *bundle, struct visit visit,
                         float limit, struct hits *best)
{
    const uint32_t *ids = rb_wide_ids(world->wide, visit.child);
    bool closer = false;
    for (unsigned bits = bundle_leaf(bundle, world->wide, visit.child, limit); bits;
         bits &= bits - 1)
        for (uint64_t set = visit.set; set; set &= set - 1) {
            int p = __builtin_ctzll(set);
            struct hits hit;
            vint found = hit_lanes(world, bundle, p, ids[__builtin_ctz(bits)], &hit);
            if (!vi_any(found))
                continue;
            keep_closest(&best[p], &hit, found);
            bundle->limit[p] = best[p].t;
            closer = true;
        }
    return closer;
}

static bool closest(const struct rb_world *world, struct bundle *bundle, struct hits *best)
{
    const struct rb_wide *wide = world->wide;
    struct visit stack[RB_WIDE_STACK];
    int depth = 0;
    float limit = bundle_limit(bundle);
    if (wide->count[RB_WIDE_NODE])
        stack[depth++] = (struct visit){bundle_open(bundle), 0.0f, 0};
    while (depth > 0) {
        struct visit visit = stack[--depth];
        if (visit.enter > limit)
            continue;
        if (falls_apart(bundle))
            return false;
        if (rb_wide_kind_of(visit.child) == RB_WIDE_NODE)
            depth = push(bundle, &wide->nodes[visit.child], visit.set, limit, stack, depth);
        else if (leaf_closest(world, bundle, visit, limit, best))
            limit = bundle_limit(bundle);
    }
    return true;
}

// Lanes that are found to be occluded cease to be active; returns the packets with others.
static uint64_t leaf_any(const struct rb_world *world, struct bundle *bundle, struct visit visit,
                         float limit, uint64_t open)
{
    const uint32_t *ids = rb_wide_ids(world->wide, visit.child);
    for (unsigned bits = bundle_leaf(bundle, world->wide, visit.child, limit); bits;
         bits &= bits - 1)
        for (uint64_t set = visit.set & open; set; set &= set - 1) {
            int p = __builtin_ctzll(set);
            struct hits hit;
            vint found = hit_lanes(world, bundle, p, ids[__builtin_ctz(bits)], &hit);
            bundle->active[p] &= ~(found & (hit.t < bundle->limit[p]));
            if (!vi_any(bundle->active[p]))
                open &= ~((uint64_t)1 << p);
        }
    return open;
}

static bool any(const struct rb_world *world, struct bundle *bundle)
{
    const struct rb_wide *wide = world->wide;
    struct visit stack[RB_WIDE_STACK];
    int depth = 0;
    uint64_t open = bundle_open(bundle);
    float limit = bundle_limit(bundle);
    if (wide->count[RB_WIDE_NODE])
        stack[depth++] = (struct visit){open, 0.0f, 0};
    while (depth > 0) {
        struct visit visit = stack[--depth];
        visit.set &= open;
        if (!visit.set)
            continue;
        if (falls_apart(bundle))
            return false;
        if (rb_wide_kind_of(visit.child) == RB_WIDE_NODE)
            depth = push(bundle, &wide->nodes[visit.child], visit.set, limit, stack, depth);
        else
            open = leaf_any(world, bundle, visit, limit, open);
    }
    return true;
}

static void load_rays(struct bundle *bundle, const struct rb_rays *rays)
{
    bundle->count = 0, bundle->tests = 0, bundle->useful = 0;
    for (uint32_t i = 0; i < rays->count; i += RB_LANES) {
        int p = bundle->count++;
        struct vvec o = {vf_load(rays->ox + i), vf_load(rays->oy + i), vf_load(rays->oz + i)};
        struct vvec d = {vf_load(rays->dx + i), vf_load(rays->dy + i), vf_load(rays->dz + i)};
        bundle->packet[p] = packet_make(o, d, vi_load(rays->self + i), false);
        bundle->active[p] = vi_first(rays->count - i) & vv_finite(o) & vv_finite(d);
    }
}

static void planes_closest(const struct rb_world *world, struct bundle *bundle, struct hits *best)
{
    struct hits hit;
    for (int p = 0; p < bundle->count; p++) {
        best[p] = (struct hits){vf_set(INFINITY), vf_set(0.0f), vf_set(0.0f), vi_set(RB_NONE)};
        for (uint32_t i = 0; i < world->scene->count[RB_PLANE]; i++) {
            vint found = bundle->active[p] &
                         plane_hit(world->scene, i, &bundle->packet[p], bundle->active[p], &hit);
            keep_closest(&best[p], &hit, found);
        }
        bundle->limit[p] = best[p].t;
    }
}

// Traces at most BUNDLE rays as one bundle. False if they differ too much, and nothing is done.
static bool trace_bundle(const struct rb_world *world, const struct rb_rays *rays,
                         struct rb_hits *hits)
{
    struct bundle bundle;
    struct hits best[PACKETS];
    load_rays(&bundle, rays);
    if (bundle_bound(&bundle) > MIXED_MAX)
        return false;
    planes_closest(world, &bundle, best);
    if (!closest(world, &bundle, best))
        return false;
    for (int p = 0; p < bundle.count; p++) {
        uint32_t i = (uint32_t)(p * RB_LANES);
        vf_store(hits->t + i, best[p].t);
        vf_store(hits->u + i, best[p].u);
        vf_store(hits->v + i, best[p].v);
        vi_store(hits->prim + i, best[p].prim);
        RB_COUNT_END(vi_bits(bundle.active[p]));
        RB_COUNT_RAYS(HITS, vi_bits(best[p].prim != vi_set(RB_NONE)), 1);
    }
    return true;
}

// The rays from `first` to `end` that no bundle took.
static void trace_rest(const struct rb_world *world, const struct rb_rays *rays,
                       struct rb_hits *hits, uint32_t first, uint32_t end)
{
    struct rb_rays some = rb_rays_view(rays, first, end - first, end - first);
    struct rb_hits answers = rb_hits_view(hits, first);
    RB_COUNT_BASE(first);
    if (first < end)
        RB_TWIN(RB_FRUSTUM_ELSE).trace(world, &some, &answers);
    RB_COUNT_BASE(0);
}

// Tries bundles of `size` rays from `first` to `end`, then of a quarter. Rays from `waiting` on
// were too different so far; returns from where on they are now.
static uint32_t trace_range(const struct rb_world *world, const struct rb_rays *rays,
                            struct rb_hits *hits, uint32_t first, uint32_t end, uint32_t size,
                            uint32_t waiting)
{
    for (uint32_t at = first; at < end; at += size) {
        uint32_t count = end - at < size ? end - at : size;
        struct rb_rays some = rb_rays_view(rays, at, count, count);
        struct rb_hits answers = rb_hits_view(hits, at);
        RB_COUNT_BEGIN(at);
        if (trace_bundle(world, &some, &answers)) {
            trace_rest(world, rays, hits, waiting, at);
            waiting = at + count;
        } else if (size / 4 >= BUNDLE_MIN) {
            waiting = trace_range(world, rays, hits, at, at + count, size / 4, waiting);
        }
    }
    return waiting;
}

// SPD's one-sided surfaces are a matter of tests, not of speed.
static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    uint32_t waiting = 0;
    if (!world->one_sided)
        waiting = trace_range(world, rays, hits, 0, rays->count, BUNDLE, 0);
    trace_rest(world, rays, hits, waiting, rays->count);
}

static void load_shadows(struct bundle *bundle, const struct rb_shadows *shadows)
{
    bundle->count = 0, bundle->tests = 0, bundle->useful = 0;
    for (uint32_t i = 0; i < shadows->count; i += RB_LANES) {
        int p = bundle->count++;
        struct vvec o = {vf_load(shadows->ox + i), vf_load(shadows->oy + i),
                         vf_load(shadows->oz + i)};
        struct vvec d = {vf_load(shadows->dx + i), vf_load(shadows->dy + i),
                         vf_load(shadows->dz + i)};
        bundle->packet[p] = packet_make(o, d, vi_load(shadows->self + i), true);
        bundle->active[p] = vi_first(shadows->count - i) & vv_finite(o) & vv_finite(d);
        bundle->limit[p] = vf_load(shadows->distance + i);
    }
}

static void planes_any(const struct rb_world *world, struct bundle *bundle)
{
    struct hits hit;
    for (int p = 0; p < bundle->count; p++)
        for (uint32_t i = 0; i < world->scene->count[RB_PLANE]; i++) {
            vint found = plane_hit(world->scene, i, &bundle->packet[p], bundle->active[p], &hit);
            bundle->active[p] &= ~(found & (hit.t < bundle->limit[p]));
        }
}

static bool shadow_bundle(const struct rb_world *world, struct rb_shadows *shadows)
{
    struct bundle bundle;
    vint wanted[PACKETS];
    load_shadows(&bundle, shadows);
    if (bundle_bound(&bundle) > MIXED_MAX)
        return false;
    memcpy(wanted, bundle.active, sizeof wanted);
    planes_any(world, &bundle);
    if (!any(world, &bundle))
        return false;
    for (int p = 0; p < bundle.count; p++) {
        uint32_t i = (uint32_t)(p * RB_LANES);
        unsigned occluded = vi_bits(wanted[p] & ~bundle.active[p]);
        for (uint32_t lane = 0; lane < RB_LANES && i + lane < shadows->count; lane++)
            shadows->occluded[i + lane] = occluded >> lane & 1;
        RB_COUNT_END(vi_bits(wanted[p]));
        RB_COUNT_RAYS(OCCLUDED, occluded, 1);
    }
    return true;
}

static void shadow_rest(const struct rb_world *world, const struct rb_shadows *shadows,
                        uint32_t first, uint32_t end)
{
    struct rb_shadows some = rb_shadows_view(shadows, first, end - first);
    RB_COUNT_BASE(first);
    if (first < end)
        RB_TWIN(RB_FRUSTUM_ELSE).trace_shadow(world, &some);
    RB_COUNT_BASE(0);
}

static uint32_t shadow_range(const struct rb_world *world, const struct rb_shadows *shadows,
                             uint32_t first, uint32_t end, uint32_t size, uint32_t waiting)
{
    for (uint32_t at = first; at < end; at += size) {
        uint32_t count = end - at < size ? end - at : size;
        struct rb_shadows some = rb_shadows_view(shadows, at, count);
        RB_COUNT_BEGIN(at);
        if (shadow_bundle(world, &some)) {
            shadow_rest(world, shadows, waiting, at);
            waiting = at + count;
        } else if (size / 4 >= BUNDLE_MIN) {
            waiting = shadow_range(world, shadows, at, at + count, size / 4, waiting);
        }
    }
    return waiting;
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    uint32_t waiting = shadow_range(world, shadows, 0, shadows->count, BUNDLE, 0);
    shadow_rest(world, shadows, waiting, shadows->count);
}
