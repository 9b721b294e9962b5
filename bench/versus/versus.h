// Our rows against Embree, on the same recorded rays.
#ifndef RB_VERSUS_VERSUS_H
#define RB_VERSUS_VERSUS_H

#include "bench/replay/record_file.h"
#include "bench/run/cell.h"
#include "bench/versus/bound.h"
#include "cli/options.h"

#include <stdio.h>

extern const struct rb_command rb_command_versus;

// The classes of rays that are compared.
enum { RB_VERSUS_CLASS_COUNT = 5 };
struct rb_versus_class {
    const char *name;
    struct rb_record_choice rays;
};
extern const struct rb_versus_class rb_versus_classes[RB_VERSUS_CLASS_COUNT];

// One of the two rows of a contest, and what its processes need.
struct rb_versus_side {
    const struct rb_variant *row; // NULL: none has answered yet
    double round_s;               // to go over all rays once
    double load_s;                // from the start of a process to its first ray
    struct rb_cell cell;
};

// Our wide tree over a scene and Embree's of medium quality, [0] and [1] as everywhere.
struct rb_versus_trees {
    int threads;
    double build_ns[2];     // medians
    struct rb_median ratio; // of Embree's time to ours, from pairs
    size_t bytes[2];
    double huge_pct[2]; // of the memory while the tree stands, rb_versus_huge_pct
};

// Builds both in turn (trees.c). RB_FAILED without memory.
enum rb_status rb_versus_build(const struct rb_scene *scene, int threads,
                               struct rb_versus_trees *trees, struct rb_error *error);

// Rays of a scene, and the best row of either side for them: [0] ours, [1] Embree's.
struct rb_contest {
    const char *scene, *rays_name;
    const struct rb_versus_class *rays;
    uint32_t primitive_count;
    uint64_t ray_count;
    int threads;                         // that share the rays
    const struct rb_contest *single;     // the same by one thread; NULL: this is it
    const struct rb_versus_trees *trees; // by as many threads
    struct rb_versus_tests tests;        // by one ray at a time, on a sample
    struct rb_versus_side side[2];
};

// Finds the best rows for the contests of a scene, one for each class and one thread, whose rays
// are in the record `path`: every row on the same random batches, the fastest of some runs
// (choose.c); and counts tests. `load_s` is what loading the scene has taken. RB_FAILED without
// memory.
enum rb_status rb_versus_choose(const char *path, const struct rb_scene *scene, double load_s,
                                struct rb_contest contests[RB_VERSUS_CLASS_COUNT],
                                struct rb_error *error);

// The name of Embree's mode in a contest, without the name of Embree.
const char *rb_versus_mode(const struct rb_contest *contest);

// Both print contests that have times: a table with the losing ones first, and a CSV file
// (results/README.md).
void rb_versus_print(const struct rb_contest *contests, size_t count);
void rb_versus_write(FILE *out, const struct rb_contest *contests, size_t count);

#endif
