// Files of figures: what the kernels of a plan's cells did, at every bounce, as integers. A
// baseline is such a file, so is what a run of the gate writes; a gate holds two of them against
// each other.
//
// CSV with a line for each kernel at each bounce and, before those of a cell, one with the kernel
// `frame` that says what work it was: hashes of scene, image and hits, and, where simulated figures
// depend on it, what made them. A cell that cannot run here has a frame without hashes. The last
// line, `end`, has a hash of all bytes before it, so that a file that was cut or edited is no file.
#ifndef RB_GATE_FIGURES_H
#define RB_GATE_FIGURES_H

#include "bench/data/csv_read.h"
#include "bench/data/key.h"
#include "bench/run/run.h"

// How far a figure may move: by `share` of the baseline, or by so much a ray, or by so many events,
// whichever is most.
struct rb_figure_rule {
    const char *name;
    double share, per_ray, events;
};

enum {
    RB_FIGURE_RAYS,
    RB_FIGURE_COUNTERS, // as enum rb_counter
    RB_FIGURE_STACK_MAX = RB_FIGURE_COUNTERS + RB_COUNTER_COUNT,
    RB_FIGURE_SIMULATED, // as the next ones
    RB_FIGURE_INSTRUCTIONS = RB_FIGURE_SIMULATED,
    RB_FIGURE_L1_MISSES,
    RB_FIGURE_LL_MISSES,
    RB_FIGURE_COUNT,
};
struct rb_figure_rule rb_figure_rule(int figure);

// Columns of the file, after those of the key.
enum {
    RB_FIGURES_SCENE_HASH = RB_KEY_COUNT,
    RB_FIGURES_IMAGE_HASH,
    RB_FIGURES_HITS_HASH,
    RB_FIGURES_MADE_BY,
    RB_FIGURES_FIRST, // of RB_FIGURE_COUNT
    RB_FIGURES_COLUMNS = RB_FIGURES_FIRST + RB_FIGURE_COUNT,
};

// Writes the figures of the cells of a run. What was not counted or simulated is empty; a cell of
// which nothing was is not there.
enum rb_status rb_figures_write(const char *path, const struct rb_run *run, struct rb_error *error);

// Loads such a file; free it with rb_csv_free. RB_INVALID: it is not there, not whole, or not of
// this version of the program. The last line is not among its rows.
enum rb_status rb_figures_load(const char *path, struct rb_csv *figures, struct rb_error *error);

#endif
