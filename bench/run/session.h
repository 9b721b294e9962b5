// A run from its plan to its results: the plan is made, references are, cells are measured, counted
// and simulated, a folder keeps what came out, tables are printed. The commands differ in what they
// measure unless told and in what they print.
#ifndef RB_RUN_SESSION_H
#define RB_RUN_SESSION_H

#include "bench/run/run.h"

struct rb_session_kind {
    const char *defaults; // lines of the plan, before those of the user
    // Prints what there is, on standard output; returns the exit code.
    int (*print)(const struct rb_run *run, bool partial);
};

// Options of the commands that run plans: what to measure, how to time it, how to simulate it,
// where to keep it. Keys of plans are those of `raybench bench`, which has them all.
extern const struct rb_option rb_options_cells[];
extern const struct rb_option rb_options_timing[];
extern const struct rb_option rb_options_simulation[];
extern const struct rb_option rb_options_hardware[];
extern const struct rb_option rb_options_keeping[];

// Returns the exit code, having reported errors.
int rb_session_run(const struct rb_session_kind *kind, const struct rb_arguments *arguments);

// Prints where the results are.
void rb_session_print_folder(const struct rb_run *run, bool partial);

#endif
