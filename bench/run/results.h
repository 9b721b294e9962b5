// The files of a result folder, made from the cells of one side of a run.
#ifndef RB_RUN_RESULTS_H
#define RB_RUN_RESULTS_H

#include "bench/machine/env.h"
#include "bench/run/columns.h"
#include "bench/run/plan.h"

struct rb_results {
    const struct rb_plan *plan;
    int side;
    bool partial; // the run has not come to its end
    double probe_ns;
    const char *folder;
    struct rb_env_run env;
};

// Writes kernels.csv, frame.csv, env.json and result.json, each whole or not at all.
enum rb_status rb_results_write(const struct rb_results *results, struct rb_error *error);

// A frame's worth of a line of kernels.csv, for tables: which kernel and bounce, figures filled.
struct rb_line rb_results_line(const struct rb_cell *cell, enum rb_stage stage, int bounce);

#endif
