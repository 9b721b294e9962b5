// The surface area heuristic by binning (Wald 2007): where to split a set of boxes in two so that
// the expected cost of a ray, area times primitives on both sides, is least; or, where primitives
// are tested in blocks, area times blocks. Depends on the set and its order alone.
#ifndef RB_ACCEL_SAH_H
#define RB_ACCEL_SAH_H

#include "base/vec.h"

#include <stdint.h>

struct rb_box {
    float low[3], high[3];
};

#define RB_BOX_EMPTY                                                                               \
    ((struct rb_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}})

// A primitive as the builder moves it about.
struct rb_sah_item {
    struct rb_box box;
    uint32_t id;
};

struct rb_sah_split {
    float cost; // of both sides, half area times blocks; infinite if no plane separates them
    float low, scale;
    int axis, bin; // items of bins < bin go left
};

static inline void rb_box_include(struct rb_box *box, const struct rb_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->low[k] = rb_min(box->low[k], other->low[k]);
        box->high[k] = rb_max(box->high[k], other->high[k]);
    }
}

static inline float rb_box_half_area(const struct rb_box *box)
{
    float x = box->high[0] - box->low[0], y = box->high[1] - box->low[1];
    float z = box->high[2] - box->low[2];
    return x * y + y * z + z * x;
}

// Blocks of `block` that `count` primitives fill.
static inline float rb_sah_blocks(uint32_t count, uint32_t block)
{
    return (float)((count + block - 1) / block);
}

// The cheapest of the planes between bins, on all three axes.
struct rb_sah_split rb_sah_find(const struct rb_sah_item *items, uint32_t count, uint32_t block);

// Moves the items left of the split to the front; returns how many there are, at least one and
// fewer than `count` if the cost of the split is finite.
uint32_t rb_sah_partition(struct rb_sah_item *items, uint32_t count,
                          const struct rb_sah_split *split);

#endif
