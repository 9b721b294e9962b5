// Bundles: 256 neighbouring rays, the packets of a block of the image, go through the wide tree
// together as beams, intervals of origins and inverse directions (Boulos, Wald, Shirley 2006,
// "Geometric and arithmetic culling methods for entire ray packets"). One vector operation holds
// the 8 boxes of a node against the beam of all, one holds a box that is left against the beams of
// all packets; only the primitives that are left after both are tested ray by ray. Shadow rays
// that end in one point are culled as rays from there.
//
// Packets of a bundle that go the same ways are traced together. Those that go both ways on two
// axes, and those that have tested too many primitives in vain, wait for each other and go on as a
// stream (stream.c), and so does the rest of a queue once most of its packets did. Compiled once
// per instruction set (Makefile).
//
// ns a ray, balls_high 1024 x 1024, one Zen 4 thread beside other load, least times: primary 12.2
// -> 7.1, shadow 22.9 -> 11.4, refraction 22.9 -> 17.2 against bundles whose packets were tested
// box by box, ray by ray, the first and the last of them only (after Wald, Boulos, Shirley 2007);
// mount9 primary 62 -> 39, shadow 133 -> 70. Shadow rays culled from the surface instead: 23.7. Few
// packets meet boxes one by one: mount10 primary 87 -> 75, shadow 158 -> 130. Rays read in place
// instead of copied into the bundle, one comparison for common origins, signs from the ends of the
// beams: balls_high primary 7.1 -> 5.5, shadow 10.7 -> 9.3, reflection 22.2 -> 21.3. Leaves met on
// a plane before the eye (frustum_frame.h): primary balls6 26.1 -> 23.0, mount9 30.2 -> 24.3,
// mount10 67 -> 57 (cones round packets instead: 25.5, 28.3, 63); nodes, too, by few packets:
// balls6 23.5 -> 20.8, mount10 57 -> 56. What is left of balls6, 26 ns before that: mispredicted
// branches 6, the tree from memory 3, rays from memory 2; of mount10, 68: 7, 10, 3. Rays of the
// next bundle fetched while packets of this one meet planes: balls_high primary 5.8 -> 5.3, shadow
// 7.5 -> 7.0 (all at once: -4 to +10 %). The rest of a queue streamed: balls_high diffuse 33.8 ->
// 29.2, balls6 refraction 29 -> 23, mount9 refraction 70 -> 57, mount10 shadow 111 -> 97 (streamed
// once a third was given up: shadow of balls_high +6 %, of balls6 -11 %). Tried and dropped: 2, 4,
// 8 bundles in turn, visit by visit, to hide misses (+2 to +5 %); nodes on the plane by many
// packets (mount6 +8 %); all by the plane, no beams (the same); giving up bundles as a whole, and
// then trying quarters of them (shadow 15 to 18); packets of 16 x 1 instead of 4 x 4 pixels
// (primary 14.5 -> 10.6 when that was changed). Of rays read in place: inverses kept for all
// packets (primary +4 %), bundles of 512 (+9 %), leaves in two passes as those of streams are (+1
// to -2 %).
#include "kernels/frustum_bound.h"
#include "kernels/frustum_eye.h"
#include "kernels/frustum_leaf.h"
#include "kernels/frustum_rest.h"
#include "kernels/frustum_split.h"
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"

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

#define ELSE RB_TWIN(RB_FRUSTUM_ELSE)

