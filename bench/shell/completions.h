// `raybench completions`: what a shell needs to complete raybench's command lines.
#ifndef RB_SHELL_COMPLETIONS_H
#define RB_SHELL_COMPLETIONS_H

#include "cli/options.h"

extern const struct rb_command rb_command_completions;

#endif
