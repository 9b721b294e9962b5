// Beams around the rays of a bundle.
#ifndef RB_KERNELS_FRUSTUM_BOUND_H
#define RB_KERNELS_FRUSTUM_BOUND_H

#include "kernels/frustum_bundle.h"

// Lane i: the least, the largest of lanes 2i and 2i + 1 of a and then of b.
RB_INLINE vfloat pairs_min(vfloat a, vfloat b)
{
    return vf_min(VF_EVEN(a, b), VF_ODD(a, b));
}

RB_INLINE vfloat pairs_max(vfloat a, vfloat b)
{
    return vf_max(VF_EVEN(a, b), VF_ODD(a, b));
}

// The least and the largest lane of each of RB_LANES vectors; lane i is what vector i has.
RB_INLINE void lanes_range(const vfloat v[RB_LANES], vfloat *low, vfloat *high)
{
    vfloat lows[RB_LANES / 2], highs[RB_LANES / 2];
#pragma GCC unroll 8
    for (int i = 0; i < RB_LANES / 2; i++) {
        vfloat even = VF_EVEN(v[2 * i], v[2 * i + 1]), odd = VF_ODD(v[2 * i], v[2 * i + 1]);
        lows[i] = vf_min(even, odd), highs[i] = vf_max(even, odd);
    }
#pragma GCC unroll 8
    for (int count = RB_LANES / 4; count > 0; count /= 2)
#pragma GCC unroll 8
        for (int i = 0; i < count; i++) {
            lows[i] = pairs_min(lows[2 * i], lows[2 * i + 1]);
            highs[i] = pairs_max(highs[2 * i], highs[2 * i + 1]);
        }
    *low = lows[0], *high = highs[0];
}

// Intervals by packet of what all packets have in `v`; those that are missing are as packet 0.
static void packets_range(vfloat v[PACKETS], int count, vfloat low[PARTS], vfloat high[PARTS])
{
    for (int p = count; p < PACKETS; p++)
        v[p] = v[0];
    for (int part = 0; part < PARTS; part++)
        lanes_range(v + part * RB_LANES, &low[part], &high[part]);
}

// The interval of all lanes of `v`.
static void all_range(const vfloat v[PACKETS], int count, float *low, float *high)
{
    vfloat least = v[0], most = v[0];
    for (int p = 1; p < count; p++)
        least = vf_min(v[p], least), most = vf_max(v[p], most);
    *low = vf_min_lane(least)[0], *high = vf_max_lane(most)[0];
}

// Beams of directions. The inverse falls where the direction rises, on either side of 0.
static void bound_directions(struct bundle *bundle, int k, bool turned)
{
    vfloat low[PARTS], high[PARTS];
    packets_range(bundle->d[k], bundle->count, low, high);
    for (int part = 0; part < PARTS; part++) {
        struct beams *beams = &bundle->by_packet[part];
        beams->inv[k][0] = safe_inverse(turned ? -low[part] : high[part]);
        beams->inv[k][1] = safe_inverse(turned ? -high[part] : low[part]);
    }
    if (turned) {
        uint64_t some = bundle->signs[k][0];
        bundle->signs[k][0] = ~bundle->signs[k][1], bundle->signs[k][1] = ~some;
    }
}

// Where the rays of a packet go both ways nothing may be culled: beams_slab gets all of the line.
static void bound_mixed(struct bundle *bundle, int k)
{
    uint64_t mixed = bundle->signs[k][0] ^ bundle->signs[k][1];
    for (int part = 0; mixed && part < PARTS; part++) {
        struct beams *beams = &bundle->by_packet[part];
        vint lanes = part_of(mixed, part);
        for (int end = 0; end < 2; end++) {
            vfloat far = vf_set(end ? INFINITY : -INFINITY);
            beams->o[k][end] = vf_select(lanes, far, beams->o[k][end]);
            beams->inv[k][end] = vf_select(lanes, vf_set(1.0f), beams->inv[k][end]);
        }
    }
}

static void bound_rest(struct bundle *bundle, bool one_origin)
{
    for (int p = 0; p < bundle->count; p++)
        bundle->credit[p] = one_origin ? CREDIT_NEAR : CREDIT_FAR;
    vfloat limits[PACKETS], low;
    for (int p = 0; p < PACKETS; p++)
        limits[p] = p < bundle->count ? bundle->limit[p] : vf_set(0.0f);
    for (int part = 0; part < PARTS; part++)
        lanes_range(limits + part * RB_LANES, &low, &bundle->by_packet[part].limit);
}

