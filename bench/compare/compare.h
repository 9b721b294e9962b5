// `raybench compare`: is B faster than A, by how much, and how sure is that?
#ifndef RB_COMPARE_COMPARE_H
#define RB_COMPARE_COMPARE_H

#include "cli/options.h"

extern const struct rb_command rb_command_compare;

#endif
