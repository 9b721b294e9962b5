// Bundles: 256 neighbouring rays (128 with SSE2), the packets of a block of the image, go through
// the wide tree together as beams, intervals of origins and inverse directions (Boulos, Wald,
// Shirley 2006, "Geometric and arithmetic culling methods for entire ray packets"). One vector
// operation holds the 8 boxes of a node against the beam of all, one holds a box that is left
// against the beams of all packets; only the primitives that are left after both are tested ray by
// ray. Shadow rays that end in one point are culled as rays from there.
//
// Packets of a bundle that go the same ways are traced together. Those that go both ways on two
// axes, and those that have tested too many primitives in vain, wait for each other and go on as a
// stream (stream.c), and so does the rest of a queue once most of its packets did. Compiled once
// per instruction set (Makefile).
//
// What each step brought: ns a ray at 1024 x 1024, AVX-512, one Zen 4 thread, least times.
//   beams, against packets one by one, the first and the last only (Wald, Boulos, Shirley 2007):
//     balls_high primary 12.2 -> 7.1, shadow 22.9 -> 11.4, mount9 62 -> 39, 133 -> 70
//   few packets meet boxes one by one: mount10 primary 87 -> 75, shadow 158 -> 130
//   rays read in place: balls_high primary 7.1 -> 5.5, shadow 10.7 -> 9.3, reflection 22.2 -> 21.3
//   leaves on a plane before the eye (frustum_frame.h): primary balls6 26 -> 23, mount9 30 -> 24,
//     mount10 67 -> 57; nodes, too, by few packets: balls6 23.5 -> 20.8
//   wide shadow packets split (frustum_split.h): balls_high 9.4 -> 7.4, balls6 39 -> 34
//   rays of the next bundle fetched: balls_high primary 5.8 -> 5.3, shadow 7.5 -> 7.0
//   the rest of a queue streamed: balls_high diffuse 33.8 -> 29.2, mount9 refraction 70 -> 57,
//     mount10 shadow 111 -> 97 (from a third given up: balls_high shadow +6 %, balls6 -11 %)
//
// Tried and dropped: cones round packets; 2, 4, 8 bundles in turn, visit by visit, to hide misses
// (+2 to +5 %); nodes on the plane by many packets (mount6 +8 %), and no beams (the same); giving
// up bundles as a whole, and trying quarters of them; packets of 16 x 1 pixels (primary +37 %);
// inverses kept for all packets (+4 %); bundles of 512 (+9 %); leaves in two passes (+1 to -2 %);
// packets of reflected rays split (+3 %).
//
// What is left. Of 26 ns of balls6 mispredicted branches were 6, the tree from memory 3, rays from
// memory 2; of 68 of mount10 7, 10, 3. Of reflections on balls_high the one in six that goes both
// ways on two axes takes half of the time, as a stream.
#include "kernels/frustum_bound.h"
#include "kernels/frustum_rest.h"
#include "kernels/frustum_search.h"
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

// What all bundles of a queue have in common.
static void bundle_init(struct bundle *bundle)
{
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
