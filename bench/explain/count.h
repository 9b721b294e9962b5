// `raybench count`.
#ifndef RB_EXPLAIN_COUNT_H
#define RB_EXPLAIN_COUNT_H

#include "cli/options.h"

extern const struct rb_command rb_command_count;

#endif
