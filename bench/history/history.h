// `raybench history`: the course of every cell over many runs.
#ifndef RB_HISTORY_HISTORY_H
#define RB_HISTORY_HISTORY_H

#include "cli/options.h"

extern const struct rb_command rb_command_history;

#endif
