// Values of options: one parser for each kind.
#ifndef RB_CLI_VALUES_H
#define RB_CLI_VALUES_H

#include "cli/options.h"

// Parses `text` as the option has it, into its field of `arguments`; RB_INVALID with what was
// expected otherwise. `name` is what the user calls the option.
enum rb_status rb_value_assign(const struct rb_option *option, const char *name, const char *text,
                               struct rb_arguments *arguments, struct rb_error *error);

#endif