const struct rb_kernels RB_TWIN(RB_FRUSTUM) = {
    .generate = generate,
    .trace = trace,
    .surface = surface,
    .light = light,
    .trace_shadow = trace_shadow,
};

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
    if (bundle->frame == FRAME_KNOWN && __builtin_popcountll(set) <= FEW) {
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

// What all bundles of a queue have in common.
static void bundle_init(struct bundle *bundle)
{
    bundle->frame = FRAME_NONE;
    for (int p = 0; p < PACKETS; p++)
        bundle->from[p] = (uint8_t)p, bundle->lanes[p] = VI_ALL_BITS;
}

// Takes the rays of a queue from `first` on, and returns whether there is any whole packet.
static bool load(struct bundle *bundle, uint32_t first, uint32_t count)
{
    bundle->place = first;
    bundle->rays = count - first < BUNDLE ? count - first : BUNDLE;
    bundle->count = (int)(bundle->rays / RB_LANES);
    bundle->more = count - first >= 2 * BUNDLE;
    bundle->failed = ~(uint64_t)0;
    for (int p = 0; p < bundle->count; p++)
        bundle->active[p] = vi_first(RB_LANES);
    bundle->extra = 0;
    return bundle->count > 0;
}

static bool load_rays(const struct rb_rays *rays, uint32_t first, const struct rb_hits *hits,
                      struct bundle *bundle)
{
    bundle->o[0] = rays->ox + first, bundle->o[1] = rays->oy + first;
    bundle->o[2] = rays->oz + first;
    bundle->d[0] = rays->dx + first, bundle->d[1] = rays->dy + first;
    bundle->d[2] = rays->dz + first;
    bundle->self = rays->self + first;
    bundle->limit = hits->t + first;
    return load(bundle, first, rays->count);
}

static void planes_closest(const struct rb_world *world, const struct bundle *bundle,
                           struct rb_hits *hits)
{
    struct hits hit;
    for (uint64_t set = bundle_packets(bundle); set; set &= set - 1) {
        int p = __builtin_ctzll(set);
        bundle_prefetch(bundle, p);
        struct packet packet = bundle_packet(bundle, p, false);
        struct hits best = {vf_set(INFINITY), vf_set(0.0f), vf_set(0.0f), vi_set(RB_NONE)};
        RB_COUNT_BEGIN(bundle_place(bundle, p));
        for (uint32_t i = 0; i < world->scene->count[RB_PLANE]; i++) {
            vint found = plane_hit(world->scene, i, &packet, bundle->active[p], &hit);
            keep_closest(&best, &hit, found);
        }
        hits_store(hits, bundle_place(bundle, p), &best);
    }
}

// Packets that are no beams, or were given up, join the rest. Returns whether p is one.
static inline bool give_up(const struct bundle *bundle, int p, bool shadow, struct rest *rest)
{
    if (!(bundle->failed >> p & 1))
        return false;
    struct packet packet = bundle_packet(bundle, p, shadow);
    vint wanted = vi_first(bundle->rays - (uint32_t)p * RB_LANES);
    rest_add(rest, &packet, wanted, bundle_limits(bundle, p), bundle_place(bundle, p));
    return true;
}

static void trace_bundle(const struct rb_world *world, struct bundle *bundle, struct rb_hits *hits)
{
    bundle_bound(bundle);
    planes_closest(world, bundle, hits);
    bundle_bound_limits(bundle);
    for (uint64_t left = bundle_packets(bundle); left;) {
        uint64_t group = bundle_group(bundle, WHOLES, &left);
        closest(world, bundle, hits);
        RB_COUNT(count_end(bundle, group));
    }
}

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    struct bundle bundle;
    struct rest rest;
    uint32_t first = 0, end = world->one_sided ? 0 : rays->count; // no bundles of one-sided tests
    rest.count = rest.total = 0;
    bundle_init(&bundle);
    for (; first < end && !rest_is_most(&rest, first); first += BUNDLE) {
        if (load_rays(rays, first, hits, &bundle))
            trace_bundle(world, &bundle, hits);
        for (int p = 0; (uint32_t)p * RB_LANES < bundle.rays; p++) {
            if (give_up(&bundle, p, false, &rest))
                continue;
            RB_COUNT_BEGIN(bundle_place(&bundle, p));
            RB_COUNT_RAYS(
                HITS, vi_bits(hits_load(hits, bundle_place(&bundle, p)).prim != vi_set(RB_NONE)),
                1);
        }
        if (rest.count > REST_MAX - BUNDLE)
            rest_trace(&rest, &ELSE, world, hits);
    }
    if (rest.count)
        rest_trace(&rest, &ELSE, world, hits);
    if (first < rays->count)
        trace_from(first, &ELSE, world, rays, hits);
}

static bool load_shadows(const struct rb_shadows *shadows, uint32_t first, struct bundle *bundle)
{
    bundle->o[0] = shadows->ox + first, bundle->o[1] = shadows->oy + first;
    bundle->o[2] = shadows->oz + first;
    bundle->d[0] = shadows->dx + first, bundle->d[1] = shadows->dy + first;
    bundle->d[2] = shadows->dz + first;
    bundle->self = shadows->self + first;
    bundle->limit = shadows->distance + first;
    return load(bundle, first, shadows->count);
}

static void planes_any(const struct rb_world *world, struct bundle *bundle)
{
    struct hits hit;
    for (uint64_t set = bundle_packets(bundle); set; set &= set - 1) {
        int p = __builtin_ctzll(set);
        bundle_prefetch(bundle, p);
        struct packet packet = bundle_packet(bundle, p, true);
        RB_COUNT_BEGIN(bundle_place(bundle, p));
        for (uint32_t i = 0; i < world->scene->count[RB_PLANE]; i++) {
            vint found = plane_hit(world->scene, i, &packet, bundle->active[p], &hit);
            bundle->active[p] &= ~(found & (hit.t < bundle_limits(bundle, p)));
        }
    }
}

static void shadow_bundle(const struct rb_world *world, struct bundle *bundle)
{
    bool light = bundle_bound_shadows(bundle);
    planes_any(world, bundle);
    bundle_bound_limits(bundle);
    if (light)
        bundle_split(bundle);
    for (uint64_t left = bundle_packets(bundle); left;) {
        uint64_t group = bundle_group(bundle, bundle_parts(bundle), &left);
        any(world, bundle);
        RB_COUNT(count_end(bundle, group));
    }
    bundle_join(bundle);
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    struct bundle bundle;
    struct rest rest;
    uint32_t first = 0;
    rest.count = rest.total = 0;
    bundle_init(&bundle);
    for (; first < shadows->count && !rest_is_most(&rest, first); first += BUNDLE) {
        if (load_shadows(shadows, first, &bundle))
            shadow_bundle(world, &bundle);
        for (int p = 0; (uint32_t)p * RB_LANES < bundle.rays; p++) {
            uint32_t i = bundle_place(&bundle, p);
            if (give_up(&bundle, p, true, &rest))
                continue;
            vi_store_bytes(shadows->occluded + i, ~bundle.active[p] & 1);
            RB_COUNT_BEGIN(i);
            RB_COUNT_RAYS(OCCLUDED, VI_ALL_BITS & ~vi_bits(bundle.active[p]), 1);
        }
        if (rest.count > REST_MAX - BUNDLE)
            rest_trace_shadow(&rest, &ELSE, world, shadows);
    }
    if (rest.count)
        rest_trace_shadow(&rest, &ELSE, world, shadows);
    if (first < shadows->count)
        trace_shadow_from(first, &ELSE, world, shadows);
}
