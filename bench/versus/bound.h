// The least time that a ray may take, of the tests it cannot do without at what the processor's
// vector pipes get through.
#ifndef RB_VERSUS_BOUND_H
#define RB_VERSUS_BOUND_H

#include "kernels/count.h"

// Tests of a ray, on average; NaN where they were not counted. Nodes and blocks are those of eight
// boxes or primitives.
struct rb_versus_tests {
    double nodes, spheres, triangles, planes;
};

extern const struct rb_versus_tests rb_versus_untested;

// From what kernels of one ray at a time count in the wide tree (kernels/wide.c).
struct rb_versus_tests rb_versus_tests_of(const struct rb_counts *counts, uint64_t rays);

// Cycles that these take at least.
double rb_versus_least_cycles(const struct rb_versus_tests *tests);

#endif
