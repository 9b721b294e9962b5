// A bundle of packets as beams: intervals that hold the origins and the inverse directions of rays,
// and what boxes mean to them. One beam holds all rays that are traced together, and meets the 8
// boxes of a node or a block at once; one holds the rays of each packet, and all of these meet a
// box at once.
//
// Subtraction and multiplication of floats are monotone, so a bound computed from the ends of the
// intervals holds for what rb_slab computes for any ray within, rounding included.
#ifndef RB_KERNELS_FRUSTUM_BUNDLE_H
#define RB_KERNELS_FRUSTUM_BUNDLE_H

#include "kernels/eights.h"
#include "kernels/packet_trace.h"

// FEW and the credits are from sweeps of least times on a busy machine. FEW: 2 instead of 4 takes
// 2 % off shadow rays of balls_high; 8 and 16 are up to a third and to 1.9 times slower. FEW_EYE: 8
// instead of 4 takes 1 to 4 % off primary rays of balls6 and mount10, mount6 takes 1 % more.
// Credits of 16 and 4, 32 and 8, 64 and 16, 128 and 32: primary rays of mount9 40, 37, 37, 35 ns,
// shadow rays there 93, 67, 62, 73, of balls_high 10.2, 10.8, 10.9, 11.4; refraction on balls6 29,
// 31, 34, 40.
enum {
    BUNDLE = RB_LANES < 8 ? 128 : 256, // rays
    PACKETS = BUNDLE / RB_LANES,
    EXTRA = 32,                        // that others may be split into (frustum_split.h)
    WHOLES = PACKETS / RB_LANES,       // vectors with a lane for each packet,
    PARTS = WHOLES + EXTRA / RB_LANES, // and for each of those as well
    FEW = 2,                           // packets that meet boxes one by one,
    FEW_EYE = 8,                       // on a plane (frustum_frame.h)
    CREDIT_NEAR = 64, // tests in vain after which a packet is given up: rays from one point,
    CREDIT_FAR = 8,   // other rays
};

// A beam in every lane.
struct beams {
    vfloat o[3][2], inv[3][2]; // lower and upper ends
    vfloat limit;              // farthest distance that matters to any of its rays
};

// The least and the largest direction of rays, a packet in every lane.
struct ends {
    vfloat low[3], high[3];
};

// Are packets rectangles on a plane?
enum frame { FRAME_UNKNOWN, FRAME_NONE, FRAME_KNOWN };

// Of whole packets, all of whose rays exist. The rays stay where they are. Those from PACKETS on
// are what others are split into.
struct bundle {
    const float *o[3], *d[3]; // of the first ray
    const uint32_t *self;
    const float *limit;           // farthest distance that matters
    float end[3][2];              // where all rays end, if they end in one point
    uint32_t place;               // of the first ray, in its queue
    uint32_t rays;                // in the queue; those of a last part of a packet do not take part
    bool more;                    // is there another whole bundle behind?
    int count;                    // of packets,
    int extra;                    // and of those that others are split into
    vint active[PACKETS + EXTRA]; // lanes whose answer is not known yet
    uint8_t from[PACKETS + EXTRA];   // the packet whose rays these are,
    uint16_t lanes[PACKETS + EXTRA]; // and which of them, one bit each
    int credit[PACKETS + EXTRA];     // so many tests may still be in vain
    uint64_t signs[3][2]; // packets of which some, all rays go backward on an axis; 0 is both ways
    uint64_t open;        // packets in work, one bit each
    uint64_t failed;      // packets that are no beam, or were given up
    struct beams all;     // the same beam in all lanes
    struct beams by_packet[PARTS];
    struct ends ends[PARTS];
    int backward[3];  // do the rays in work go backward on this axis?
    enum frame frame; // what follows is for rays of one origin (frustum_frame.h)
    float axes[3][3];
    float low[2][PACKETS], high[2][PACKETS]; // rectangles of packets on a plane
    float bend;                              // the plane is at most that much oblique
};

RB_INLINE struct vvec bundle_vector(const float *const from[3], int p)
{
    return (struct vvec){vf_load(from[0] + p * RB_LANES), vf_load(from[1] + p * RB_LANES),
                         vf_load(from[2] + p * RB_LANES)};
}

RB_INLINE struct packet bundle_packet(const struct bundle *b, int p, bool shadow)
{
    int from = b->from[p];
    return packet_make(bundle_vector(b->o, from), bundle_vector(b->d, from),
                       vi_load(b->self + from * RB_LANES), shadow);
}

RB_INLINE vfloat bundle_limits(const struct bundle *bundle, int p)
{
    return vf_load(bundle->limit + bundle->from[p] * RB_LANES);
}

