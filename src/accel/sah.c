#include "accel/sah.h"

enum { BINS = 16 };

struct bin {
    struct rb_box box;
    uint32_t count;
};

typedef int32_t quad_int __attribute__((vector_size(16)));

// The bins that a centre falls into, axis by axis.
static inline quad_int bins_of(rb_quad center, rb_quad low, rb_quad scale)
{
    const rb_quad last = {BINS - 1, BINS - 1, BINS - 1, 0};
    return __builtin_convertvector(rb_quad_min((center - low) * scale, last), quad_int);
}

// The bins of all axes, whose scales are 0 where there is no extent.
static void fill(struct bin bins[3][BINS], const struct rb_sah_item *items, uint32_t count,
                 rb_quad low, rb_quad scale)
{
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < BINS; i++)
            bins[axis][i] = (struct bin){RB_BOX_EMPTY, 0};
    for (uint32_t i = 0; i < count; i++) {
        quad_int at = bins_of(rb_sah_center(&items[i]), low, scale);
#pragma GCC unroll 3
        for (int axis = 0; axis < 3; axis++) {
            struct bin *bin = &bins[axis][at[axis]];
            rb_box_include(&bin->box, &items[i].box);
            bin->count++;
        }
    }
}

// Sweeps the bins of one axis from both ends and keeps the cheapest plane in `best`.
static void sweep(const struct bin bins[BINS], uint32_t block, int axis, struct rb_sah_split *best)
{
    float right_cost[BINS];
    struct rb_box box = RB_BOX_EMPTY;
    uint32_t count = 0;
    for (int i = BINS - 1; i > 0; i--) {
        rb_box_include(&box, &bins[i].box);
        count += bins[i].count;
        right_cost[i] = count ? rb_box_half_area(&box) * rb_sah_blocks(count, block) : INFINITY;
    }
    box = RB_BOX_EMPTY;
    count = 0;
    for (int i = 1; i < BINS; i++) {
        rb_box_include(&box, &bins[i - 1].box);
        count += bins[i - 1].count;
        float cost =
            count ? rb_box_half_area(&box) * rb_sah_blocks(count, block) + right_cost[i] : INFINITY;
        if (cost < best->cost)
            best->cost = cost, best->axis = axis, best->bin = i;
    }
}

struct rb_sah_split rb_sah_find(const struct rb_sah_item *items, uint32_t count,
                                const struct rb_box *centers, uint32_t block)
{
    struct rb_sah_split best = {.cost = INFINITY};
    struct bin bins[3][BINS];
    for (int axis = 0; axis < 3; axis++) {
        float per_unit = (float)BINS / (centers->high[axis] - centers->low[axis]);
        best.scale[axis] = per_unit < FLT_MAX ? per_unit : 0.0f;
        best.low[axis] = centers->low[axis];
    }
    fill(bins, items, count, best.low, best.scale);
    for (int axis = 0; axis < 3; axis++)
        if (best.scale[axis] > 0.0f)
            sweep(bins[axis], block, axis, &best);
    best.sides[0] = best.sides[1] = RB_BOX_EMPTY;
    for (int i = 0; i < BINS; i++)
        rb_box_include(&best.sides[i >= best.bin], &bins[best.axis][i].box);
    return best;
}

// Every item is exchanged with the first one that went right: without a branch, which nobody could
// predict.
uint32_t rb_sah_partition(struct rb_sah_item *items, uint32_t count,
                          const struct rb_sah_split *split, struct rb_sah_bounds sides[2])
{
    uint32_t left = 0;
    for (int side = 0; side < 2; side++)
        sides[side] = (struct rb_sah_bounds){split->sides[side], RB_BOX_EMPTY};
    for (uint32_t i = 0; i < count; i++) {
        struct rb_sah_item item = items[i];
        rb_quad center = rb_sah_center(&item);
        bool goes_left = bins_of(center, split->low, split->scale)[split->axis] < split->bin;
        items[i] = items[left];
        items[left] = item;
        left += goes_left;
        rb_box_include_point(&sides[!goes_left].centers, center);
    }
    return left;
}
