// Statistics against values computed independently (by hand, and with exact fractions).
#include "bench/stats.h"
#include "tests/unit/tap.h"

#include <math.h>

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fmax(1.0, fabs(b));
}

int main(void)
{
    // n = 5: P(all on one side) = 2 / 32.
    ok(near(rb_stats_median_coverage(5, 1), 1 - 2.0 / 32), "coverage n 5 k 1");
    // n = 10, k = 2: 1 - 2 (1 + 10) / 1024
    ok(near(rb_stats_median_coverage(10, 2), 1 - 22.0 / 1024), "coverage n 10 k 2");
    ok(near(rb_stats_median_coverage(10, 3), 1 - 2 * 56.0 / 1024), "coverage n 10 k 3");

    double odd[] = {5, 1, 9, 3, 7};
    struct rb_estimate e = rb_stats_median(odd, 5);
    ok(e.value == 5 && isnan(e.low) && isnan(e.high), "median of 5, too few for an interval");
    double six[] = {6, 5, 4, 3, 2, 1};
    e = rb_stats_median(six, 6);
    ok(e.value == 3.5 && e.low == 1 && e.high == 6, "median of 6, the range as interval");
    double ten[] = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
    e = rb_stats_median(ten, 10);
    ok(e.value == 5.5 && e.low == 2 && e.high == 9, "median of 10, second and ninth value");
    e = rb_stats_median(ten, 0);
    ok(isnan(e.value), "median of nothing is no number");
    double one[] = {4};
    e = rb_stats_median(one, 1);
    ok(e.value == 4 && isnan(e.low), "median of one");

    // Proportional data: no spread whatever the sample.
    double x[] = {1, 2, 3, 4}, y[] = {3, 6, 9, 12};
    e = rb_stats_ratio(x, y, 4, 100);
    ok(near(e.value, 3) && near(e.low, 3) && near(e.high, 3), "ratio of proportional data");
    // y = 1, 3; x = 1, 1: ratio 2, residuals -1, 1, s^2 = 2, half width 12.706 sqrt(2 / 2).
    double a[] = {1, 1}, b[] = {1, 3};
    e = rb_stats_ratio(a, b, 2, 1e12);
    ok(near(e.value, 2) && fabs(e.high - (2 + 12.706)) < 1e-6, "ratio interval by hand");
    e = rb_stats_ratio(a, b, 2, 2);
    ok(near(e.low, 2) && near(e.high, 2), "a sample that is everything has no error");
    e = rb_stats_ratio(a, b, 1, 10);
    ok(near(e.value, 1) && isnan(e.low), "one unit has no interval");
    ok(fabs(rb_stats_t95(30) - 2.042) < 0.005 && fabs(rb_stats_t95(1000) - 1.962) < 0.005,
       "Student's t beyond the table");
    return done();
}
