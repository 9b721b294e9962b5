// Beams around the rays of a bundle.
#ifndef RB_KERNELS_FRUSTUM_BOUND_H
#define RB_KERNELS_FRUSTUM_BOUND_H

#include "kernels/frustum_range.h"

// Are these the same for all rays, bit by bit?
static bool all_same(const float *from, int count)
{
    vint first = (vint)vf_set(from[0]), differ = first ^ first;
    for (int p = 0; p < count; p++)
        differ |= (vint)vf_load(from + p * RB_LANES) ^ first;
    return !vi_any(differ != 0);
}

// Packets that have only finite rays, one bit each. Others may be missing where sums overflow.
static uint64_t bundle_finite(const struct bundle *bundle)
{
    uint64_t finite = 0;
    for (int p = 0; p < bundle->count; p++) {
        struct vvec o = bundle_vector(bundle->o, p), d = bundle_vector(bundle->d, p);
        vfloat sum = (o.x + o.y + o.z) + (d.x + d.y + d.z);
        finite |= (uint64_t)(vi_bits(sum * 0.0f == 0.0f) == VI_ALL_BITS) << p;
    }
    return finite;
}

// Beams of origins on one axis.
static bool bound_origins(struct bundle *bundle, int k)
{
    bool same = all_same(bundle->o[k], bundle->count);
    for (int part = 0; part < WHOLES; part++) {
        vfloat *o = bundle->by_packet[part].o[k];
        if (same)
            o[0] = o[1] = vf_set(bundle->o[k][0]);
        else
            lanes_range(bundle->o[k], part * RB_LANES, bundle->count, &o[0], &o[1]);
    }
    return same;
}

static void bound_origin(struct beams *beams, int k, const float ends[2])
{
    beams->o[k][0] = vf_set(ends[0]), beams->o[k][1] = vf_set(ends[1]);
}

// Beams of directions, or of those turned round. The inverse falls where the direction rises, on
// either side of 0. Where the rays of a packet go both ways, or are parallel to the planes, nothing
// may be culled: beams_slab gets all of the line.
static void bound_part(struct bundle *bundle, int part, bool turned)
{
    for (int k = 0; k < 3; k++) {
        struct beams *beams = &bundle->by_packet[part];
        vfloat low = bundle->ends[part].low[k], high = bundle->ends[part].high[k];
        if (turned) {
            vfloat least = low;
            low = -high, high = -least;
        }
        vint some = low <= 0.0f, all = high < 0.0f, mixed = some ^ all;
        bundle->signs[k][0] |= (uint64_t)vi_bits(some) << part * RB_LANES;
        bundle->signs[k][1] |= (uint64_t)vi_bits(all) << part * RB_LANES;
        beams->inv[k][0] = vf_select(mixed, vf_set(1.0f), safe_inverse(high));
        beams->inv[k][1] = vf_select(mixed, vf_set(1.0f), safe_inverse(low));
        beams->o[k][0] = vf_select(mixed, vf_set(-INFINITY), beams->o[k][0]);
        beams->o[k][1] = vf_select(mixed, vf_set(INFINITY), beams->o[k][1]);
    }
}

static void bound_directions(struct bundle *bundle, bool turned)
{
    memset(bundle->signs, 0, sizeof bundle->signs);
    for (int part = 0; part < WHOLES; part++) {
        struct ends *ends = &bundle->ends[part];
        for (int k = 0; k < 3; k++)
            lanes_range(bundle->d[k], part * RB_LANES, bundle->count, &ends->low[k],
                        &ends->high[k]);
        bound_part(bundle, part, turned);
    }
}

// Packets that are not finite, or go both ways on more axes than one, are no beams.
static void bound_rest(struct bundle *bundle, bool one_origin, uint64_t finite)
{
    uint64_t mixed[3];
    for (int k = 0; k < 3; k++)
        mixed[k] = bundle->signs[k][0] ^ bundle->signs[k][1];
    bundle->failed = (mixed[0] & mixed[1]) | (mixed[1] & mixed[2]) | (mixed[2] & mixed[0]);
    bundle->failed |= ~finite;
    for (int p = 0; p < bundle->count; p++)
        bundle->credit[p] = one_origin ? CREDIT_NEAR : CREDIT_FAR;
}

