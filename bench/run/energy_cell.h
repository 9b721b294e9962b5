// Measuring the energy of cells: frames, and each kernel alone at each bounce.
#ifndef RB_RUN_ENERGY_CELL_H
#define RB_RUN_ENERGY_CELL_H

#include "bench/energy/energy.h"
#include "bench/run/process.h"
#include "bench/run/run.h"

// Gives every open cell of the first program a struct rb_energy. What cannot be measured says why
// in it, and once on standard error; that is no failure. Kernels are replayed by the program's own
// commands on rays that are recorded for that. RB_FAILED without memory.
enum rb_status rb_energy_cells(struct rb_run *run, struct rb_error *error);

// Runs a worker that measures energy; its span goes to `span`.
enum rb_status rb_energy_run(const struct rb_worker_words *words, bool bind,
                             struct rb_energy_span *span, struct rb_error *error);

#endif
