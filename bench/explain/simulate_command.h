// `raybench simulate`: events per ray by kernel and bounce, from a simulator.
#ifndef RB_EXPLAIN_SIMULATE_COMMAND_H
#define RB_EXPLAIN_SIMULATE_COMMAND_H

#include "cli/options.h"

extern const struct rb_command rb_command_simulate;

#endif
