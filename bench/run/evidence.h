// What explains the times of a cell: what its kernels did, counted and simulated, which is exact
// and the same whenever it is done, so one process is enough, after the rounds.
#ifndef RB_RUN_EVIDENCE_H
#define RB_RUN_EVIDENCE_H

#include "bench/run/run.h"

// Counts, simulates and measures the energy of the cells of the first program, as run->measure
// says. A cell whose counting kernels disagree with the reference is invalid. What cannot be had
// for other reasons is reported and left out. Ends early when interrupted. RB_FAILED without
// memory.
enum rb_status rb_evidence_gather(struct rb_run *run, struct rb_error *error);

#endif
