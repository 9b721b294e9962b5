// `raybench man`: the manual page, made from the tables of commands, options, scenes and variants.
#ifndef RB_SHELL_MAN_H
#define RB_SHELL_MAN_H

#include "cli/options.h"

#include <stdio.h>

extern const struct rb_command rb_command_man;

// Writes the page in the macros of man(7), for commands ended by NULL. Errors are the stream's.
void rb_man_write(FILE *out, const struct rb_command *const *commands);

#endif
