// `raybench gate`: the first tier of the regression gate, deterministic, for any machine.
#ifndef RB_GATE_GATE_H
#define RB_GATE_GATE_H

#include "cli/options.h"

extern const struct rb_command rb_command_gate;

#endif
