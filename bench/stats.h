// Statistics as pure functions. Times are never averaged: one preemption moves a mean by more than
// the differences we look for.
#ifndef RB_BENCH_STATS_H
#define RB_BENCH_STATS_H

#include <stddef.h>

// A value with an interval; NaN where it could not be estimated.
struct rb_estimate {
    double value, low, high;
};

// Median of `values` (sorted in place) with the narrowest interval of two order statistics, placed
// symmetrically, that covers the true median with probability >= 0.95 whatever the distribution
// (sign test). With fewer than 6 values no such interval exists: low and high are NaN.
struct rb_estimate rb_stats_median(double *values, size_t count);

// Probability that the median lies between the k-th smallest and the k-th largest of n values,
// k from 1.
double rb_stats_median_coverage(size_t n, size_t k);

// Ratio sum(y) / sum(x) of a random sample without replacement of `count` out of `population`
// units, with the 95 % interval of the linearised estimator (Cochran 1977, Sampling Techniques,
// 6.4), Student's t with count - 1 degrees of freedom.
struct rb_estimate rb_stats_ratio(const double *x, const double *y, size_t count,
                                  double population);

// Two-sided 95 % quantile of Student's t.
double rb_stats_t95(size_t degrees);

#endif
