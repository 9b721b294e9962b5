#include "bench/data/stats.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Probability that fewer than k of n fair coins show heads: sum of C(n, i) / 2^n for i < k. Exact
// while C(n, k) fits a double's mantissa; beyond that, scaled down before it could overflow.
static double coins_below(size_t n, size_t k)
{
    double term = 1, sum = 0;
    int exponent = -(int)n;
    for (size_t i = 0; i < k; i++) {
        sum += term;
        term = term * (double)(n - i) / (double)(i + 1);
        if (term > 0x1p500) {
            term = ldexp(term, -500);
            sum = ldexp(sum, -500);
            exponent += 500;
        }
    }
    return ldexp(sum, exponent);
}

// The largest k for which the k-th smallest and the k-th largest of n values enclose the median
// with probability >= level; 0 if none does. What is missed is compared, not what is covered,
// which would round to 1.
static size_t interval_rank(size_t n, double level)
{
    size_t low = 0, high = n / 2;
    while (low < high) {
        size_t k = high - (high - low) / 2;
        if (2 * coins_below(n, k) <= 1.0 - level)
            low = k;
        else
            high = k - 1;
    }
    return low;
}

static double middle(const double *sorted, size_t count)
{
    return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

double rb_stats_median_coverage(size_t n, size_t k)
{
    // The median is missed on one side if fewer than k of n fair coins fall there.
    return 1.0 - 2.0 * coins_below(n, k);
}

struct rb_median rb_stats_median_at(double *values, size_t count, double level)
{
    struct rb_median median = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};
    if (count == 0)
        return median;
    qsort(values, count, sizeof *values, compare);
    median.value = middle(values, count);
    size_t k = interval_rank(count, level);
    if (k == 0)
        return median;
    median.low = values[k - 1];
    median.high = values[count - k];
    median.level = rb_stats_median_coverage(count, k);
    return median;
}

struct rb_estimate rb_stats_median(double *values, size_t count)
{
    struct rb_median median = rb_stats_median_at(values, count, 0.95);
    return (struct rb_estimate){median.value, median.low, median.high};
}

size_t rb_stats_median_count(double level)
{
    size_t count = 2;
    while (level < 1.0 && interval_rank(count, level) == 0)
        count++;
    return level < 1.0 ? count : SIZE_MAX;
}

double rb_stats_family_level(double level, size_t comparisons)
{
    return comparisons ? pow(level, 1.0 / (double)comparisons) : level;
}

double rb_stats_quantile(double *values, size_t count, double q)
{
    if (count == 0)
        return (double)NAN;
    qsort(values, count, sizeof *values, compare);
    double place = (double)(count - 1) * q;
    size_t below = (size_t)place, above = below + (below + 1 < count);
    return values[below] + (place - (double)below) * (values[above] - values[below]);
}

double rb_stats_quantile_lower(double *values, size_t count, double q)
{
    if (count == 0)
        return (double)NAN;
    qsort(values, count, sizeof *values, compare);
    return values[(size_t)((double)(count - 1) * q)];
}

double rb_stats_min(const double *values, size_t count)
{
    double least = count ? values[0] : (double)NAN;
    for (size_t i = 1; i < count; i++)
        least = values[i] < least ? values[i] : least;
    return least;
}

double rb_stats_mdape_pct(const double *values, size_t count, double center)
{
    double *errors = rb_alloc(count, sizeof *errors), median = (double)NAN;
    for (size_t i = 0; errors && i < count; i++)
        errors[i] = 100.0 * fabs(values[i] / center - 1.0);
    if (errors && isfinite(center) && center != 0)
        median = rb_stats_quantile(errors, count, 0.5);
    rb_free(errors);
    return median;
}

static bool all_positive(const double *values, size_t count)
{
    bool positive = true;
    for (size_t i = 0; i < count; i++)
        positive &= values[i] > 0 && isfinite(values[i]);
    return positive;
}

struct rb_median rb_stats_paired_ratio(const double *a, const double *b, size_t count, double level)
{
    double *logs = rb_alloc(count, sizeof *logs);
    bool usable = logs && all_positive(a, count) && all_positive(b, count);
    for (size_t i = 0; usable && i < count; i++)
        logs[i] = log(b[i] / a[i]);
    struct rb_median ratio = rb_stats_median_at(logs, usable ? count : 0, level);
    rb_free(logs);
    return (struct rb_median){exp(ratio.value), exp(ratio.low), exp(ratio.high), ratio.level};
}

// rb_stats_median_at that leaves the values in their order.
static struct rb_median median_of(const double *values, size_t count, double level)
{
    double *sorted = rb_alloc(count, sizeof *sorted);
    bool usable = sorted && all_positive(values, count);
    for (size_t i = 0; usable && i < count; i++)
        sorted[i] = values[i];
    struct rb_median median = rb_stats_median_at(sorted, usable ? count : 0, level);
    rb_free(sorted);
    return median;
}

struct rb_median rb_stats_independent_ratio(const double *a, size_t a_count, const double *b,
                                            size_t b_count, double level)
{
    struct rb_median from = median_of(a, a_count, sqrt(level));
    struct rb_median to = median_of(b, b_count, sqrt(level));
    return (struct rb_median){to.value / from.value, to.low / from.high, to.high / from.low,
                              to.level * from.level};
}

double rb_stats_harmonic_mean(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += 1.0 / values[i];
    return count && all_positive(values, count) ? (double)count / sum : (double)NAN;
}

double rb_stats_geometric_mean(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += values[i] > 0 ? log(values[i]) : 0;
    return count && all_positive(values, count) ? exp(sum / (double)count) : (double)NAN;
}

double rb_stats_t95(size_t degrees)
{
    static const double table[] = {
        HUGE_VAL, 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
        2.201,    2.179,  2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
    };
    size_t last = sizeof table / sizeof *table - 1;
    // Beyond the table: the first two terms of the expansion around the normal quantile.
    return degrees <= last ? table[degrees] : 1.960 + 2.372 / (double)degrees;
}

struct rb_estimate rb_stats_ratio(const double *x, const double *y, size_t count, double population)
{
    double sum_x = 0, sum_y = 0, squares = 0;
    for (size_t i = 0; i < count; i++) {
        sum_x += x[i];
        sum_y += y[i];
    }
    if (!(sum_x > 0))
        return (struct rb_estimate){(double)NAN, (double)NAN, (double)NAN};
    double n = (double)count, ratio = sum_y / sum_x;
    if (count < 2)
        return (struct rb_estimate){ratio, (double)NAN, (double)NAN};
    for (size_t i = 0; i < count; i++)
        squares += (y[i] - ratio * x[i]) * (y[i] - ratio * x[i]);
    double unseen = population > n ? 1.0 - n / population : 0.0;
    double error = sqrt(unseen * squares / (n - 1) / n) / (sum_x / n);
    double half = rb_stats_t95(count - 1) * error;
    return (struct rb_estimate){ratio, ratio - half, ratio + half};
}