// Fills the beams of packets.
static void bundle_bound(struct bundle *bundle)
{
    bool one_origin = true;
    for (int k = 0; k < 3; k++)
        one_origin &= bound_origins(bundle, k);
    bound_directions(bundle, false);
    bundle->frame = one_origin ? FRAME_UNKNOWN : FRAME_NONE;
    bound_rest(bundle, one_origin, bundle_finite(bundle));
}

// The point in which all rays end, if there is one: an interval that holds it, 2^-18 of the largest
// coordinate wide to each side, 20 times what the roundings of a slab and of the end can add up to.
static bool bundle_end(struct bundle *bundle)
{
    float(*ends)[2] = bundle->end;
    vfloat far = vf_set(0.0f), sum = far;
    float reach = 0.0f;
    for (int k = 0; k < 3; k++) {
        vfloat least = vf_set(INFINITY), most = -least;
        for (int p = 0; p < bundle->count; p++) {
            vfloat o = vf_load(bundle->o[k] + p * RB_LANES);
            vfloat end = o + bundle_limits(bundle, p) * vf_load(bundle->d[k] + p * RB_LANES);
            least = vf_min(end, least), most = vf_max(end, most);
            far = vf_max(vf_abs(o), far), sum += end;
        }
        ends[k][0] = vf_min_lane(least)[0], ends[k][1] = vf_max_lane(most)[0];
        reach = rb_max(reach, rb_max(fabsf(ends[k][0]), fabsf(ends[k][1])));
    }
    if (vi_any(sum * 0.0f != 0.0f))
        return false; // not finite
    float slack = rb_max(reach, vf_max_lane(far)[0]) * 0x1p-18f;
    for (int k = 0; k < 3; k++) {
        if (!(ends[k][1] - ends[k][0] <= slack))
            return false;
        ends[k][0] -= slack, ends[k][1] += slack;
    }
    return true;
}

// Fills the beams of shadow rays. Those that end in one point, the light, are culled as rays from
// there: they have one origin then, where they themselves have many (Boulos et al., as above).
// Returns whether they do.
static bool bundle_bound_shadows(struct bundle *bundle)
{
    if (!bundle_end(bundle)) {
        bundle_bound(bundle);
        return false;
    }
    for (int k = 0; k < 3; k++) {
        for (int part = 0; part < WHOLES; part++)
            bound_origin(&bundle->by_packet[part], k, bundle->end[k]);
    }
    bound_directions(bundle, true);
    bundle->frame = FRAME_NONE; // rectangles are of rays from where they start
    bound_rest(bundle, true, ~(uint64_t)0 >> (64 - bundle->count));
    return true;
}

// Limits of packets, once they are known.
static void bundle_bound_limits(struct bundle *bundle)
{
    vfloat low;
    for (int part = 0; part < WHOLES; part++)
        lanes_range(bundle->limit, part * RB_LANES, bundle->count, &low,
                    &bundle->by_packet[part].limit);
}

// The least lane of each of four vectors.
RB_INLINE vfloat four_min(const vfloat v[4])
{
    vfloat least = pairs_min(pairs_min(v[0], v[1]), pairs_min(v[2], v[3]));
#pragma GCC unroll 4
    for (int lanes = RB_LANES; lanes > 4; lanes /= 2)
        least = pairs_min(least, least);
    return least;
}

// Takes packets that go the same ways out of `left`, puts them to work together and returns them.
RB_INLINE uint64_t bundle_group(struct bundle *bundle, int parts, uint64_t *left)
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
        vfloat far = vf_set(INFINITY), ends[4] = {far, far, far, far};
        for (int part = 0; part < parts; part++) {
            const struct beams *beams = &bundle->by_packet[part];
            vint lanes = part_of(same, part);
            ends[0] = vf_min(vf_select(lanes, beams->o[k][0], far), ends[0]);
            ends[1] = vf_min(vf_select(lanes, -beams->o[k][1], far), ends[1]);
            ends[2] = vf_min(vf_select(lanes, beams->inv[k][0], far), ends[2]);
            ends[3] = vf_min(vf_select(lanes, -beams->inv[k][1], far), ends[3]);
        }
        vfloat least = four_min(ends);
        bundle->all.o[k][0] = vf_set(least[0]), bundle->all.o[k][1] = vf_set(-least[1]);
        bundle->all.inv[k][0] = vf_set(least[2]), bundle->all.inv[k][1] = vf_set(-least[3]);
        bundle->backward[k] = (int)(bundle->signs[k][1] >> first & 1);
    }
    bundle_limit_all(bundle, parts);
    return same;
}

#endif
