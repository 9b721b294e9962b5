// What two series of samples give to compare: one time for each process.
#ifndef RB_COMPARE_PROCESS_TIMES_H
#define RB_COMPARE_PROCESS_TIMES_H

#include "bench/compare/timings.h"

#include <stdbool.h>
#include <stddef.h>

// Room for as many processes and repetitions as there are samples; used again for every row.
struct rb_process_times {
    double *times[2]; // of A and of B, > 0
    size_t counts[2]; // the same and in pairs, if paired
    struct rb_process *processes[2];
    double *scratch;
};

// False if there is no memory. Free it in any case.
bool rb_process_times_make(struct rb_process_times *work, size_t a_samples, size_t b_samples);
void rb_process_times_free(struct rb_process_times *work);

// Fills times and counts. The time of a process is a quantile of its repetitions, the order
// statistic at or below it. RB_TIME_QUANTILE, the minimum of up to ten, is a good choice: what
// disturbs a process only ever adds time, and of the estimators tried on a busy virtual machine low
// quantiles repeat best from process to process (a compute-bound kernel: p10 within 0.5 %, the
// median within 6 %, the mean within 34 %). The minimum itself repeats worse than p10 where memory
// decides. A low quantile of few repetitions lies higher than one of many, so both sides count the
// same number of them: the first, as many as both processes of a pair have, or, if not paired, as
// many as typical processes of both sides have.
void rb_process_times_fill(struct rb_process_times *work, struct rb_timing_range a,
                           struct rb_timing_range b, double quantile, bool paired);

#endif
