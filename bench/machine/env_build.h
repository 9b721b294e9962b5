// How this program was built, as far as the compiler and the Makefile tell.
#ifndef RB_MACHINE_ENV_BUILD_H
#define RB_MACHINE_ENV_BUILD_H

extern const char rb_env_compiler[]; // "gcc 12.2.0"
extern const char rb_env_flags[];    // the compiler and its flags, as the shell gets them

#endif
