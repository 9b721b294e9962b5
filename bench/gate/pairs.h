// Two programs measured in turn, process by process, and compared.
#ifndef RB_GATE_PAIRS_H
#define RB_GATE_PAIRS_H

#include "bench/compare/comparison.h"
#include "cli/options.h"

// A set of pairs of processes: of a base, and of this program, the head. Rows of both comparisons
// stand in one order, which is the same for all sets of one plan. Zero-initialise.
struct rb_pairs {
    struct rb_timings timings[2]; // base, head
    struct rb_comparison median;  // by the medians of the processes
    struct rb_comparison low;     // by a low quantile of them
};

// What to measure: options of sessions, among them --against.
extern const struct rb_option rb_options_pairs[];

// Measures a fresh set, as rb_options_pairs and the positional arguments in `given` say, but
// against `program`; what was in `pairs` is freed. RB_INVALID if a cell could not be measured or is
// another work for one of the programs; that may have been reported in more words.
enum rb_status rb_pairs_measure(const struct rb_arguments *given, const char *program,
                                struct rb_pairs *pairs, struct rb_error *error);
void rb_pairs_free(struct rb_pairs *pairs);

#endif
