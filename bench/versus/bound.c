// A test takes no less than its operations need of the vector pipes, were every latency hidden,
// every branch foreseen and all data at hand. Measured on a Zen 4, AVX2, throughput of independent
// instructions of 8 floats (loops of 16 of each kind): add, subtract, min, max and compare share
// two pipes (1.99 a cycle, any two kinds together too); multiply has two others (1.99; with add
// 3.97); bitwise operations take any of the four (3.9); divide 0.33. FMA would do the work of two,
// but is not exact here.
//
// Operations of the tests of kernels/wide_ray.h, 8 lanes at once, without those that only a hit
// needs and without what could be stored with the tree, edges of triangles, squares of radii:
//
//                          added  multiplied  bitwise  divided
//     node, 8 boxes           13           7        0        0   6 - 3 max 3 min 1 <=; 6 x 1 scale
//     block of 8 spheres      12           9        1        0   3 - 2 + 3 + 2 + 1 - 1 >=
//     block of 8 triangles    23          23       11        0   9 - 2 max 8 + 4 >=; 2 cross, 3 dot
//     plane, for 8 rays        7           6        0        1   4 + 1 - 2 <
//
// Cycles: the most of added / 2, multiplied / 2, all of these / 4 and divided / 0.33. Loads of node
// and block (2 a cycle) are hidden behind them.
//
// Nodes and blocks are those of one ray at a time, visited in the order of distance. A row that
// tests many rays at once against a node can get below that, and nothing else can.
#include "bench/versus/bound.h"

#include <math.h>

static const double NODE = 6.5, SPHERES = 6.0, TRIANGLES = 14.25, PLANE = 3.5 / 8;

const struct rb_versus_tests rb_versus_untested = {(double)NAN, (double)NAN, (double)NAN,
                                                   (double)NAN};

// A step is a node, a block, a plane; or a cone, of which the scenes for speed have none.
struct rb_versus_tests rb_versus_tests_of(const struct rb_counts *counts, uint64_t rays)
{
    double each = 1.0 / (double)rays;
    double nodes = (double)counts->of[RB_COUNT_NODES] * each;
    double planes = (double)counts->of[RB_COUNT_PLANES] * each;
    double spheres = (double)counts->of[RB_COUNT_SPHERES];
    double primitives = spheres + (double)counts->of[RB_COUNT_TRIANGLES];
    double blocks = (double)counts->of[RB_COUNT_STEPS] * each - nodes - planes;
    double share = primitives > 0 ? spheres / primitives : 0;
    return (struct rb_versus_tests){nodes, blocks * share, blocks * (1 - share), planes};
}

double rb_versus_least_cycles(const struct rb_versus_tests *tests)
{
    return tests->nodes * NODE + tests->spheres * SPHERES + tests->triangles * TRIANGLES +
           tests->planes * PLANE;
}
