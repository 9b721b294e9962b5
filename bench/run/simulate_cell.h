// Simulating cells: which rows can be, how much of a frame, and that it was the right work.
#ifndef RB_RUN_SIMULATE_CELL_H
#define RB_RUN_SIMULATE_CELL_H

#include "bench/run/cell.h"

// Why the row cannot be simulated, and which one to take instead; NULL if it can.
const char *rb_simulate_refusal(const struct rb_variant *variant);

// From here on, in this process and its workers, rows that stand for others and the machine's own
// choices do without what valgrind lacks.
void rb_simulate_mask(void);

// Rays that the simulator gets through in about five seconds with the row of the cell.
double rb_simulate_affordable_rays(const struct rb_cell *cell);

// Simulates runs of tiles of the cell, whose row must be one that can be, with `program`, after one
// warm pass over them, and gives the result to the cell. So many tiles, or as many as take about
// ten seconds if `tiles` is 0: how many those are follows from rays and primitives alone, so that
// two runs simulate the same. The reference must be made. The cell gets nothing where this fails:
// RB_INVALID if hits or rays are not those of a native run of the same tiles, else RB_FAILED.
enum rb_status rb_simulate_cell(struct rb_cell *cell, const char *program, uint32_t tiles,
                                const struct rb_caches *caches, struct rb_error *error);

#endif
