// Statistics as pure functions, thread-safe. Times are never averaged: one preemption moves a mean
// by more than the differences we look for.
//
// Values must be finite. Levels are probabilities in (0, 1). NaN is what could not be estimated:
// of no values, of values out of range, of too few for an interval, or without memory for a copy.
#ifndef RB_DATA_STATS_H
#define RB_DATA_STATS_H

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

// A median, or a ratio of medians, with an interval that covers the true one with probability
// `level` whatever the distribution. low, high and level are NaN where no interval exists.
struct rb_median {
    double value, low, high;
    double level; // attained, not the one asked for: order statistics have only so many
};

// Median of `values` (sorted in place) with the narrowest interval of two order statistics, placed
// symmetrically, whose coverage is >= level (sign test). The coverage is exact for continuous
// distributions; ties only add to it.
struct rb_median rb_stats_median_at(double *values, size_t count, double level);

// The smallest number of values for which rb_stats_median_at has an interval; SIZE_MAX if level is
// not below 1.
size_t rb_stats_median_count(double level);

// What level each of `comparisons` intervals needs so that all of them hold at once with
// probability `level` (Sidak 1967): exact for independent ones, conservative for intervals that
// tend to fail together, as those of a frame and of its parts do.
double rb_stats_family_level(double level, size_t comparisons);

// Median of the pairwise ratios b / a of positive values, on the log scale (the middle of two is
// their geometric mean, so that swapping a and b inverts everything), with its sign-test interval.
// For measurements taken in pairs: what moves both of a pair cancels.
struct rb_median rb_stats_paired_ratio(const double *a, const double *b, size_t count,
                                       double level);

// Median of b over the median of a, of positive values, for two independent samples: the intervals
// of both medians at sqrt(level) combined. Conservative: both intervals hold with the product of
// their levels, which is the level of the result, and then so does that of the ratio.
struct rb_median rb_stats_independent_ratio(const double *a, size_t a_count, const double *b,
                                            size_t b_count, double level);

// Quantile q in [0, 1] of `values` (sorted in place), linear between the order statistics around
// (count - 1) q: type 7 of Hyndman and Fan 1996, the default of R and NumPy.
double rb_stats_quantile(double *values, size_t count, double q);

// The order statistic at or below that place: with up to 10 values, the minimum for q = 0.1.
double rb_stats_quantile_lower(double *values, size_t count, double q);

double rb_stats_min(const double *values, size_t count);

// Median absolute percentage error, the median of 100 |x / center - 1|: a spread that outliers
// cannot move. `center` is not 0.
double rb_stats_mdape_pct(const double *values, size_t count, double center);

// Of positive values. Rates of equal work are averaged harmonically, ratios geometrically.
double rb_stats_harmonic_mean(const double *values, size_t count);
double rb_stats_geometric_mean(const double *values, size_t count);

// Ratio sum(y) / sum(x) of a random sample without replacement of `count` out of `population`
// units, with the 95 % interval of the linearised estimator (Cochran 1977, Sampling Techniques,
// 6.4), Student's t with count - 1 degrees of freedom.
struct rb_estimate rb_stats_ratio(const double *x, const double *y, size_t count,
                                  double population);

// Two-sided 95 % quantile of Student's t.
double rb_stats_t95(size_t degrees);

#endif
