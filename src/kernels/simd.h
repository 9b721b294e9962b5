// Vectors of RB_LANES floats, for kernels that are compiled once per instruction set. Written with
// the vector extensions of gcc and clang, whose operators are the IEEE operations lane by lane;
// only what they lack is an intrinsic, with a loop where there is none.
//
// The object's -m flags decide the width: 16 lanes with AVX-512, 8 with AVX2, else 4. A width given
// as -DRB_LANES works everywhere, without intrinsics where it is not the processor's own.
#ifndef RB_KERNELS_SIMD_H
#define RB_KERNELS_SIMD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifdef __x86_64__
#include <immintrin.h>
#endif

#if defined(RB_LANES)
#elif defined(__AVX512F__)
#define RB_LANES 16
#elif defined(__AVX2__)
#define RB_LANES 8
#else
#define RB_LANES 4
#endif

typedef float vfloat __attribute__((vector_size(4 * RB_LANES)));
typedef int32_t vint __attribute__((vector_size(4 * RB_LANES))); // integers, and masks of -1 and 0
typedef uint32_t vuint __attribute__((vector_size(4 * RB_LANES))); // for arithmetic that may wrap

static inline vfloat vf_set(float x)
{
    return x - (vfloat){0}; // x - 0 is x, signed zeros included
}

static inline vint vi_set(uint32_t x)
{
    return (int32_t)x - (vint){0};
}

static inline vfloat vf_load(const float *from)
{
    vfloat v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline vint vi_load(const uint32_t *from)
{
    vint v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline void vf_store(float *to, vfloat v)
{
    memcpy(to, &v, sizeof v);
}

static inline void vi_store(uint32_t *to, vint v)
{
    memcpy(to, &v, sizeof v);
}

// One byte for each lane; values must fit.
static inline void vi_store_bytes(uint8_t *to, vint v)
{
    typedef uint8_t bytes __attribute__((vector_size(RB_LANES)));
    bytes narrow = __builtin_convertvector(v, bytes);
    memcpy(to, &narrow, sizeof narrow);
}

static inline vint vi_select(vint mask, vint a, vint b)
{
    return (mask & a) | (~mask & b);
}

static inline vfloat vf_select(vint mask, vfloat a, vfloat b)
{
    return (vfloat)vi_select(mask, (vint)a, (vint)b);
}

static inline vfloat vf_abs(vfloat a)
{
    return (vfloat)((vint)a & vi_set(0x7fffffff));
}

// As rb_min, rb_max, sqrtf: a < b ? a : b lane by lane, and the correctly rounded root. vi_bits has
// bit i set if lane i of the mask is.
#if defined(__AVX512F__) && RB_LANES == 16
static inline vfloat vf_min(vfloat a, vfloat b)
{
    return _mm512_min_ps(a, b);
}

static inline vfloat vf_max(vfloat a, vfloat b)
{
    return _mm512_max_ps(a, b);
}

static inline vfloat vf_sqrt(vfloat a)
{
    return _mm512_sqrt_ps(a);
}

static inline unsigned vi_bits(vint mask)
{
    return _mm512_cmplt_epi32_mask((__m512i)mask, _mm512_setzero_si512());
}
#elif defined(__AVX2__) && RB_LANES == 8
static inline vfloat vf_min(vfloat a, vfloat b)
{
    return _mm256_min_ps(a, b);
}

static inline vfloat vf_max(vfloat a, vfloat b)
{
    return _mm256_max_ps(a, b);
}

static inline vfloat vf_sqrt(vfloat a)
{
    return _mm256_sqrt_ps(a);
}

static inline unsigned vi_bits(vint mask)
{
    return (unsigned)_mm256_movemask_ps((vfloat)mask);
}
#elif defined(__SSE2__) && RB_LANES == 4
static inline vfloat vf_min(vfloat a, vfloat b)
{
    return _mm_min_ps(a, b);
}

static inline vfloat vf_max(vfloat a, vfloat b)
{
    return _mm_max_ps(a, b);
}

static inline vfloat vf_sqrt(vfloat a)
{
    return _mm_sqrt_ps(a);
}

static inline unsigned vi_bits(vint mask)
{
    return (unsigned)_mm_movemask_ps((vfloat)mask);
}
#else
static inline vfloat vf_min(vfloat a, vfloat b)
{
    return vf_select(a < b, a, b);
}

static inline vfloat vf_max(vfloat a, vfloat b)
{
    return vf_select(a > b, a, b);
}

static inline vfloat vf_sqrt(vfloat a)
{
    for (int i = 0; i < RB_LANES; i++)
        a[i] = sqrtf(a[i]);
    return a;
}

static inline unsigned vi_bits(vint mask)
{
    unsigned bits = 0;
    for (int i = 0; i < RB_LANES; i++)
        bits |= (mask[i] ? 1u : 0u) << i;
    return bits;
}
#endif

#define VI_ALL_BITS ((1u << RB_LANES) - 1)

// The even and the odd lanes of two vectors, one behind the other: 0, 2, ... of a, then of b.
#if RB_LANES == 16
#define VF_EVEN(a, b)                                                                              \
    __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30)
#define VF_ODD(a, b)                                                                               \
    __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31)