// Fills the beams of packets.
static void bundle_bound(struct bundle *bundle)
{
    bool one_origin = true;
    for (int k = 0; k < 3; k++) {
        float low, high;
        all_range(bundle->o[k], bundle->count, &low, &high);
        vfloat lows[PARTS], highs[PARTS];
        if (low < high)
            packets_range(bundle->o[k], bundle->count, lows, highs);
        one_origin = one_origin && !(low < high);
        for (int part = 0; part < PARTS; part++) {
            vfloat *o = bundle->by_packet[part].o[k];
            o[0] = low < high ? lows[part] : vf_set(low);
            o[1] = low < high ? highs[part] : vf_set(high);
        }
        bound_directions(bundle, k, false);
        bound_mixed(bundle, k);
    }
    bound_rest(bundle, one_origin);
}

// The point in which all rays end, if there is one: an interval that holds it, 2^-18 of the largest
// coordinate wide to each side, 20 times what the roundings of a slab and of the end can add up to.
static bool bundle_end(const struct bundle *bundle, float low[3], float high[3])
{
    float reach = 0.0f;
    for (int k = 0; k < 3; k++) {
        vfloat ends[PACKETS];
        float o_low, o_high;
        for (int p = 0; p < bundle->count; p++)
            ends[p] = bundle->o[k][p] + bundle->limit[p] * bundle->d[k][p];
        all_range(ends, bundle->count, &low[k], &high[k]);
        all_range(bundle->o[k], bundle->count, &o_low, &o_high);
        reach = rb_max(reach, rb_max(fabsf(low[k]), fabsf(high[k])));
        reach = rb_max(reach, rb_max(fabsf(o_low), fabsf(o_high)));
    }
    float slack = reach * 0x1p-18f;
    for (int k = 0; k < 3; k++) {
        if (!(high[k] - low[k] <= slack))
            return false;
        low[k] -= slack, high[k] += slack;
    }
    return true;
}

// Fills the beams of shadow rays. Those that end in one point, the light, are culled as rays from
// there: they have one origin then, where they themselves have many (Boulos et al., as above).
static void bundle_bound_shadows(struct bundle *bundle)
{
    float low[3], high[3];
    if (!bundle_end(bundle, low, high)) {
        bundle_bound(bundle);
        return;
    }
    for (int k = 0; k < 3; k++) {
        for (int part = 0; part < PARTS; part++) {
            vfloat *o = bundle->by_packet[part].o[k];
            o[0] = vf_set(low[k]), o[1] = vf_set(high[k]);
        }
        bound_directions(bundle, k, true);
        bound_mixed(bundle, k);
    }
    bound_rest(bundle, true);
}

// Takes packets that go the same ways out of `left`, puts them to work together and returns them.
static uint64_t bundle_group(struct bundle *bundle, uint64_t *left)
{
    int first = __builtin_ctzll(*left);
    uint64_t same = *left;
    for (int k = 0; k < 3; k++)
        for (int end = 0; end < 2; end++) {
            uint64_t signs = bundle->signs[k][end];
            same &= signs >> first & 1 ? signs : ~signs;
        }
    *left &= ~same;
    bundle->open = same;
    for (int k = 0; k < 3; k++) {
        vfloat ends[4] = {vf_set(INFINITY), vf_set(-INFINITY), vf_set(INFINITY), vf_set(-INFINITY)};
        for (int part = 0; part < PARTS; part++) {
            const struct beams *beams = &bundle->by_packet[part];
            vint lanes = part_of(same, part);
            ends[0] = vf_min(vf_select(lanes, beams->o[k][0], ends[0]), ends[0]);
            ends[1] = vf_max(vf_select(lanes, beams->o[k][1], ends[1]), ends[1]);
            ends[2] = vf_min(vf_select(lanes, beams->inv[k][0], ends[2]), ends[2]);
            ends[3] = vf_max(vf_select(lanes, beams->inv[k][1], ends[3]), ends[3]);
        }
        bundle->all.o[k][0] = vf_min_lane(ends[0]), bundle->all.o[k][1] = vf_max_lane(ends[1]);
        bundle->all.inv[k][0] = vf_min_lane(ends[2]);
        bundle->all.inv[k][1] = vf_max_lane(ends[3]);
        bundle->backward[k] = (int)(bundle->signs[k][1] >> first & 1);
    }
    bundle_limit_all(bundle);
    return same;
}

#endif
