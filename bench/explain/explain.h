// `raybench explain`.
#ifndef RB_EXPLAIN_EXPLAIN_H
#define RB_EXPLAIN_EXPLAIN_H

#include "cli/options.h"

extern const struct rb_command rb_command_explain;

#endif
