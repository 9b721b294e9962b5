// What every process that measures does: one thing, again and again until its time is up, with a
// struct rb_sample on standard output each time.
#ifndef RB_RUN_REPEAT_H
#define RB_RUN_REPEAT_H

#include "bench/run/sample.h"
#include "cli/options.h"
#include "render/renderer.h"

// Where a worker stands. It is too large for the stack.
struct rb_repeater {
    struct rb_renderer *renderer;
    struct rb_run_options how; // what to measure
    struct rb_sample sample;   // of the last repetition
    double slice_s;            // that the process may take
    uint64_t start_ns;
    bool expected; // image_hash: or the sample is marked as a mismatch
    uint64_t image_hash;
};

// Starts the clocks and holds the process on the processor that --cpu names; --slice and --process
// are the others it follows. The caller then provides the renderer.
void rb_repeater_begin(struct rb_repeater *repeater, const struct rb_bench_arguments *bench);

// One repetition; the sample has everything about it then.
void rb_repeater_measure(struct rb_repeater *repeater, struct rb_run_result *result);

// Writes to standard output: the sample, or what comes behind it in a record. RB_FAILED if that
// cannot be.
enum rb_status rb_repeater_write(const void *from, size_t bytes, struct rb_error *error);
enum rb_status rb_repeater_send(const struct rb_repeater *repeater, struct rb_error *error);

// Repetitions that are not kept, until two in a row took about the same time, or time is short.
void rb_repeater_warm_up(struct rb_repeater *repeater);

// At least one repetition, and no more that would end late; each is sent.
enum rb_status rb_repeater_run(struct rb_repeater *repeater, struct rb_error *error);

#endif
