// Change points of a series: where its level moved, and stayed.
#ifndef RB_DATA_CHANGES_H
#define RB_DATA_CHANGES_H

#include <stdbool.h>
#include <stddef.h>

// Marks in `starts` (one per value, all cleared first) the first value of every new level. Of each
// stretch, Pettitt's statistic of ranks (1979, "A non-parametric approach to the change-point
// problem") finds the likeliest place; a permutation test says whether chance would do as well,
// which it may in one stretch of a hundred, as in E-divisive (Matteson, James 2014); both parts are
// then searched likewise. Nothing is assumed of the distribution. Six values or fewer tell nothing.
// The same values always give the same marks. False without memory.
bool rb_changes_find(const double *values, size_t count, bool *starts);

#endif
