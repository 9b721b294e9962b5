// What moved between two files of figures.
#ifndef RB_GATE_MOVED_H
#define RB_GATE_MOVED_H

#include "bench/gate/figures.h"
#include "bench/gate/waivers.h"

// Adds to the report every figure of `base` and how it stands in `head`. Cells that cannot run
// here, and simulations of another making, are noted and left out; `*left_out` counts them.
// RB_INVALID where the two do not tell about the same work: a cell or a place is only in one, or
// hashes differ.
enum rb_status rb_figures_compare(const struct rb_csv *base, const struct rb_csv *head,
                                  const struct rb_waivers *waivers, struct rb_gate_report *report,
                                  size_t *left_out, struct rb_error *error);

#endif
