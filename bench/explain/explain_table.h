// What `raybench explain` prints, on standard output.
#ifndef RB_EXPLAIN_EXPLAIN_TABLE_H
#define RB_EXPLAIN_EXPLAIN_TABLE_H

#include "bench/run/plan.h"

// The kernel x bounce table of a cell: time, counts, simulated events, modelled categories.
void rb_explain_print_table(const struct rb_cell *cell);

// What the columns and the categories are, and what the numbers cannot say. `model` may be NULL.
void rb_explain_print_notes(const struct rb_energy_model *model);

// Whether the instructions simulated and the time measured fit each other, and where not.
void rb_explain_print_rates(const struct rb_plan *plan);

// A paragraph on a cell: which kernel at which bounce costs most and why, by the numbers of the
// table. `base` is the cell of the row that it is compared with; NULL: none.
void rb_explain_print_words(const struct rb_cell *cell, const struct rb_cell *base);

#endif
