// What the processor can do. This module is compiled for the baseline, so it runs everywhere; code
// compiled for more is called only after it has been asked.
#ifndef RB_BASE_CPU_H
#define RB_BASE_CPU_H

#include "base/status.h"

#include <stdbool.h>

// Checks RAYBENCH_CPU_DISABLE, a comma-separated list of features to do without, so that every
// level can be tested on one machine: sse2, avx2, avx512f, neon. RB_INVALID for a name nobody
// knows. Call it before the first rb_cpu_has; an unchecked list with unknown names disables what it
// can.
enum rb_status rb_cpu_check_disabled(struct rb_error *error);

// Does the processor (and the operating system) have this feature, and is it not disabled? False
// for unknown names. `length` bytes of `name` count.
bool rb_cpu_has(const char *name, int length);

// Name of the feature at `index` from 0, NULL past the last.
const char *rb_cpu_feature(int index);

#endif
