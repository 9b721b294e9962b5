// What kernels do with recorded rays, beside the time they take. All run every unit once and print
// a table on standard output; they return the exit code, having reported what is wrong.
#ifndef RB_REPLAY_REPLAY_EVIDENCE_H
#define RB_REPLAY_REPLAY_EVIDENCE_H

#include "bench/replay/replay.h"
#include "bench/run/process.h"

// Exact counts, by the twins of the kernels that count.
int rb_replay_count(struct rb_replay_run *run, const struct rb_arguments *arguments);

// Instructions and misses of some batches, from a simulator.
int rb_replay_simulate(struct rb_replay_run *run, const struct rb_arguments *arguments);

// What the processor's counters, or the kernel's own events, say of it.
int rb_replay_hardware(struct rb_replay_run *run, const struct rb_arguments *arguments);

// The energy it takes, measured; or, where that cannot be and a model was asked for, modelled.
int rb_replay_energy(struct rb_replay_run *run, const struct rb_arguments *arguments);

// The command line of a worker that replays a unit, but for its file.
void rb_replay_unit_words(const struct rb_replay_run *run, const struct rb_replay_unit *unit,
                          struct rb_worker_words *words);

#endif