// Fetches the rays of the next bundle that are where those of packet p are in this one. Few fetches
// can be under way: to be called packet by packet, with other work in between.
RB_INLINE void bundle_prefetch(const struct bundle *bundle, int p)
{
    int at = BUNDLE + p * RB_LANES;
    if (at % 16 != 0 || !bundle->more)
        return;
    for (int k = 0; k < 3; k++) {
        __builtin_prefetch(bundle->o[k] + at);
        __builtin_prefetch(bundle->d[k] + at);
    }
    __builtin_prefetch(bundle->limit + at);
    __builtin_prefetch(bundle->self + at);
}

RB_INLINE uint32_t bundle_place(const struct bundle *bundle, int p)
{
    return bundle->place + (uint32_t)bundle->from[p] * RB_LANES;
}

// One behind the last packet that another is split into.
static inline int bundle_last(const struct bundle *bundle)
{
    return PACKETS + bundle->extra;
}

// Vectors that have packets. Those who know that none are split say WHOLES, which is faster.
static inline int bundle_parts(const struct bundle *bundle)
{
    return bundle->extra ? PARTS : WHOLES;
}

// Packets that are beams and have rays whose answer is not known, one bit each.
static inline uint64_t bundle_packets(const struct bundle *bundle)
{
    uint64_t packets = 0;
    for (int p = 0; p < bundle->count; p++)
        packets |= (uint64_t)vi_any(bundle->active[p]) << p;
    for (int p = PACKETS; p < bundle_last(bundle); p++)
        packets |= (uint64_t)vi_any(bundle->active[p]) << p;
    return packets & ~bundle->failed;
}

// Packet p has tested a primitive that it does not meet; with too many of those it is given up.
RB_INLINE void bundle_in_vain(struct bundle *bundle, int p)
{
    if (--bundle->credit[p] == 0) {
        bundle->open &= ~((uint64_t)1 << p);
        bundle->failed |= (uint64_t)1 << p;
    }
}

// Where the near and the far planes of the 8 boxes of a node or a block are.
struct planes {
    const float *near[3], *far[3];
};

// `bounds` as in rb_wide_node, from its first element on.
RB_INLINE struct planes planes_of(const struct bundle *bundle, const float *bounds)
{
    struct planes planes;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        planes.near[k] = bounds + (2 * k + bundle->backward[k]) * RB_WIDE;
        planes.far[k] = bounds + (2 * k + !bundle->backward[k]) * RB_WIDE;
    }
    return planes;
}

// Seen from the near plane of a box the origin that matters is the one that lies farthest along the
// rays, from the far plane the other end of the interval.
RB_INLINE void beams_slab(const struct beams *beams, int k, int backward, vfloat near, vfloat far,
                          vfloat *from, vfloat *to)
{
    vfloat enter = near - beams->o[k][!backward], leave = far - beams->o[k][backward];
    *from = vf_max(*from, vf_min(enter * beams->inv[k][0], enter * beams->inv[k][1]));
    *to = vf_min(*to, vf_max(leave * beams->inv[k][0], leave * beams->inv[k][1]));
}

// The beams that may meet the boxes, lane by lane, one bit each; no ray enters one before `enter`.
RB_INLINE unsigned beams_meet(const struct beams *beams, const int backward[3],
                              const vfloat near[3], const vfloat far[3], vfloat *enter)
{
    vfloat from = vf_set(0.0f), to = vf_set(INFINITY);
    beams_slab(beams, 0, backward[0], near[0], far[0], &from, &to);
    beams_slab(beams, 1, backward[1], near[1], far[1], &from, &to);
    beams_slab(beams, 2, backward[2], near[2], far[2], &from, &to);
    *enter = from;
    return vi_bits(from <= vf_min(to * RB_FAR_SCALE, beams->limit));
}

// Loads the planes of boxes from `lane` on.
RB_INLINE void planes_load(const struct planes *planes, int lane, vfloat near[3], vfloat far[3])
{
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        near[k] = vf_load8(planes->near[k] + lane);
        far[k] = vf_load8(planes->far[k] + lane);
    }
}

// The boxes that any ray in work may meet, one bit each.
RB_INLINE unsigned bundle_boxes(const struct bundle *bundle, const struct planes *planes,
                                float enter[RB_WIDE])
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        vfloat near[3], far[3], from;
        planes_load(planes, lane, near, far);
        bits |= beams_meet(&bundle->all, bundle->backward, near, far, &from) << lane;
        vf_store8(enter + lane, from);
    }
    return bits;
}

