// The one parallel loop of the builders.
#ifndef RB_ACCEL_PARALLEL_H
#define RB_ACCEL_PARALLEL_H

#include <stdint.h>

typedef void rb_parallel_step(const void *job, uint32_t index);

// Calls step(job, 0 .. count - 1), in any order, on `threads` workers at most, in the default
// floating-point environment. Serial where the compiler has no OpenMP.
void rb_parallel_for(int threads, uint32_t count, rb_parallel_step *step, const void *job);

#endif
