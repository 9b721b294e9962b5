// The surface area heuristic by binning (Wald 2007): where to split a set of boxes in two so that
// the expected cost of a ray, area times primitives on both sides, is least; or, where primitives
// are tested in blocks, area times blocks. Depends on the set and its order alone.
#ifndef RB_ACCEL_SAH_H
#define RB_ACCEL_SAH_H

#include "base/vec.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __SSE2__
#include <immintrin.h>
#endif

// Three coordinates and one lane that means nothing, in a vector register.
typedef float rb_quad __attribute__((vector_size(16)));

struct rb_box {
    rb_quad low, high;
};

#define RB_BOX_EMPTY                                                                               \
    ((struct rb_box){{INFINITY, INFINITY, INFINITY, INFINITY},                                     \
                     {-INFINITY, -INFINITY, -INFINITY, -INFINITY}})

// A primitive as the builder moves it about: its box, whose fourth lanes hold its id.
struct rb_sah_item {
    struct rb_box box;
};

struct rb_sah_split {
    float cost; // of both sides, half area times blocks; infinite if no plane separates them, and
                // nothing else is known then
    rb_quad low, scale; // of the bins
    int axis, bin;      // items of bins < bin of the axis go left
    struct rb_box sides[2];
};

// rb_min, rb_max, lane by lane.
static inline rb_quad rb_quad_min(rb_quad a, rb_quad b)
{
#ifdef __SSE2__
    return _mm_min_ps(a, b);
#else
    return (rb_quad){rb_min(a[0], b[0]), rb_min(a[1], b[1]), rb_min(a[2], b[2]), 0.0f};
#endif
}

static inline rb_quad rb_quad_max(rb_quad a, rb_quad b)
{
#ifdef __SSE2__
    return _mm_max_ps(a, b);
#else
    return (rb_quad){rb_max(a[0], b[0]), rb_max(a[1], b[1]), rb_max(a[2], b[2]), 0.0f};
#endif
}

static inline void rb_box_include(struct rb_box *box, const struct rb_box *other)
{
    box->low = rb_quad_min(box->low, other->low);
    box->high = rb_quad_max(box->high, other->high);
}

static inline struct rb_sah_item rb_sah_item_make(const float low[3], const float high[3],
                                                  uint32_t id)
{
    // As integers below 2^16 they are no denormal floats, which some processors add slowly.
    float halves[2] = {(float)(id >> 16), (float)(id & 0xffff)};
    return (struct rb_sah_item){
        {{low[0], low[1], low[2], halves[0]}, {high[0], high[1], high[2], halves[1]}}};
}

static inline uint32_t rb_sah_item_id(const struct rb_sah_item *item)
{
    return (uint32_t)item->box.low[3] << 16 | (uint32_t)item->box.high[3];
}

static inline float rb_box_half_area(const struct rb_box *box)
{
    rb_quad edge = box->high - box->low;
    return edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0];
}

// Blocks of `block` that `count` primitives fill.
static inline float rb_sah_blocks(uint32_t count, uint32_t block)
{
    return (float)((count + block - 1) / block);
}

// What a set of items lies in: their boxes, and twice the centres of these; only order matters.
struct rb_sah_bounds {
    struct rb_box box, centers;
};

#define RB_SAH_BOUNDS_EMPTY ((struct rb_sah_bounds){RB_BOX_EMPTY, RB_BOX_EMPTY})

static inline rb_quad rb_sah_center(const struct rb_sah_item *item)
{
    return item->box.low + item->box.high;
}

static inline void rb_box_include_point(struct rb_box *box, rb_quad point)
{
    rb_box_include(box, &(struct rb_box){point, point});
}

// The cheapest of the planes between bins, on all three axes, of items with these centres.
struct rb_sah_split rb_sah_find(const struct rb_sah_item *items, uint32_t count,
                                const struct rb_box *centers, uint32_t block);

// Moves the items left of the split to the front; returns how many there are, at least one and
// fewer than `count` if the cost of the split is finite. Tells the bounds of both sides.
uint32_t rb_sah_partition(struct rb_sah_item *items, uint32_t count,
                          const struct rb_sah_split *split, struct rb_sah_bounds sides[2]);

#endif
