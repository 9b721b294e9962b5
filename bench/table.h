// What a person reads in the terminal.
#ifndef RB_BENCH_TABLE_H
#define RB_BENCH_TABLE_H

#include "bench/scene_bench.h"

// Frame times and speed-ups of all rows, then ns per ray by kernel and bounce, on standard output.
void rb_table_print(const struct rb_scene_bench *bench);

// The line about what the probes cost; `worst` is the largest share among the rows.
void rb_table_print_probes(double probe_ns, double worst);

#endif
