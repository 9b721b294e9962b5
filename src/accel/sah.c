#include "accel/sah.h"

enum { BINS = 16 };

struct bin {
    struct rb_box box;
    uint32_t count;
};

static float item_center(const struct rb_sah_item *item, int axis)
{
    return item->box.low[axis] + item->box.high[axis]; // twice the centre; only order matters
}

static struct rb_box centers_box(const struct rb_sah_item *items, uint32_t count)
{
    struct rb_box box = RB_BOX_EMPTY;
    for (uint32_t i = 0; i < count; i++) {
        struct rb_box point;
        for (int k = 0; k < 3; k++)
            point.low[k] = point.high[k] = item_center(&items[i], k);
        rb_box_include(&box, &point);
    }
    return box;
}

static int bin_of(const struct rb_sah_item *item, int axis, float low, float scale)
{
    int bin = (int)((item_center(item, axis) - low) * scale);
    return bin < BINS - 1 ? bin : BINS - 1;
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
    for (int axis = 0; axis < 3; axis++) {
        float low = centers.low[axis];
        float scale = (float)BINS / (centers.high[axis] - low);
        if (!(scale < FLT_MAX)) // no extent on this axis
            continue;
        struct bin bins[BINS];
        for (int i = 0; i < BINS; i++)
            bins[i] = (struct bin){RB_BOX_EMPTY, 0};
        for (uint32_t i = 0; i < count; i++) {
            struct bin *bin = &bins[bin_of(&items[i], axis, low, scale)];
            rb_box_include(&bin->box, &items[i].box);
            bin->count++;
        }
        sweep(bins, block, axis, low, scale, &best);
    }
    return best;
}

uint32_t rb_sah_partition(struct rb_sah_item *items, uint32_t count,
                          const struct rb_sah_split *split)
{
    uint32_t left = 0, right = count;
    while (left < right) {
        if (bin_of(&items[left], split->axis, split->low, split->scale) < split->bin) {
            left++;
        } else {
            struct rb_sah_item swap = items[left];
            items[left] = items[--right];
            items[right] = swap;
        }
    }
    return left;
}
