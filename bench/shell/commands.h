// All sub-commands of the program, those of src/cli and those of the harness.
#ifndef RB_SHELL_COMMANDS_H
#define RB_SHELL_COMMANDS_H

#include "cli/options.h"

extern const struct rb_command *const rb_commands[]; // ended by NULL

#endif
