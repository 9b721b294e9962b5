// `raybench peaks`: the most that one thread of this machine gets through, measured: cycles,
// instructions, bytes read from each level of its memory. What kernels are held against in a
// roofline (Williams, Waterman, Patterson 2009).
#ifndef RB_MACHINE_PEAKS_H
#define RB_MACHINE_PEAKS_H

#include "cli/options.h"

#include <stdint.h>

extern const struct rb_command rb_command_peaks;

// Cycles in a nanosecond, now: from a chain of additions, each of which takes one. Takes some
// milliseconds.
double rb_peak_cycles_per_ns(void);

// Instructions in a nanosecond: the best of some loops of independent additions of integers, and
// of floats beside them. Takes some milliseconds.
double rb_peak_instructions_per_ns(void);

// Bytes in a nanosecond that are read, again and again, from `bytes` bytes at `memory`, which
// nobody else touches; a multiple of 256, aligned to RB_CACHE_LINE.
double rb_peak_bytes_per_ns(const void *memory, size_t bytes);

#endif
