// The floating-point environment every worker computes in: round to nearest, denormals kept, no
// traps. Results must not depend on what the calling program has set.
#ifndef RB_BASE_FPENV_H
#define RB_BASE_FPENV_H

#include <fenv.h>

// Saves the caller's environment and installs the default one; thread-local, like fenv itself.
static inline void rb_fpenv_enter(fenv_t *saved)
{
    fegetenv(saved);
    fesetenv(FE_DFL_ENV);
}

static inline void rb_fpenv_leave(const fenv_t *saved)
{
    fesetenv(saved);
}

#endif
