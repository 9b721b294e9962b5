#include "bench/stats.h"

#include <math.h>
#include <stdlib.h>

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double rb_stats_median_coverage(size_t n, size_t k)
{
    // The median is missed on one side if fewer than k of n fair coins fall there.
    double missed = 0, log_choose = 0;
    for (size_t i = 0; i < k; i++) {
        missed += exp(log_choose - (double)n * log(2.0));
        log_choose += log((double)(n - i)) - log((double)(i + 1));
    }
    return 1.0 - 2.0 * missed;
}

struct rb_estimate rb_stats_median(double *values, size_t count)
{
    if (count == 0)
        return (struct rb_estimate){(double)NAN, (double)NAN, (double)NAN};
    qsort(values, count, sizeof *values, compare);
    size_t k = 0;
    while (2 * (k + 1) <= count && rb_stats_median_coverage(count, k + 1) >= 0.95)
        k++;
    double low_middle = values[(count - 1) / 2], high_middle = values[count / 2];
    double low = k ? values[k - 1] : (double)NAN, high = k ? values[count - k] : (double)NAN;
    return (struct rb_estimate){0.5 * (low_middle + high_middle), low, high};
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
