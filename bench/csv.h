// kernels.csv: one row per scene, variant, kernel and bounce. results/README.md explains the
// columns.
#ifndef RB_BENCH_CSV_H
#define RB_BENCH_CSV_H

#include "bench/scene_bench.h"

#include <stdio.h>

void rb_csv_header(FILE *out);
void rb_csv_rows(FILE *out, const struct rb_scene_bench *bench);

#endif
