// THE table: every way to render, one row each. Tests, benchmarks and listings loop over it.
//
// Kernels, accelerator and schedule are independent columns. A row differs from its baseline by one
// idea, so the table is the ladder from the reference to the fastest. Rows stand in order of speed:
// the last available one is the default of `raybench render`.
#ifndef RB_RENDER_VARIANTS_H
#define RB_RENDER_VARIANTS_H

#include "kernels/kernel.h"

#include <stdbool.h>

struct rb_embree_tree;
struct rb_frame;
struct rb_worker;

// Shares the tiles of a frame among `count` workers.
typedef void rb_schedule_fn(struct rb_frame *frame, struct rb_worker *workers, int count);

rb_schedule_fn rb_schedule_serial;
rb_schedule_fn rb_schedule_openmp; // serial where the compiler has no OpenMP; the rows say so

enum rb_accelerator { RB_ACCEL_NONE, RB_ACCEL_BVH, RB_ACCEL_WIDE, RB_ACCEL_EMBREE };

#define RB_EMBREE_NEEDS "libembree"

struct rb_variant {
    const char *name;     // ends the table if NULL
    const char *summary;  // one line
    const char *baseline; // row that this one is compared with; its own name for the reference
    const struct rb_kernels *kernels; // NULL if not part of a build for this processor
    enum rb_accelerator accelerator;
    rb_schedule_fn *schedule;
    const char *needs; // what machine and build must have: "", or a list: "avx2,OpenMP", "packet-*"
    bool exact;        // agrees with the reference bit for bit
    // Not NULL: the row stands for the last available row with such a name ("packet-*") and the
    // same schedule; kernels is NULL then.
    const char *best_of;
    const struct rb_kernels
        *counted; // the twin of `kernels` that counts (kernels/count.h), or NULL
    const struct rb_embree_tree *embree; // how Embree builds its tree (embree/embree.h)
};

extern const struct rb_variant rb_variants[];

// Also finds what embree_rows.h has. NULL if there is none.
const struct rb_variant *rb_variant_find(const char *name);
bool rb_variant_available(const struct rb_variant *variant);

// The row that a row stands for: itself, or the best of several. NULL if none of them is available.
const struct rb_variant *rb_variant_resolve(const struct rb_variant *variant);
bool rb_variant_parallel(const struct rb_variant *variant);
const struct rb_variant *rb_variant_fastest(void); // of the exact ones

// Threads a parallel row uses when nobody says: as OMP_NUM_THREADS, affinity and limits have it.
int rb_threads_default(void);

#endif
