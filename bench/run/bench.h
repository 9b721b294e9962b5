// The benchmark harness as a sub-command.
#ifndef RB_RUN_BENCH_H
#define RB_RUN_BENCH_H

#include "cli/options.h"

extern const struct rb_command rb_command_bench;

#endif
