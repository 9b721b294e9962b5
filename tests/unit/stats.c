// Statistics against values computed independently: by hand, in integers here, or with Python's
// fractions, decimal and statistics modules where a literal has many digits.
#include "bench/data/stats.h"
#include "base/hash.h"
#include "base/memory.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdint.h>

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fmax(1.0, fabs(b));
}

// 2^n times the probability that k-th smallest and k-th largest of n do not enclose the median, in
// integers: twice the sum of the first k numbers of row n of Pascal's triangle. n <= 62.
static uint64_t missed_parts(size_t n, size_t k)
{
    uint64_t row[64] = {1}, sum = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j > 0; j--)
            row[j] += row[j - 1];
    for (size_t i = 0; i < k; i++)
        sum += row[i];
    return 2 * sum;
}

static void coverage_is_exact(void)
{
    bool exact = true;
    for (size_t n = 2; n <= 50; n++)
        for (size_t k = 1; 2 * k <= n; k++)
            exact &= rb_stats_median_coverage(n, k) ==
                     1.0 - (double)missed_parts(n, k) / (double)(UINT64_C(1) << n);
    ok(exact, "coverage is exact up to n 50");
    ok(near(rb_stats_median_coverage(1000, 469), 0.9537088026395019), "coverage of n 1000");
    ok(near(rb_stats_median_coverage(5000, 2409), 0.9903536934752578), "coverage of n 5000");
}

// Ranks as exact fractions give them: the largest k with coverage >= level.
static void intervals_are_the_narrowest(void)
{
    static const struct {
        size_t n;
        double level;
        size_t k;
        double attained;
    } rows[] = {
        {7, 0.95, 1, 0.984375},
        {8, 0.99, 1, 0.9921875},
        {20, 0.95, 6, 0.9586105346679688},
        {30, 0.99, 8, 0.9947771206498146},
        {101, 0.95, 41, 0.9539559330706572},
        {1000, 0.95, 469, 0.9537088026395019},
        {5, 0.9375, 1, 0.9375}, // coverage is the level to the last bit
    };
    static double values[1000];
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        size_t n = rows[r].n, k = rows[r].k;
        for (size_t i = 0; i < n; i++)
            values[i] = (double)(n - i);
        struct rb_median m = rb_stats_median_at(values, n, rows[r].level);
        ok(near(m.value, 0.5 * (double)(n + 1)) && near(m.level, rows[r].attained) &&
               m.low == (double)k && m.high == (double)(n + 1 - k),
           "median of %zu at %g", n, rows[r].level);
    }
    double seven[] = {1, 2, 3, 4, 5, 6, 7};
    struct rb_median m = rb_stats_median_at(seven, 7, 0.99);
    ok(m.value == 4 && isnan(m.low) && isnan(m.high) && isnan(m.level), "7 are too few for 99 %%");
    m = rb_stats_median_at(seven, 0, 0.5);
    ok(isnan(m.value) && isnan(m.low), "no values, no median");
}

