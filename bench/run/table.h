// What a person reads in the terminal.
#ifndef RB_RUN_TABLE_H
#define RB_RUN_TABLE_H

#include "bench/run/plan.h"

// Frame times and speed-ups of the cells of one reference and side, where their time goes, ns per
// ray by kernel and bounce, and what each row brings over its baseline. On standard output.
void rb_table_print(const struct rb_plan *plan, const struct rb_reference *reference, int side,
                    double probe_ns);

// All scenes together, to stand below their own tables: the harmonic mean of a row's Mrays/s and
// the geometric mean of its speed-up over its baseline. Nothing unless there are several scenes.
void rb_table_print_summary(const struct rb_plan *plan);

#endif