// Of the packets in `set` those that may meet box `lane`.
RB_INLINE uint64_t bundle_narrow(const struct bundle *bundle, int parts, uint64_t set,
                                 const struct planes *planes, int lane)
{
    uint64_t bits = 0;
    const vfloat near[3] = {vf_set(planes->near[0][lane]), vf_set(planes->near[1][lane]),
                            vf_set(planes->near[2][lane])};
    const vfloat far[3] = {vf_set(planes->far[0][lane]), vf_set(planes->far[1][lane]),
                           vf_set(planes->far[2][lane])};
    for (int part = 0; part < parts; part++) {
        vfloat enter;
        unsigned asked = set >> part * RB_LANES & VI_ALL_BITS;
        if (!asked)
            continue;
        bits |= (uint64_t)beams_meet(&bundle->by_packet[part], bundle->backward, near, far, &enter)
                << part * RB_LANES;
        RB_COUNT_STEP(asked, RB_LANES);
    }
    return set & bits;
}

// The beam of packet p, in all lanes.
RB_INLINE struct beams bundle_beam(const struct bundle *bundle, int p)
{
    const struct beams *from = &bundle->by_packet[p / RB_LANES];
    int lane = p % RB_LANES;
    struct beams beam = {.limit = vf_set(from->limit[lane])};
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++)
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            beam.o[k][end] = vf_set(from->o[k][end][lane]);
            beam.inv[k][end] = vf_set(from->inv[k][end][lane]);
        }
    return beam;
}

// Which packets may meet which of 8 boxes, and where at the earliest.
struct reach {
    unsigned boxes; // that are met, one bit each
    uint64_t set[RB_WIDE];
    float enter[RB_WIDE];
};

// Few packets meet all boxes one after the other, and that is all.
RB_INLINE void reach_few(const struct bundle *bundle, uint64_t set, const struct planes *planes,
                         struct reach *reach)
{
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        vfloat near[3], far[3], from, first = vf_set(INFINITY);
        planes_load(planes, lane, near, far);
        for (uint64_t left = set; left; left &= left - 1) {
            int p = __builtin_ctzll(left);
            struct beams beam = bundle_beam(bundle, p);
            unsigned bits = beams_meet(&beam, bundle->backward, near, far, &from);
            bits &= (1u << BOXES) - 1;
            first = vf_min(from, first);
            reach->boxes |= bits << lane;
            for (; bits; bits &= bits - 1)
                reach->set[lane + __builtin_ctz(bits)] |= (uint64_t)1 << p;
            RB_COUNT_STEP((1u << BOXES) - 1, BOXES);
        }
        vf_store8(reach->enter + lane, first);
    }
}

RB_INLINE void bundle_reach(const struct bundle *bundle, int parts, uint64_t set,
                            const struct planes *planes, struct reach *reach)
{
    reach->boxes = 0;
    memset(reach->set, 0, sizeof reach->set);
    if (__builtin_popcountll(set) <= FEW) {
        reach_few(bundle, set, planes, reach);
        return;
    }
    RB_COUNT_STEP((1u << RB_WIDE) - 1, RB_WIDE);
    unsigned bits = bundle_boxes(bundle, planes, reach->enter) & ((1u << RB_WIDE) - 1);
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        reach->set[lane] = bundle_narrow(bundle, parts, set, planes, lane);
        reach->boxes |= (reach->set[lane] ? 1u : 0u) << lane;
    }
}

// The limit of packet p has changed; bundle_limit_all follows when all such are known.
RB_INLINE void bundle_limit(struct bundle *bundle, int p)
{
    vfloat limit = vf_select(bundle->active[p], bundle_limits(bundle, p), vf_set(-INFINITY));
    vfloat *limits = &bundle->by_packet[p / RB_LANES].limit;
    *limits = vf_select(vi_lanes() == p % RB_LANES, vf_max_lane(limit), *limits);
}

// The lanes of part `part` that are packets of `set`.
RB_INLINE vint part_of(uint64_t set, int part)
{
    vint bits = vi_set((uint32_t)(set >> part * RB_LANES & VI_ALL_BITS));
    return (bits >> vi_lanes() & 1) != 0;
}

RB_INLINE void bundle_limit_all(struct bundle *bundle, int parts)
{
    vfloat all = vf_set(-INFINITY);
    for (int part = 0; part < parts; part++)
        all =
            vf_max(vf_select(part_of(bundle->open, part), bundle->by_packet[part].limit, all), all);
    bundle->all.limit = vf_max_lane(all);
}

// Keeps what packet p has found closer than before; bundle_closer follows.
RB_INLINE void keep_hit(const struct bundle *bundle, int p, const struct hits *hit, vint found,
                        struct rb_hits *hits)
{
    struct hits best = hits_load(hits, bundle_place(bundle, p));
    keep_closest(&best, hit, found);
    hits_store(hits, bundle_place(bundle, p), &best);
}

// Brings the limits of a bundle up to date, of which these packets have found something.
RB_INLINE void bundle_closer(struct bundle *bundle, uint64_t closer)
{
    if (!closer)
        return;
    for (; closer; closer &= closer - 1)
        bundle_limit(bundle, __builtin_ctzll(closer));
    bundle_limit_all(bundle, WHOLES);
}

#endif
