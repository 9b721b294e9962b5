// What a person reads of the counts of a cell, on standard output: per ray, by kernel and bounce.
#ifndef RB_EXPLAIN_COUNT_TABLE_H
#define RB_EXPLAIN_COUNT_TABLE_H

#include "bench/run/cell.h"

// A cell that was not counted prints nothing.
void rb_count_table_print(const struct rb_cell *cell);

// What the columns are.
void rb_count_table_print_notes(void);

#endif
