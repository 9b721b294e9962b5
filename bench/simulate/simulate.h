// Runs a program under valgrind's callgrind and reads what it dumped.
#ifndef RB_SIMULATE_SIMULATE_H
#define RB_SIMULATE_SIMULATE_H

#include "bench/simulate/simulated.h"

// RB_FAILED, saying what to install, unless this build and this machine can simulate.
enum rb_status rb_simulate_check(struct rb_error *error);

// Runs words[0] with its arguments, NULL-ended, in an environment of its own that is always the
// same: stacks are laid out alike, and two runs give the same counts. The program works as
// measure/simulate.h says; its output is dropped. Fills `simulated` but for the tiles. Files lie in
// a temporary folder, which is removed in any case. RB_FAILED if valgrind is not there, the program
// fails (with what it said last), or leaves no whole record. A signal that ends the run ends the
// simulator, too, and is raised again. Not thread-safe.
enum rb_status rb_simulate_run(char *const *words, const struct rb_caches *caches,
                               struct rb_simulated *simulated, struct rb_error *error);

#endif
