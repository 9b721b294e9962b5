// A bundle of packets as one: intervals that hold the origins and the inverse directions of all its
// rays, and what 8 boxes at once mean to them. Subtraction and multiplication of floats are
// monotone, so a bound computed from the ends of the intervals holds for what rb_slab computes for
// any ray within, rounding included.
#ifndef RB_KERNELS_FRUSTUM_BUNDLE_H
#define RB_KERNELS_FRUSTUM_BUNDLE_H

#include "accel/wide.h"
#include "kernels/packet_trace.h"

enum { BUNDLE = 256, PACKETS = BUNDLE / RB_LANES };

struct bundle {
    struct packet packet[PACKETS];
    vint active[PACKETS];  // lanes whose answer is wanted and not known yet
    vfloat limit[PACKETS]; // farthest distance that matters
    int count;             // of packets
    uint32_t tests;        // of packets against boxes
    uint32_t useful;       // lanes that needed the box in these tests
    float o_low[3], o_high[3], inv_low[3], inv_high[3];
    int backward[3];
    bool mixed[3]; // rays go both ways: nothing is culled on this axis
};

// Vectors of boxes: 8 of a node or a block, or half of them where vectors have 4 lanes.
enum { BOXES = RB_LANES < RB_WIDE ? RB_LANES : RB_WIDE };
typedef float bfloat __attribute__((vector_size(4 * BOXES)));
typedef int32_t bint __attribute__((vector_size(4 * BOXES)));

static inline bfloat bf_load(const float *from)
{
    bfloat v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline bfloat bf_select(bint mask, bfloat a, bfloat b)
{
    return (bfloat)((mask & (bint)a) | (~mask & (bint)b));
}

static inline bfloat bf_min(bfloat a, bfloat b)
{
    return bf_select(a < b, a, b);
}

static inline bfloat bf_max(bfloat a, bfloat b)
{
    return bf_select(a > b, a, b);
}

static inline unsigned bi_bits(bint mask)
{
    unsigned bits = 0;
    for (int i = 0; i < BOXES; i++)
        bits |= (unsigned)mask[i] & (1u << i);
    return bits;
}

// Lower bound of where a ray of the bundle may enter each of the boxes.
static inline bfloat bundle_enter(const struct bundle *bundle, const bfloat near[3])
{
    bfloat enter = {0};
    for (int k = 0; k < 3; k++) {
        if (bundle->mixed[k])
            continue;
        bfloat d = near[k] - (bundle->backward[k] ? bundle->o_low[k] : bundle->o_high[k]);
        enter = bf_max(enter, bf_min(d * bundle->inv_low[k], d * bundle->inv_high[k]));
    }
    return enter;
}

// Upper bound of where it may leave.
static inline bfloat bundle_leave(const struct bundle *bundle, const bfloat far[3])
{
    bfloat leave = (bfloat){0} + INFINITY;
    for (int k = 0; k < 3; k++) {
        if (bundle->mixed[k])
            continue;
        bfloat d = far[k] - (bundle->backward[k] ? bundle->o_high[k] : bundle->o_low[k]);
        leave = bf_min(leave, bf_max(d * bundle->inv_low[k], d * bundle->inv_high[k]));
    }
    return leave * RB_FAR_SCALE;
}

// The boxes that may matter, one bit each; `enter` gets the lower bounds.
static inline unsigned bundle_boxes(const struct bundle *bundle, const bfloat near[3],
                                    const bfloat far[3], float limit, float enter[BOXES])
{
    bfloat from = bundle_enter(bundle, near);
    memcpy(enter, &from, sizeof from);
    return bi_bits((from <= bundle_leave(bundle, far)) & (from <= limit));
}

static inline unsigned bundle_node(const struct bundle *bundle, const struct rb_wide_node *node,
                                   float limit, float enter[RB_WIDE])
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        bfloat near[3], far[3];
        for (int k = 0; k < 3; k++) {
            near[k] = bf_load(node->bounds[k][bundle->backward[k]] + lane);
            far[k] = bf_load(node->bounds[k][!bundle->backward[k]] + lane);
        }
        bits |= bundle_boxes(bundle, near, far, limit, enter + lane) << lane;
    }
    RB_COUNT_STEP((1u << node->count) - 1, RB_WIDE);
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    return bits & ((1u << node->count) - 1);
}

// Primitives of a block whose own boxes, from `low` to `high`, may matter.
static inline unsigned bundle_own_boxes(const struct bundle *bundle, const bfloat low[3],
                                        const bfloat high[3], float limit)
{
    bfloat near[3], far[3];
    float enter[BOXES];
    for (int k = 0; k < 3; k++) {
        near[k] = bundle->backward[k] ? high[k] : low[k];
        far[k] = bundle->backward[k] ? low[k] : high[k];
    }
    return bundle_boxes(bundle, near, far, limit, enter);
}

static unsigned bundle_spheres(const struct bundle *bundle, const struct rb_wide_spheres *block,
                               float limit)
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        bfloat low[3], high[3], radius = bf_load(block->radius + lane);
        radius = bf_max(radius, -radius);
        for (int k = 0; k < 3; k++) {
            bfloat center = bf_load(block->center[k] + lane);
            low[k] = center - radius, high[k] = center + radius;
        }
        bits |= bundle_own_boxes(bundle, low, high, limit) << lane;
    }
    return bits;
}

