// Packets that are much wider than others of their bundle, since they lie across the edge of
// something seen, are split. All of the packets that they are split into have the same rays, each
// of them other active lanes, and beams around those.
//
// Only for rays that end in one point, seen from which such packets are few and wide. Of the 56
// tests of a packet of shadow rays and a sphere that a bundle of balls_high took, 44 were of the
// one packet in six that starts on several surfaces, and 42 of them in vain; 24 are left.
//
// Tried and dropped: other widths and 1 or 3 rounds (the same, or 3 % slower); reflection and
// refraction rays as well (3 to 5 % slower: what they start on spreads them more than edges do);
// cones around packets against spheres, after the boxes (51 tests of 56 without splits, and 2 %
// slower; with splits the same time); packets that start on one sphere do not meet it (3.7 tests
// of 24, the same time, 2 % faster with AVX2).
#ifndef RB_KERNELS_FRUSTUM_SPLIT_H
#define RB_KERNELS_FRUSTUM_SPLIT_H

#include "kernels/frustum_bound.h"

enum { SPLIT_ROUNDS = 2 };
#define SPLIT_AT 9.0f // times the square of the narrowest width

// Directions of what packets are split into; lanes that are not active are as one that is.
struct splits {
    float d[3][EXTRA * RB_LANES];
};

static void splits_set(const struct bundle *bundle, int p, struct splits *splits)
{
    vint active = bundle->active[p];
    int lane = __builtin_ctz(vi_bits(active));
    for (int k = 0; k < 3; k++) {
        const float *d = bundle->d[k] + bundle->from[p] * RB_LANES;
        vf_store(splits->d[k] + (p - PACKETS) * RB_LANES,
                 vf_select(active, vf_load(d), vf_set(d[lane])));
    }
}

// The axis on which packet p is widest, and its middle there.
static int widest_axis(const struct bundle *bundle, int p, float *middle)
{
    const struct ends *ends = &bundle->ends[p / RB_LANES];
    int lane = p % RB_LANES, axis = 0;
    float widest = -1.0f;
    for (int k = 0; k < 3; k++) {
        float low = ends->low[k][lane], high = ends->high[k][lane];
        if (high - low > widest)
            widest = high - low, axis = k, *middle = (low + high) * 0.5f;
    }
    return axis;
}

// Packets that are split first take no further part.
static void split(struct bundle *bundle, int p, struct splits *splits)
{
    float middle = 0.0f;
    int axis = widest_axis(bundle, p, &middle), from = bundle->from[p];
    vint below = vf_load(bundle->d[axis] + from * RB_LANES) < middle;
    vint sides[2] = {bundle->active[p] & below, bundle->active[p] & ~below};
    bundle->active[p] = vi_set(0);
    int to = p < PACKETS ? PACKETS + bundle->extra++ : p;
    for (int side = 0; side < 2; side++) {
        if (!vi_any(sides[side]))
            continue;
        if (side && vi_any(sides[0]))
            to = PACKETS + bundle->extra++;
        bundle->active[to] = sides[side];
        bundle->lanes[to] = (uint16_t)vi_bits(sides[side]);
        bundle->from[to] = (uint8_t)from;
        splits_set(bundle, to, splits);
    }
}

// The squares of widths.
static vfloat ends_width(const struct ends *ends)
{
    vfloat width = vf_set(0.0f);
    for (int k = 0; k < 3; k++)
        width += (ends->high[k] - ends->low[k]) * (ends->high[k] - ends->low[k]);
    return width;
}

// Packets wider than that, of vectors from `part` on.
static uint64_t wider(const struct bundle *bundle, int part, vfloat most)
{
    uint64_t set = 0;
    for (int parts = bundle_parts(bundle); part < parts; part++)
        set |= (uint64_t)vi_bits(ends_width(&bundle->ends[part]) > most) << part * RB_LANES;
    return set & bundle_packets(bundle);
}

// Fills the beams of split packets, which are turned.
static void splits_bound(struct bundle *bundle)
{
    for (int part = WHOLES; part < PARTS; part++) {
        for (int k = 0; k < 3; k++)
            bound_origin(&bundle->by_packet[part], k, bundle->end[k]);
        bound_part(bundle, part, true);
    }
    for (int p = PACKETS; p < bundle_last(bundle); p++) {
        bundle->credit[p] = CREDIT_NEAR;
        bundle_limit(bundle, p);
    }
}

// To be done when limits are known, and lanes that planes leave nothing to do for.
static void bundle_split(struct bundle *bundle)
{
    struct splits splits;
    vfloat least = ends_width(&bundle->ends[0]);
    for (int part = 1; part < WHOLES; part++)
        least = vf_min(ends_width(&bundle->ends[part]), least);
    vfloat most = vf_min_lane(least) * SPLIT_AT;
    uint64_t set = wider(bundle, 0, most);
    if (!set)
        return;
    bundle->failed &= ~(uint64_t)0 >> (64 - PACKETS);
    for (int round = 0; round < SPLIT_ROUNDS && set; round++) {
        for (; set && bundle->extra < EXTRA - 1; set &= set - 1)
            split(bundle, __builtin_ctzll(set), &splits);
        for (int part = WHOLES; part < PARTS; part++)
            for (int k = 0; k < 3; k++)
                lanes_range(splits.d[k], (part - WHOLES) * RB_LANES, bundle->extra,
                            &bundle->ends[part].low[k], &bundle->ends[part].high[k]);
        set = wider(bundle, WHOLES, most);
    }
    splits_bound(bundle);
}

// Gives packets back what was found for those that they were split into.
static void bundle_join(struct bundle *bundle)
{
    for (int p = PACKETS; p < bundle_last(bundle); p++) {
        bundle->active[bundle->from[p]] |= bundle->active[p];
        bundle->failed |= (bundle->failed >> p & 1) << bundle->from[p];
    }
}

#endif
