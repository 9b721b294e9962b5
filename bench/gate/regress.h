// `raybench regress`: the second tier of the regression gate, by the clock.
#ifndef RB_GATE_REGRESS_H
#define RB_GATE_REGRESS_H

#include "cli/options.h"

extern const struct rb_command rb_command_regress;

#endif
