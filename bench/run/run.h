// A run: all cells of a plan, each in several processes, in seeded and interleaved order within a
// budget of time. Round r starts process r of every cell, in an order shuffled anew each round, so
// that drift of the machine hits all cells alike and process r of two cells are neighbours in time.
// When every cell has had its processes, what is left of the budget goes where the interval is
// widest. With a second program, its process of a cell comes right before or after that of the
// first, in turn.
//
// Every sample is on disk before the next process starts.
#ifndef RB_RUN_RUN_H
#define RB_RUN_RUN_H

#include "bench/run/folder.h"
#include "bench/run/plan.h"

#include <stdio.h>
#include <time.h>

struct rb_side {
    char program[RB_PATH_MAX];
    char folder[RB_PATH_MAX];
    FILE *samples; // samples.csv.part
};

enum rb_measure {
    RB_MEASURE_TIME = 1,
    RB_MEASURE_COUNT = 2,
    RB_MEASURE_SIMULATE = 4,
    RB_MEASURE_HARDWARE = 8,
};

struct rb_run {
    struct rb_plan *plan;
    const char *parent; // folder of result folders
    char session[64];   // names the run in both of its folders
    struct rb_side sides[2];
    int side_count;
    int unit_count;                   // cells of a side
    const struct rb_arguments *given; // what the user said
    unsigned measure;                 // bits of rb_measure
    struct rb_caches caches;          // to simulate
    struct rb_event_file events;      // to count
    struct rb_energy_model model;     // of energy, if there is one
    double probe_ns, budget_s;
    time_t started;
    uint64_t start_ns;
    bool quiet;
    bool crashed, mismatch; // some cell
    bool uncounted;         // it was told that no event counts here
};

// Makes the references, from the cache next to the result folders where it has them, and decides
// which cells measure groups of tiles. Starts the clock of the budget.
enum rb_status rb_run_prepare(struct rb_run *run, struct rb_error *error);

// Measures. RB_OK also where cells crashed or mismatched; RB_FAILED if results cannot be kept. Ends
// early when interrupted; rb_process_interrupted tells.
enum rb_status rb_run_cells(struct rb_run *run, struct rb_error *error);

// Processes each cell should have at least.
int rb_run_processes(const struct rb_run *run);

#endif
