// Simulating a cell: which rows can be, how much of a frame, and that it was the right work.
#ifndef RB_RUN_SIMULATE_CELL_H
#define RB_RUN_SIMULATE_CELL_H

#include "bench/run/cell.h"
#include "bench/simulate/simulated.h"

// Why the row cannot be simulated, and which one to take instead; NULL if it can.
const char *rb_simulate_refusal(const struct rb_variant *variant);

// Simulates runs of tiles of the cell with `program`, after one warm pass over them: so many, or as
// many as take about ten seconds if `tiles` is 0. How many that are follows from rays and
// primitives alone, so that two runs simulate the same. The reference must be made. RB_INVALID if
// the row cannot be simulated, or if hits or rays are not those of a native run of the same tiles:
// then `simulated` is of no use, and likewise after RB_FAILED.
enum rb_status rb_simulate_cell(const struct rb_cell *cell, const char *program, uint32_t tiles,
                                const struct rb_caches *caches, struct rb_simulated *simulated,
                                struct rb_error *error);

#endif
