// What a person reads of a simulation, on standard output.
#ifndef RB_EXPLAIN_SIMULATE_TABLE_H
#define RB_EXPLAIN_SIMULATE_TABLE_H

#include "bench/run/plan.h"

// The caches and what packet means, once for all tables.
void rb_simulate_print_caches(const struct rb_caches *caches);

// What was simulated of the cell: events per ray and shares of the modelled cycles, by kernel and
// bounce.
void rb_simulate_print(const struct rb_cell *cell);

// A line per cell: misses per ray of the tracing kernels, all bounces together, and the size of the
// tree. Nothing unless there are several scenes.
void rb_simulate_print_scaling(const struct rb_plan *plan);

// What the columns are, and what such a simulator cannot see.
void rb_simulate_print_notes(void);

#endif
