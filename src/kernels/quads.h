// Between structures of four floats and vectors of their members: a 4 x 4 transpose for every
// quarter of the lanes.
#ifndef RB_KERNELS_QUADS_H
#define RB_KERNELS_QUADS_H

#include "kernels/simd.h"

#include <stddef.h>

typedef float vquad __attribute__((vector_size(16)));

// Of each four lanes of two vectors those of the indices: 0 to 3 are a's, 4 to 7 b's.
#define VF_QUAD_AT(i, quad) ((i) % 4 + (i) / 4 * RB_LANES + 4 * (quad))
#define VF_QUAD(i, j, k, l, q)                                                                     \
    VF_QUAD_AT(i, q), VF_QUAD_AT(j, q), VF_QUAD_AT(k, q), VF_QUAD_AT(l, q)
#if RB_LANES == 4
#define VF_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, VF_QUAD(i, j, k, l, 0))
#elif RB_LANES == 8
#define VF_SHUFFLE(a, b, i, j, k, l)                                                               \
    __builtin_shufflevector(a, b, VF_QUAD(i, j, k, l, 0), VF_QUAD(i, j, k, l, 1))
#else
#define VF_SHUFFLE(a, b, i, j, k, l)                                                               \
    __builtin_shufflevector(a, b, VF_QUAD(i, j, k, l, 0), VF_QUAD(i, j, k, l, 1),                  \
                            VF_QUAD(i, j, k, l, 2), VF_QUAD(i, j, k, l, 3))
#endif

struct vquads {
    vfloat a, b, c, d;
};

static inline struct vquads vq_transpose(struct vquads q)
{
    vfloat ab_low = VF_SHUFFLE(q.a, q.b, 0, 4, 1, 5), cd_low = VF_SHUFFLE(q.c, q.d, 0, 4, 1, 5);
    vfloat ab_high = VF_SHUFFLE(q.a, q.b, 2, 6, 3, 7), cd_high = VF_SHUFFLE(q.c, q.d, 2, 6, 3, 7);
    return (struct vquads){
        VF_SHUFFLE(ab_low, cd_low, 0, 1, 4, 5), VF_SHUFFLE(ab_low, cd_low, 2, 3, 6, 7),
        VF_SHUFFLE(ab_high, cd_high, 0, 1, 4, 5), VF_SHUFFLE(ab_high, cd_high, 2, 3, 6, 7)};
}

// Every fourth structure from `index` on, side by side.
static inline vfloat vq_rows(const float *from, size_t stride, const uint32_t *index)
{
    vquad row[RB_LANES / 4];
    for (int quad = 0; quad < RB_LANES / 4; quad++)
        memcpy(&row[quad], from + index[4 * quad] * stride, sizeof *row);
#if RB_LANES == 8
    return __builtin_shufflevector(row[0], row[1], 0, 1, 2, 3, 4, 5, 6, 7);
#else
    vfloat rows;
    memcpy(&rows, row, sizeof rows);
    return rows;
#endif
}

// Lane i of the members: those of the four floats at from + index[i] * stride.
static inline struct vquads vq_load(const float *from, size_t stride, const uint32_t *index)
{
    return vq_transpose(
        (struct vquads){vq_rows(from, stride, index), vq_rows(from, stride, index + 1),
                        vq_rows(from, stride, index + 2), vq_rows(from, stride, index + 3)});
}

// To to + i * stride for lane i.
static inline void vq_store(float *to, size_t stride, struct vquads q)
{
    q = vq_transpose(q);
    for (size_t lane = 0; lane < RB_LANES; lane += 4) {
        float *at = to + lane * stride;
        memcpy(at, (char *)&q.a + 4 * lane, sizeof(vquad));
        memcpy(at + stride, (char *)&q.b + 4 * lane, sizeof(vquad));
        memcpy(at + 2 * stride, (char *)&q.c + 4 * lane, sizeof(vquad));
        memcpy(at + 3 * stride, (char *)&q.d + 4 * lane, sizeof(vquad));
    }
}

#endif