#elif RB_LANES == 8
#define VF_EVEN(a, b) __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14)
#define VF_ODD(a, b)  __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15)
#else
#define VF_EVEN(a, b) __builtin_shufflevector(a, b, 0, 2, 4, 6)
#define VF_ODD(a, b)  __builtin_shufflevector(a, b, 1, 3, 5, 7)
#endif

static inline int vi_any(vint mask)
{
    return vi_bits(mask) != 0;
}

// 0, 1, 2, ...
static inline vint vi_lanes(void)
{
    vint lanes;
    for (int i = 0; i < RB_LANES; i++)
        lanes[i] = i;
    return lanes;
}

// The first `count` lanes.
static inline vint vi_first(uint32_t count)
{
    return vi_lanes() < vi_set(count < RB_LANES ? count : RB_LANES);
}

// The least, the largest lane, in all lanes.
static inline vfloat vf_min_lane(vfloat v)
{
#pragma GCC unroll 4
    for (int lanes = RB_LANES; lanes > 1; lanes /= 2)
        v = vf_min(VF_EVEN(v, v), VF_ODD(v, v));
    return v;
}

static inline vfloat vf_max_lane(vfloat v)
{
#pragma GCC unroll 4
    for (int lanes = RB_LANES; lanes > 1; lanes /= 2)
        v = vf_max(VF_EVEN(v, v), VF_ODD(v, v));
    return v;
}

// Stores the lanes of `bits` one behind the other; what it writes behind them, up to RB_LANES in
// all, means nothing. Returns how many they are.
static inline unsigned vi_pack(uint32_t *to, vint v, unsigned bits)
{
#if defined(__AVX2__) && defined(__BMI2__) && RB_LANES == 8
    uint64_t bytes = _pdep_u64(bits, 0x0101010101010101u) * 0xff;
    long long from = (long long)_pext_u64(0x0706050403020100u, bytes);
    __m256i lanes = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(from));
    vi_store(to, (vint)_mm256_permutevar8x32_epi32((__m256i)v, lanes));
    return (unsigned)__builtin_popcount(bits);
#else
    unsigned count = 0;
    for (int lane = 0; lane < RB_LANES; lane++) {
        to[count] = (uint32_t)v[lane];
        count += bits >> lane & 1;
    }
    return count;
#endif
}

// 8 floats, or as many as a vector holds if it is shorter; the lanes beyond them mean nothing.
static inline vfloat vf_load8(const float *from)
{
#if defined(__AVX512F__) && RB_LANES == 16
    return _mm512_castps256_ps512(_mm256_loadu_ps(from));
#else
    vfloat v = {0};
    memcpy(&v, from, RB_LANES < 8 ? sizeof v : 8 * sizeof *from);
    return v;
#endif
}

static inline void vf_store8(float *to, vfloat v)
{
#if defined(__AVX512F__) && RB_LANES == 16
    _mm256_storeu_ps(to, _mm512_castps512_ps256(v));
#else
    memcpy(to, &v, RB_LANES < 8 ? sizeof v : 8 * sizeof *to);
#endif
}

// Three-vectors, as base/vec.h.
struct vvec {
    vfloat x, y, z;
};

static inline struct vvec vv_set(const float a[3])
{
    return (struct vvec){vf_set(a[0]), vf_set(a[1]), vf_set(a[2])};
}

static inline struct vvec vv_sub(struct vvec a, struct vvec b)
{
    return (struct vvec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vvec vv_mad(struct vvec a, vfloat s, struct vvec b)
{
    return (struct vvec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline struct vvec vv_select(vint mask, struct vvec a, struct vvec b)
{
    return (struct vvec){vf_select(mask, a.x, b.x), vf_select(mask, a.y, b.y),
                         vf_select(mask, a.z, b.z)};
}

static inline vfloat vv_dot(struct vvec a, struct vvec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vvec vv_cross(struct vvec a, struct vvec b)
{
    return (struct vvec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline vfloat vv_reach(struct vvec a)
{
    return vf_max(vf_abs(a.x), vf_max(vf_abs(a.y), vf_abs(a.z)));
}

static inline vint vv_finite(struct vvec a)
{
    return a.x * 0.0f + a.y * 0.0f + a.z * 0.0f == 0.0f;
}

#endif