static unsigned bundle_triangles(const struct bundle *bundle, const struct rb_wide_triangles *block,
                                 float limit)
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        bfloat low[3], high[3];
        for (int k = 0; k < 3; k++) {
            bfloat a = bf_load(block->v[0][k] + lane), b = bf_load(block->v[1][k] + lane);
            bfloat c = bf_load(block->v[2][k] + lane);
            low[k] = bf_min(bf_min(a, b), c), high[k] = bf_max(bf_max(a, b), c);
        }
        bits |= bundle_own_boxes(bundle, low, high, limit) << lane;
    }
    return bits;
}

// The primitives of a leaf that any ray of the bundle may meet, one bit each.
static inline unsigned bundle_leaf(const struct bundle *bundle, const struct rb_wide *wide,
                                   rb_wide_child leaf, float limit)
{
    uint32_t index = rb_wide_index_of(leaf);
    const uint32_t *ids = rb_wide_ids(wide, leaf);
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane++)
        bits |= (ids[lane] != RB_NONE ? 1u : 0u) << lane;
    if (rb_wide_kind_of(leaf) == RB_WIDE_SPHERES)
        bits &= bundle_spheres(bundle, &wide->spheres[index], limit);
    else if (rb_wide_kind_of(leaf) == RB_WIDE_TRIANGLES)
        bits &= bundle_triangles(bundle, &wide->triangles[index], limit);
    RB_COUNT_STEP(bits, RB_WIDE);
    return bits;
}

// Does any ray of packet p need the box?
static inline bool bundle_meets(struct bundle *bundle, int p, const float low[3],
                                const float high[3])
{
    struct interval range = box(low, high, &bundle->packet[p]);
    RB_COUNT_STEP(vi_bits(bundle->active[p]), RB_LANES);
    RB_COUNT_LANE(p * RB_LANES);
    RB_COUNT_RAYS(BOXES, vi_bits(bundle->active[p]), 1);
    RB_COUNT_LANE(-p * RB_LANES);
    unsigned bits =
        vi_bits(bundle->active[p] & (range.near <= range.far) & (range.near <= bundle->limit[p]));
    bundle->tests++;
    bundle->useful += (uint32_t)__builtin_popcount(bits);
    return bits != 0;
}

// Of the packets in `set` those from the first to the last that need child `c`; those in between
// come along untested.
static inline uint64_t bundle_narrow(struct bundle *bundle, uint64_t set,
                                     const struct rb_wide_node *node, int c)
{
    float low[3], high[3];
    for (int k = 0; k < 3; k++)
        low[k] = node->bounds[k][0][c], high[k] = node->bounds[k][1][c];
    while (set && !bundle_meets(bundle, __builtin_ctzll(set), low, high))
        set &= set - 1;
    while (set & (set - 1)) {
        int last = 63 - __builtin_clzll(set);
        if (bundle_meets(bundle, last, low, high))
            break;
        set &= ~((uint64_t)1 << last);
    }
    return set;
}

// Packets with active lanes, one bit each.
static inline uint64_t bundle_open(const struct bundle *bundle)
{
    uint64_t open = 0;
    for (int p = 0; p < bundle->count; p++)
        open |= (uint64_t)vi_any(bundle->active[p]) << p;
    return open;
}

// The largest limit of an active lane.
static inline float bundle_limit(const struct bundle *bundle)
{
    vfloat most = vf_set(-INFINITY);
    float lanes[RB_LANES], limit = -INFINITY;
    for (int p = 0; p < bundle->count; p++)
        most = vf_select(bundle->active[p], vf_max(bundle->limit[p], most), most);
    vf_store(lanes, most);
    for (int lane = 0; lane < RB_LANES; lane++)
        limit = rb_max(lanes[lane], limit);
    return limit;
}

// Least and largest of the active lanes of one component of all packets.
struct range {
    vfloat low, high;
};

static inline void range_add(struct range *range, vfloat value, vint active)
{
    range->low = vf_select(active, vf_min(value, range->low), range->low);
    range->high = vf_select(active, vf_max(value, range->high), range->high);
}

static inline void range_ends(const struct range *range, float *low, float *high)
{
    float lows[RB_LANES], highs[RB_LANES];
    vf_store(lows, range->low), vf_store(highs, range->high);
    *low = lows[0], *high = highs[0];
    for (int lane = 1; lane < RB_LANES; lane++) {
        *low = rb_min(lows[lane], *low);
        *high = rb_max(highs[lane], *high);
    }
}

// Fills the intervals. Returns the number of axes on which rays go both ways.
static int bundle_bound(struct bundle *bundle)
{
    const struct range none = {vf_set(INFINITY), vf_set(-INFINITY)};
    struct range o[3] = {none, none, none}, inv[3] = {none, none, none};
    int mixed = 0;
    for (int p = 0; p < bundle->count; p++) {
        const struct packet *packet = &bundle->packet[p];
        const vfloat os[3] = {packet->o.x, packet->o.y, packet->o.z};
        const vfloat invs[3] = {packet->inv.x, packet->inv.y, packet->inv.z};
        for (int k = 0; k < 3; k++) {
            range_add(&o[k], os[k], bundle->active[p]);
            range_add(&inv[k], invs[k], bundle->active[p]);
        }
    }
    for (int k = 0; k < 3; k++) {
        range_ends(&o[k], &bundle->o_low[k], &bundle->o_high[k]);
        range_ends(&inv[k], &bundle->inv_low[k], &bundle->inv_high[k]);
        bundle->backward[k] = bundle->inv_low[k] < 0.0f;
        bundle->mixed[k] = bundle->backward[k] != (bundle->inv_high[k] < 0.0f);
        mixed += bundle->mixed[k];
    }
    return mixed;
}

#endif
