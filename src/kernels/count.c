#include "kernels/count.h"

#include <math.h>
#include <stddef.h>

const char *const rb_counter_names[RB_COUNTER_COUNT] = {
    [RB_COUNT_NODES] = "nodes",
    [RB_COUNT_BOXES] = "boxes",
    [RB_COUNT_SPHERES] = "spheres",
    [RB_COUNT_TRIANGLES] = "triangles",
    [RB_COUNT_CONES] = "cones",
    [RB_COUNT_PLANES] = "planes",
    [RB_COUNT_HITS] = "hits",
    [RB_COUNT_OCCLUDED] = "occluded",
    [RB_COUNT_STEPS] = "steps",
    [RB_COUNT_LANES_ACTIVE] = "lanes_active",
    [RB_COUNT_LANES_POSSIBLE] = "lanes_possible",
    [RB_COUNT_TREE_BYTES] = "tree_bytes",
    [RB_COUNT_PRIMITIVE_BYTES] = "primitive_bytes",
    [RB_COUNT_STACK] = "stack",
    [RB_COUNT_SHADINGS] = "shadings",
};

_Thread_local struct rb_counting rb_counting;

void rb_counts_add(struct rb_counts *to, const struct rb_counts *from)
{
    for (int i = 0; i < RB_COUNTER_COUNT; i++)
        to->of[i] += from->of[i];
    to->stack_max = to->stack_max > from->stack_max ? to->stack_max : from->stack_max;
}

bool rb_counter_is_of_rays(enum rb_counter counter)
{
    const uint32_t of_steps = 1u << RB_COUNT_STEPS | 1u << RB_COUNT_LANES_ACTIVE |
                              1u << RB_COUNT_LANES_POSSIBLE | 1u << RB_COUNT_TREE_BYTES |
                              1u << RB_COUNT_PRIMITIVE_BYTES;
    return !(of_steps >> counter & 1);
}

double rb_counts_lane_use_pct(const struct rb_counts *counts)
{
    double active = (double)counts->of[RB_COUNT_LANES_ACTIVE];
    double possible = (double)counts->of[RB_COUNT_LANES_POSSIBLE];
    return possible > 0 ? 100.0 * active / possible : (double)NAN;
}

void rb_counts_take(struct rb_counts *to)
{
    rb_counts_add(to, &rb_counting.counts);
    rb_counting.counts = (struct rb_counts){0};
}

void rb_counting_begin(uint32_t index)
{
    rb_counting.first = index;
    rb_counting.deepest = 0;
}

static uint32_t place_of(uint32_t index)
{
    return rb_counting.places ? rb_counting.places[index] : rb_counting.base + index;
}

void rb_counting_rays(enum rb_counter counter, unsigned bits, uint32_t each)
{
    rb_counting.counts.of[counter] += (uint64_t)__builtin_popcount(bits) * each;
    if (!rb_counting.cost || !(rb_counting.chosen >> counter & 1))
        return;
    for (unsigned rest = bits; rest; rest &= rest - 1) {
        uint32_t index = rb_counting.first + (uint32_t)__builtin_ctz(rest);
        rb_counting.cost[place_of(index)] += each;
    }
}

void rb_counting_step(unsigned bits, uint32_t lanes)
{
    rb_counting.counts.of[RB_COUNT_STEPS]++;
    rb_counting.counts.of[RB_COUNT_LANES_ACTIVE] += (uint64_t)__builtin_popcount(bits);
    rb_counting.counts.of[RB_COUNT_LANES_POSSIBLE] += lanes;
}

void rb_counting_depth(uint64_t depth)
{
    rb_counting.deepest = rb_counting.deepest > depth ? rb_counting.deepest : depth;
}

void rb_counting_end(unsigned bits)
{
    struct rb_counts *counts = &rb_counting.counts;
    rb_counting_rays(RB_COUNT_STACK, bits, (uint32_t)rb_counting.deepest);
    if (bits && counts->stack_max < rb_counting.deepest)
        counts->stack_max = rb_counting.deepest;
}
