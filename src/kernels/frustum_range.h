// Least and largest lanes of packets.
#ifndef RB_KERNELS_FRUSTUM_RANGE_H
#define RB_KERNELS_FRUSTUM_RANGE_H

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

// Packet i of `count`; those that are missing are as packet 0.
RB_INLINE vfloat packet_at(const float *from, int i, int count)
{
    return vf_load(from + (i < count ? i : 0) * RB_LANES);
}

// The least and the largest lane of packets `first` to `first` + RB_LANES - 1; lane i is what
// packet first + i has.
static void lanes_range(const float *from, int first, int count, vfloat *low, vfloat *high)
{
    vfloat lows[RB_LANES / 2], highs[RB_LANES / 2];
#pragma GCC unroll 8
    for (int i = 0; i < RB_LANES / 2; i++) {
        vfloat a = packet_at(from, first + 2 * i, count);
        vfloat b = packet_at(from, first + 2 * i + 1, count);
        vfloat even = VF_EVEN(a, b), odd = VF_ODD(a, b);
        lows[i] = vf_min(even, odd), highs[i] = vf_max(even, odd);
    }
#pragma GCC unroll 8
    for (int left = RB_LANES / 4; left > 0; left /= 2)
#pragma GCC unroll 8
        for (int i = 0; i < left; i++) {
            lows[i] = pairs_min(lows[2 * i], lows[2 * i + 1]);
            highs[i] = pairs_max(highs[2 * i], highs[2 * i + 1]);
        }
    *low = lows[0], *high = highs[0];
}

#endif