static void counts_and_levels(void)
{
    static const struct {
        double level;
        size_t count;
    } rows[] = {{0.5, 2}, {0.9, 5}, {0.95, 6}, {0.99, 8}, {0.999, 11}, {0.9999, 15}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        ok(rb_stats_median_count(rows[i].level) == rows[i].count, "%g takes %zu values",
           rows[i].level, rows[i].count);
    ok(rb_stats_median_count(1.0) == SIZE_MAX, "certainty takes more than there are");
    ok(near(rb_stats_family_level(0.99, 1), 0.99) && near(rb_stats_family_level(0.99, 0), 0.99),
       "a family of one");
    ok(fabs(rb_stats_family_level(0.99, 5) - 0.9979919516614258) < 1e-15 &&
           fabs(rb_stats_family_level(0.99, 1000) - 0.9999899497146510) < 1e-15,
       "families of 5 and 1000");
}

static void quantiles_and_spread(void)
{
    double values[] = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3}, powers[] = {16, 8, 4, 2, 1};
    ok(rb_stats_min(values, 10) == 1 && isnan(rb_stats_min(values, 0)), "minimum");
    ok(near(rb_stats_quantile(values, 10, 0.2), 1.8) &&
           near(rb_stats_quantile(values, 10, 0.9), 6.3) &&
           near(rb_stats_quantile(powers, 5, 0.1), 1.4) && values[0] == 1,
       "quantiles between the values");
    ok(rb_stats_quantile(powers, 5, 0) == 1 && rb_stats_quantile(powers, 5, 1) == 16 &&
           rb_stats_quantile(powers, 1, 0.7) == 1 && isnan(rb_stats_quantile(powers, 0, 0.5)),
       "quantiles at the ends");
    double eleven[] = {11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
    ok(rb_stats_quantile_lower(eleven, 11, 0.1) == 2 &&
           rb_stats_quantile_lower(eleven, 10, 0.1) == 1 &&
           rb_stats_quantile_lower(eleven, 11, 1) == 11 &&
           isnan(rb_stats_quantile_lower(eleven, 0, 0.1)),
       "quantiles at one of the values");
    // Off 10 by 10, 5, 0, 20 and 900 %.
    double off[] = {9, 10.5, 10, 12, 100};
    ok(near(rb_stats_mdape_pct(off, 5, 10), 10) && off[4] == 100, "MdAPE by hand");
    ok(isnan(rb_stats_mdape_pct(off, 0, 10)) && isnan(rb_stats_mdape_pct(off, 5, 0)),
       "MdAPE of nothing, and about 0");
    double means[] = {2, 3, 7}, bad[] = {2, 0, 7};
    ok(near(rb_stats_harmonic_mean(means, 3), 126.0 / 41), "harmonic mean");
    ok(near(rb_stats_geometric_mean(means, 3), 3.4760266448864498), "geometric mean");
    ok(isnan(rb_stats_harmonic_mean(bad, 3)) && isnan(rb_stats_geometric_mean(bad, 3)) &&
           isnan(rb_stats_harmonic_mean(bad, 0)) && isnan(rb_stats_geometric_mean(bad, 0)),
       "no mean of zero or of nothing");
}

static void ratios(void)
{
    // Drift of a factor 32 that both see; b / a is 2, 2, 2, 2.1, 1.9, 2.
    double a[] = {1, 2, 4, 8, 16, 32}, b[] = {2, 4, 8, 16.8, 30.4, 64};
    struct rb_median r = rb_stats_paired_ratio(a, b, 6, 0.95);
    ok(near(r.value, 2) && near(r.low, 1.9) && near(r.high, 2.1) && near(r.level, 0.96875),
       "paired ratio");
    struct rb_median back = rb_stats_paired_ratio(b, a, 6, 0.95);
    ok(near(back.value * r.value, 1) && near(back.low * r.high, 1), "swapping inverts it");
    r = rb_stats_paired_ratio(a, b, 2, 0.95);
    ok(near(r.value, 2) && isnan(r.low) && isnan(r.level), "two pairs have no interval");
    // 0.95 each at sqrt(0.9025): n 6 the range, 31 / 32 each; medians 3.5 and 7.
    double x[] = {1, 2, 3, 4, 5, 6}, y[] = {12, 10, 8, 6, 4, 2};
    r = rb_stats_independent_ratio(x, 6, y, 6, 0.9025);
    ok(near(r.value, 2) && near(r.low, 2.0 / 6) && near(r.high, 12) &&
           near(r.level, 0.96875 * 0.96875) && y[0] == 12,
       "independent ratio");
    r = rb_stats_independent_ratio(x, 6, y, 3, 0.9);
    ok(near(r.value, 10 / 3.5) && isnan(r.low) && isnan(r.high) && isnan(r.level),
       "one side too few");
    // A range of 5 covers with 15 / 16, which is above 0.9 and below its root.
    ok(isnan(rb_stats_independent_ratio(x, 5, y, 5, 0.9).low), "the level is that of both");
    y[3] = 0;
    ok(isnan(rb_stats_paired_ratio(x, y, 6, 0.9).value) &&
           isnan(rb_stats_independent_ratio(x, 6, y, 6, 0.9).value) &&
           isnan(rb_stats_paired_ratio(x, y, 0, 0.9).value),
       "no ratio of zeros or of nothing");
    rb_memory_fail_at(1);
    ok(isnan(rb_stats_paired_ratio(x, x, 6, 0.9).value), "no ratio without memory");
    rb_memory_fail_at(1);
    ok(isnan(rb_stats_mdape_pct(x, 6, 1)), "no MdAPE without memory");
}

static uint64_t noise_state = 20190604;

static double uniform(void)
{
    noise_state = rb_hash_word(noise_state, 1);
    return ((double)(noise_state >> 11) + 0.5) * 0x1p-53;
}

// Skewed as times are: exponential above a floor.
static double skewed(void)
{
    return 1.0 - log(uniform());
}

enum { TRIALS = 4000, DRAWN = 24 };
static const double skewed_median = 1.6931471805599453; // 1 + ln 2

// Within four standard deviations of a binomial: a chance of 6e-5 to fail, were it not seeded.
static bool is_share(size_t hits, double probability)
{
    double spread = 4 * sqrt(TRIALS * probability * (1 - probability));
    return fabs((double)hits - TRIALS * probability) <= spread;
}

static void simulate(double level)
{
    double a[DRAWN], b[DRAWN], attained[2] = {0, 0};
    size_t hits[3] = {0, 0, 0};
    for (int trial = 0; trial < TRIALS; trial++) {
        for (int i = 0; i < DRAWN; i++)
            a[i] = skewed();
        for (int i = 0; i < DRAWN; i++)
            b[i] = 1.25 * skewed();
        struct rb_median r = rb_stats_independent_ratio(a, DRAWN, b, DRAWN, level);
        hits[2] += r.low <= 1.25 && 1.25 <= r.high;
        // A common factor per pair, and noise whose ratio has the median 1.25.
        for (int i = 0; i < DRAWN; i++) {
            double common = skewed() * skewed();
            a[i] = common * skewed();
            b[i] = common * 1.25 * skewed();
        }
        r = rb_stats_paired_ratio(a, b, DRAWN, level);
        attained[0] = r.level;
        hits[0] += r.low <= 1.25 && 1.25 <= r.high;
        for (int i = 0; i < DRAWN; i++)
            a[i] = skewed();
        r = rb_stats_median_at(a, DRAWN, level);
        attained[1] = r.level;
        hits[1] += r.low <= skewed_median && skewed_median <= r.high;
    }
    note("%g: paired %zu, median %zu, independent %zu of %d", level, hits[0], hits[1], hits[2],
         TRIALS);
    ok(attained[0] >= level && is_share(hits[0], attained[0]), "paired ratio covers at %g", level);
    ok(attained[1] >= level && is_share(hits[1], attained[1]), "median covers at %g", level);
    ok((double)hits[2] >= TRIALS * level, "independent ratio covers more than %g", level);
}

// Ten comparisons of equals: how often does any of them alarm?
static void simulate_family(void)
{
    double a[DRAWN], b[DRAWN], each = rb_stats_family_level(0.9, 10), attained = 1;
    size_t quiet = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        bool alarm = false;
        for (int test = 0; test < 10; test++) {
            for (int i = 0; i < DRAWN; i++) {
                a[i] = skewed();
                b[i] = skewed();
            }
            struct rb_median r = rb_stats_paired_ratio(a, b, DRAWN, each);
            alarm |= r.low > 1 || r.high < 1;
            attained = r.level;
        }
        quiet += !alarm;
    }
    note("family of 10 at 0.9: quiet in %zu of %d", quiet, TRIALS);
    ok(pow(attained, 10) >= 0.9 && is_share(quiet, pow(attained, 10)), "a family keeps its level");
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

    coverage_is_exact();
    intervals_are_the_narrowest();
    counts_and_levels();
    quantiles_and_spread();
    ratios();
    simulate(0.9);
    simulate(0.95);
    simulate(0.99);
    simulate_family();
    return done();
}
