#include "bench/machine/env_build.h"

#include "flags.h" // made by the Makefile, next to the objects

#ifdef __clang__
#define COMPILER __VERSION__ // begins with the name
#else
#define COMPILER "gcc " __VERSION__
#endif

const char rb_env_compiler[] = COMPILER;
const char rb_env_flags[] = RB_FLAGS;
