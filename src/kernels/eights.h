// Vectors of BOXES floats, 8 or the fewer that a register holds: what lies side by side in nodes
// and blocks of the wide tree. With AVX-512 they are half a register, and cost half as much.
#ifndef RB_KERNELS_EIGHTS_H
#define RB_KERNELS_EIGHTS_H

#include "accel/wide.h"
#include "kernels/simd.h"

enum { BOXES = RB_LANES < RB_WIDE ? RB_LANES : RB_WIDE };

#if defined(__AVX512F__) && RB_LANES == 16
typedef float v8float __attribute__((vector_size(32)));
typedef int32_t v8int __attribute__((vector_size(32)));

static inline v8float v8_min(v8float a, v8float b)
{
    return _mm256_min_ps(a, b);
}

static inline v8float v8_max(v8float a, v8float b)
{
    return _mm256_max_ps(a, b);
}

static inline unsigned v8_bits(v8int mask)
{
    return (unsigned)_mm256_movemask_ps((v8float)mask);
}
#elif RB_LANES <= 8
typedef vfloat v8float;
typedef vint v8int;

static inline v8float v8_min(v8float a, v8float b)
{
    return vf_min(a, b);
}

static inline v8float v8_max(v8float a, v8float b)
{
    return vf_max(a, b);
}

static inline unsigned v8_bits(v8int mask)
{
    return vi_bits(mask);
}
#else
typedef float v8float __attribute__((vector_size(32)));
typedef int32_t v8int __attribute__((vector_size(32)));

static inline v8float v8_select(v8int mask, v8float a, v8float b);

static inline v8float v8_min(v8float a, v8float b)
{
    return v8_select(a < b, a, b);
}

static inline v8float v8_max(v8float a, v8float b)
{
    return v8_select(a > b, a, b);
}

static inline unsigned v8_bits(v8int mask)
{
    unsigned bits = 0;
    for (int i = 0; i < BOXES; i++)
        bits |= (mask[i] ? 1u : 0u) << i;
    return bits;
}
#endif

static inline v8float v8_select(v8int mask, v8float a, v8float b)
{
    return (v8float)((mask & (v8int)a) | (~mask & (v8int)b));
}

static inline v8float v8_set(float x)
{
    return x - (v8float){0};
}

static inline v8float v8_abs(v8float a)
{
    return (v8float)((v8int)a & 0x7fffffff);
}

static inline v8float v8_load(const float *from)
{
    v8float v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline void v8_store(float *to, v8float v)
{
    memcpy(to, &v, sizeof v);
}

// The primitives there are in part of a block, one bit each.
static inline unsigned v8_present(const uint32_t *ids)
{
    v8int v;
    memcpy(&v, ids, sizeof v);
    return v8_bits(v != (int32_t)RB_NONE);
}

struct v8vec {
    v8float x, y, z;
};

static inline struct v8vec v8_vec(const float of[3][RB_WIDE], int lane)
{
    return (struct v8vec){v8_load(of[0] + lane), v8_load(of[1] + lane), v8_load(of[2] + lane)};
}

static inline void v8_vec_store(float to[3][RB_WIDE], int lane, struct v8vec v)
{
    v8_store(to[0] + lane, v.x), v8_store(to[1] + lane, v.y), v8_store(to[2] + lane, v.z);
}

static inline struct v8vec v8_vec_set(const float a[3])
{
    return (struct v8vec){v8_set(a[0]), v8_set(a[1]), v8_set(a[2])};
}

static inline struct v8vec v8_sub(struct v8vec a, struct v8vec b)
{
    return (struct v8vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline v8float v8_dot(struct v8vec a, struct v8vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct v8vec v8_cross(struct v8vec a, struct v8vec b)
{
    return (struct v8vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline struct v8vec v8_vec_min(struct v8vec a, struct v8vec b)
{
    return (struct v8vec){v8_min(a.x, b.x), v8_min(a.y, b.y), v8_min(a.z, b.z)};
}

static inline struct v8vec v8_vec_max(struct v8vec a, struct v8vec b)
{
    return (struct v8vec){v8_max(a.x, b.x), v8_max(a.y, b.y), v8_max(a.z, b.z)};
}

static inline v8float v8_reach(struct v8vec a)
{
    return v8_max(v8_abs(a.x), v8_max(v8_abs(a.y), v8_abs(a.z)));
}

#endif
