// The process that replays: `raybench replay-worker RAYS ...` runs one kernel on recorded batches,
// again and again until its time is up, and writes one struct rb_sample per repetition to standard
// output. Started by `raybench replay` and not part of the help. It first holds what the kernel
// gives against the record.
#ifndef RB_REPLAY_REPLAY_WORKER_H
#define RB_REPLAY_REPLAY_WORKER_H

#include "cli/options.h"

extern const struct rb_command rb_command_replay_worker;

#endif
