// Heat maps: an image of what each pixel costs.
#ifndef RB_EXPLAIN_HEAT_H
#define RB_EXPLAIN_HEAT_H

#include "bench/run/cell.h"

// Which costs: a name of rb_counter_names; "tests", all primitives; "ns", time.
struct rb_heat {
    const char *name;
    uint32_t counters; // bit c: counter c; 0: time
};

// RB_INVALID with the names there are.
enum rb_status rb_heat_find(const char *name, struct rb_heat *heat, struct rb_error *error);

// Renders the cell's frame and writes the picture to `path`, whose ending says the format: black is
// nothing, white as much as the dearest pixel in a thousand or more. A .pfm has the numbers
// themselves. Counts are those of all kernels and bounces. Times are those of blocks of 16 x 16
// pixels, the least that the kernels get at once, shared evenly; the least of several frames. What
// the colours mean goes to standard output. Not thread-safe.
enum rb_status rb_heat_write(const struct rb_cell *cell, const struct rb_heat *heat,
                             const char *path, struct rb_error *error);

#endif
