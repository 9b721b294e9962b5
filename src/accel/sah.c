#include "accel/sah.h"

enum { BINS = 16 };

struct bin {
    struct rb_box box;
    uint32_t count;
};

// Twice the centre; only order matters.
static inline rb_quad item_center(const struct rb_sah_item *item)
{
    return item->box.low + item->box.high;
}

static struct rb_box centers_box(const struct rb_sah_item *items, uint32_t count)
{
    struct rb_box box = RB_BOX_EMPTY;
    for (uint32_t i = 0; i < count; i++) {
        rb_quad center = item_center(&items[i]);
        rb_box_include(&box, &(struct rb_box){center, center});
    }
    return box;
}

static inline int bin_clamp(float bin)
{
    return (int)bin < BINS - 1 ? (int)bin : BINS - 1;
}

// The bins of all axes, whose scales are 0 where there is no extent.
static void fill(struct bin bins[3][BINS], const struct rb_sah_item *items, uint32_t count,
                 rb_quad low, rb_quad scale)
{
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < BINS; i++)
            bins[axis][i] = (struct bin){RB_BOX_EMPTY, 0};
    for (uint32_t i = 0; i < count; i++) {
        rb_quad at = (item_center(&items[i]) - low) * scale;
        for (int axis = 0; axis < 3; axis++) {
            struct bin *bin = &bins[axis][bin_clamp(at[axis])];
            rb_box_include(&bin->box, &items[i].box);
            bin->count++;
        }
    }
}

// Sweeps the bins of one axis from both ends and keeps the cheapest plane in `best`.
static void sweep(const struct bin bins[BINS], uint32_t block, int axis, float low, float scale,
                  struct rb_sah_split *best)
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
            *best = (struct rb_sah_split){cost, low, scale, axis, i};
    }
}

struct rb_sah_split rb_sah_find(const struct rb_sah_item *items, uint32_t count, uint32_t block)
{
    struct rb_sah_split best = {.cost = INFINITY};
    struct rb_box centers = centers_box(items, count);
    struct bin bins[3][BINS];
    rb_quad scale = {0};
    for (int axis = 0; axis < 3; axis++) {
        float per_unit = (float)BINS / (centers.high[axis] - centers.low[axis]);
        scale[axis] = per_unit < FLT_MAX ? per_unit : 0.0f;
    }
    fill(bins, items, count, centers.low, scale);
    for (int axis = 0; axis < 3; axis++)
        if (scale[axis] > 0.0f)
            sweep(bins[axis], block, axis, centers.low[axis], scale[axis], &best);
    return best;
}

static int bin_of(const struct rb_sah_item *item, const struct rb_sah_split *split)
{
    float center = item->box.low[split->axis] + item->box.high[split->axis];
    return bin_clamp((center - split->low) * split->scale);
}

uint32_t rb_sah_partition(struct rb_sah_item *items, uint32_t count,
                          const struct rb_sah_split *split)
{
    uint32_t left = 0, right = count;
    while (left < right) {
        if (bin_of(&items[left], split) < split->bin) {
            left++;
        } else {
            struct rb_sah_item swap = items[left];
            items[left] = items[--right];
            items[right] = swap;
        }
    }
    return left;
}
