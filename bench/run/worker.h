// The process that measures: `raybench worker SCENE ...` renders one cell, again and again until
// its time is up, and writes one struct rb_sample per repetition to standard output, a pipe. It is
// started by the harness and not part of the help. Every process first renders a frame with hits
// hashed and holds it against what it was told to expect.
#ifndef RB_RUN_WORKER_H
#define RB_RUN_WORKER_H

#include "cli/options.h"

// For tests: RB_SLOW_VARIABLE=trace:20 makes trace take 20 % longer, and count 20 % more, in every
// worker.
#define RB_SLOW_VARIABLE "RAYBENCH_TEST_SLOW"

extern const struct rb_command rb_command_worker;

#endif
