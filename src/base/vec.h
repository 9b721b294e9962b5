// Three-vectors in single precision. The order of operations in every function is normative: SIMD
// kernels repeat it, so that all variants agree bit for bit. Never reassociate.
#ifndef RB_BASE_VEC_H
#define RB_BASE_VEC_H

#include <float.h>
#include <math.h>

#ifdef __FAST_MATH__
#error "-ffast-math reorders operations: results would differ between variants"
#endif
_Static_assert(FLT_EVAL_METHOD == 0, "exactness needs float arithmetic in float precision");

struct rb_vec {
    float x, y, z;
};

// Minimum and maximum as the SSE instructions define them: the second operand unless a wins
// strictly. They differ from fminf in what they do to NaN and to signed zeros.
static inline float rb_min(float a, float b)
{
    return a < b ? a : b;
}

static inline float rb_max(float a, float b)
{
    return a > b ? a : b;
}

static inline struct rb_vec rb_vec_of(const float a[3])
{
    return (struct rb_vec){a[0], a[1], a[2]};
}

static inline struct rb_vec rb_vec_add(struct rb_vec a, struct rb_vec b)
{
    return (struct rb_vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct rb_vec rb_vec_sub(struct rb_vec a, struct rb_vec b)
{
    return (struct rb_vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct rb_vec rb_vec_scale(struct rb_vec a, float s)
{
    return (struct rb_vec){a.x * s, a.y * s, a.z * s};
}

// a + s b
static inline struct rb_vec rb_vec_mad(struct rb_vec a, float s, struct rb_vec b)
{
    return (struct rb_vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline struct rb_vec rb_vec_neg(struct rb_vec a)
{
    return (struct rb_vec){-a.x, -a.y, -a.z};
}

static inline float rb_dot(struct rb_vec a, struct rb_vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct rb_vec rb_cross(struct rb_vec a, struct rb_vec b)
{
    return (struct rb_vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Unit vector by a true square root and a true division; not finite for a zero vector.
static inline struct rb_vec rb_normalize(struct rb_vec a)
{
    return rb_vec_scale(a, 1.0f / sqrtf(rb_dot(a, a)));
}

// Largest absolute coordinate.
static inline float rb_vec_reach(struct rb_vec a)
{
    return rb_max(fabsf(a.x), rb_max(fabsf(a.y), fabsf(a.z)));
}

static inline int rb_vec_finite(struct rb_vec a)
{
    // x * 0 is 0 exactly when x is finite.
    return a.x * 0.0f + a.y * 0.0f + a.z * 0.0f == 0.0f;
}

#endif
