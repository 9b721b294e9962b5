// samples.csv: every repetition of every process, one line per kernel and bounce. It is written as
// samples.csv.part, line by line as the samples come in, and gets its name when the run is
// finished; so a run that was stopped has left what it had, and can go on from there.
#ifndef RB_RUN_SAMPLES_FILE_H
#define RB_RUN_SAMPLES_FILE_H

#include "bench/run/plan.h"

#include <stdio.h>

void rb_samples_write(FILE *out, const struct rb_cell *cell, const struct rb_sample *sample);

// Gives the samples of the file to the cells of `side` they belong to. A repetition that the file
// has not whole is left out. RB_INVALID if the file is malformed or has other cells.
enum rb_status rb_samples_read(const char *path, struct rb_plan *plan, int side,
                               struct rb_error *error);

#endif
