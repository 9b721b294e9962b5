// What the packet kernels that do not trace have in common: gathering from arrays of structures and
// appending to queues. The packet_*.h are included by the files that are compiled once per
// instruction set; their scalar twins in scalar.c and shade.h are the norm, and every operation has
// its counterpart there.
#ifndef RB_KERNELS_PACKET_LANES_H
#define RB_KERNELS_PACKET_LANES_H

#include "kernels/shade.h"
#include "kernels/simd.h"

// A 4-byte member array of a queue and the values to append to it.
struct column {
    void *array;
    vint lanes;
};

#define FLOATS(array, lanes)                                                                       \
    {                                                                                              \
        (array), (vint)(lanes)                                                                     \
    }
#define WORDS(array, lanes)                                                                        \
    {                                                                                              \
        (array), (lanes)                                                                           \
    }

// Appends the lanes of `bits` behind `count` elements, in order: whole vectors where all lanes take
// part, else one by one, so that nothing is written behind the last element.
static inline void append(const struct column *columns, size_t column_count, uint32_t count,
                          unsigned bits)
{
    for (size_t c = 0; c < column_count; c++) {
        char *to = (char *)columns[c].array + 4 * (size_t)count;
        vint lanes = columns[c].lanes;
        if (bits == VI_ALL_BITS) {
            memcpy(to, &lanes, sizeof lanes);
            continue;
        }
        uint32_t values[RB_LANES];
        vi_store(values, lanes);
        for (unsigned rest = bits; rest; rest &= rest - 1, to += 4)
            memcpy(to, &values[__builtin_ctz(rest)], 4);
    }
}

#define APPEND(columns, count, bits)                                                               \
    append((columns), sizeof(columns) / sizeof *(columns), (count), (bits))

static inline struct vvec vv_normalize(struct vvec a)
{
    vfloat scale = 1.0f / vf_sqrt(vv_dot(a, a));
    return (struct vvec){a.x * scale, a.y * scale, a.z * scale};
}

// rb_turned
static inline struct vvec vv_turned(struct vvec n, struct vvec d)
{
    return vv_select(vv_dot(n, d) > 0.0f, (struct vvec){-n.x, -n.y, -n.z}, n);
}

// Loads the float index[lane] * stride bytes behind `first` where the mask is set, that at `first`
// elsewhere: memory that may be read whenever any lane is wanted, and no branches.
static inline vfloat gather(const void *first, size_t stride, vint index, vint mask)
{
    uint32_t from[RB_LANES];
    float gathered[RB_LANES];
    vi_store(from, index & mask);
    for (int lane = 0; lane < RB_LANES; lane++)
        memcpy(&gathered[lane], (const char *)first + from[lane] * stride, sizeof *gathered);
    return vf_load(gathered);
}

// Of an array of structs of floats, a member written as after an element: ".radius", "[0]".
#define GATHER(array, index, mask, member) gather(&(array)[0] member, sizeof *(array), index, mask)

#define GATHER_VECTOR(array, index, mask, member)                                                  \
    ((struct vvec){GATHER(array, index, mask, member[0]), GATHER(array, index, mask, member[1]),   \
                   GATHER(array, index, mask, member[2])})

static inline struct rb_vec lane_vec(struct vvec a, int lane)
{
    return (struct rb_vec){a.x[lane], a.y[lane], a.z[lane]};
}

static inline void set_lane(struct vvec *a, int lane, struct rb_vec value)
{
    a->x[lane] = value.x, a->y[lane] = value.y, a->z[lane] = value.z;
}

#endif
