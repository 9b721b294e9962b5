// x^n for highlights, by one shared sequence of operations instead of the C library's powf, which
// differs between libraries and has no SIMD twin.
#ifndef RB_KERNELS_POWER_H
#define RB_KERNELS_POWER_H

#include "base/vec.h"

#include <stdint.h>
#include <string.h>

// The two polynomials, for floats and for vectors of floats.
#define RB_LOG2_SERIES(z)                                                                          \
    (2.88539008f +                                                                                 \
     (z) * (0.961796694f + (z) * (0.577078016f + (z) * (0.412198583f + (z)*0.320598898f))))
#define RB_EXP2_SERIES(f)                                                                          \
    (1.0f + (f) * (0.693147181f +                                                                  \
                   (f) * (0.240226507f +                                                           \
                          (f) * (0.0555041087f +                                                   \
                                 (f) * (0.00961812911f +                                           \
                                        (f) * (0.00133335581f +                                    \
                                               (f) * (1.54035304e-4f + (f)*1.52527338e-5f)))))))

// log2 of a normal positive x. x = 2^e m with m in [sqrt(1/2), sqrt(2)); with s = (m - 1) / (m +
// 1), |s| < 0.172, log2 m = 2/ln 2 (s + s^3/3 + s^5/5 + ...). Cut after s^9 the relative error is
// 2e-9, below that of single precision.
static inline float rb_log2(float x)
{
    int32_t bits;
    memcpy(&bits, &x, sizeof bits);
    int32_t above = bits - 0x3f3504f3; // bits of sqrt(1/2)
    int32_t exponent = (above - (above & 0x7fffff)) / 0x800000;
    int32_t mantissa_bits = (above & 0x7fffff) + 0x3f3504f3;
    float m;
    memcpy(&m, &mantissa_bits, sizeof m);
    float s = (m - 1.0f) / (m + 1.0f), z = s * s;
    return (float)exponent + s * RB_LOG2_SERIES(z);
}

// 1.5 * 2^23: adding it and taking it away again rounds to an integer.
#define RB_ROUND 12582912.0f

// 2^y for y <= 0; 0 below 2^-126. y = n + f with |f| <= 1/2; 2^f by its Taylor series, whose 8th
// term is 5e-9.
static inline float rb_exp2(float y)
{
    float n = (y + RB_ROUND) - RB_ROUND, f = y - n;
    if (!(y >= -126.0f))
        return 0.0f;
    int32_t bits = ((int32_t)n + 127) * 0x800000;
    float scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale * RB_EXP2_SERIES(f);
}

// x^n for n >= 0; x is limited to [0, 1]. 0^0 is 1.
static inline float rb_power(float x, float n)
{
    if (n == 0.0f)
        return 1.0f;
    if (!(x >= FLT_MIN))
        return 0.0f;
    return rb_exp2(n * rb_log2(rb_min(x, 1.0f)));
}

#endif
