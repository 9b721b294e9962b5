// `raybench table`: Table 1 of the 2019 report, measured anew.
#ifndef RB_TIMES_RENDER_COMMAND_H
#define RB_TIMES_RENDER_COMMAND_H

#include "cli/options.h"

extern const struct rb_command rb_command_table;

#endif
