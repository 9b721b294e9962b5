// What `raybench compare` says, for a person and for a program.
#ifndef RB_COMPARE_COMPARE_PRINT_H
#define RB_COMPARE_COMPARE_PRINT_H

#include "bench/compare/comparison.h"

// Where one side comes from. Texts are "" where they are not known.
struct rb_compare_run {
    const char *folder;
    char session[128], host[128], cpu_model[160], commit[64];
    struct rb_timings samples;
};

// What a gate makes of a comparison.
struct rb_compare_gate {
    bool asked;
    double threshold_pct;
    size_t slower;    // rows that are slower by more than the threshold, interval and all
    size_t undecided; // rows without an interval, cells without rows or only in A
};

struct rb_compare_report {
    const struct rb_compare_run *runs[2]; // the same twice, if two variants are compared
    const char *variants[2];              // NULL: all
    const struct rb_compare_options *options;
    const struct rb_comparison *comparison;
    struct rb_compare_gate gate;
};

enum { RB_CELL_LABEL_MAX = 512 };

// "balls_high 512x512, depth 5, tile 64, bvh, 1 thread"; without the columns in `skip`.
void rb_compare_label(const struct rb_timed_cell *cell, unsigned skip,
                      char label[RB_CELL_LABEL_MAX]);

// On standard output.
void rb_compare_print(const struct rb_compare_report *report);
void rb_compare_print_json(const struct rb_compare_report *report);

#endif
