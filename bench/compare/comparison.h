// Two runs, or two variants of one, held against each other cell by cell.
#ifndef RB_COMPARE_COMPARISON_H
#define RB_COMPARE_COMPARISON_H

#include "bench/compare/timings.h"
#include "bench/data/stats.h"

struct rb_compare_side {
    const struct rb_timings *samples;
    const char *variant; // the only one that counts; NULL if all do
};

#define RB_TIME_QUANTILE 0.1

struct rb_compare_options {
    const char *scenes, *kernels; // lists (bench/data/names.h); NULL: all scenes, the usual kernels
    double level;                 // that all intervals of a family hold with
    bool bounces;                 // rows for each bounce, a family of their own
    bool paired;                  // process p of A ran beside process p of B
    double quantile;              // of the repetitions, the time of a process; 0: RB_TIME_QUANTILE
};

enum rb_verdict {
    RB_VERDICT_FASTER, // B is
    RB_VERDICT_SLOWER,
    RB_VERDICT_UNRESOLVED, // the interval spans 1
    RB_VERDICT_TOO_FEW,    // processes for an interval
};

struct rb_compare_row {
    int kernel, bounce;      // as in struct rb_timing
    size_t a_count, b_count; // processes; pairs of them, if paired
    double a_ns, b_ns;       // medians over these
    struct rb_median ratio;  // time of B over time of A
    enum rb_verdict verdict;
};

// Cells of the same key. Where the images differ, so does the work: there are no rows.
struct rb_compare_cell {
    const struct rb_timed_cell *a, *b;
    bool same_image;
    size_t first_row, row_count;
};

struct rb_compare_family {
    size_t rows;
    double level;  // of each row
    size_t needed; // processes on each side for an interval at it
};

struct rb_compare_mean {
    const struct rb_timed_cell *like; // of A: any cell of the group
    size_t scenes;
    double ratio;
};

struct rb_comparison {
    struct rb_compare_cell *cells;
    size_t cell_count;
    struct rb_compare_row *rows;
    size_t row_count;
    const struct rb_timed_cell **only[2]; // in A, in B
    size_t only_count[2];
    struct rb_compare_family kernels, bounces;
    unsigned key_skip; // columns that are not compared: the variant, if both sides name one
};

// Fails only for lack of memory. The comparison points into the samples; free it with
// rb_comparison_free in any case.
enum rb_status rb_comparison_make(const struct rb_compare_side sides[2],
                                  const struct rb_compare_options *options,
                                  struct rb_comparison *comparison, struct rb_error *error);
void rb_comparison_free(struct rb_comparison *comparison);

// The family that a row belongs to.
const struct rb_compare_family *rb_comparison_family(const struct rb_comparison *comparison,
                                                     const struct rb_compare_row *row);

// The row of the whole frame of a cell; NULL if there is none.
const struct rb_compare_row *rb_comparison_frame(const struct rb_comparison *comparison,
                                                 const struct rb_compare_cell *cell);

// Geometric means of the frame ratios over the scenes, one for each group of cells that differ in
// nothing else. `*first` is the cell to start with, 0 at first, and goes to behind the one that
// stands for the group; false when there are no more groups of two scenes and more.
bool rb_comparison_next_mean(const struct rb_comparison *comparison, size_t *first,
                             struct rb_compare_mean *mean);

#endif
