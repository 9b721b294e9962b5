// Change points: planted steps are found where they are, noise alone has hardly any.
#include "bench/data/changes.h"
#include "base/hash.h"
#include "tests/unit/tap.h"

#include <math.h>

enum { COUNT = 60 };

static double noise(uint64_t seed, size_t i)
{
    return (double)(rb_hash_word(seed, i) >> 11) * 0x1p-53;
}

static size_t marks(const bool *starts, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += starts[i];
    return found;
}

static void check_steps(void)
{
    double values[COUNT];
    bool starts[COUNT];
    for (size_t i = 0; i < COUNT; i++)
        values[i] = 100 + noise(1, i) + (i >= 20 ? 5 : 0) - (i >= 45 ? 3 : 0);
    ok(rb_changes_find(values, COUNT, starts), "a series with two steps");
    ok(starts[20] && starts[45] && marks(starts, COUNT) == 2, "has two change points, there");
    for (size_t i = 0; i < COUNT; i++)
        values[i] = 100 + noise(2, i) + (i == 30 ? 50 : 0);
    rb_changes_find(values, COUNT, starts);
    ok(marks(starts, COUNT) == 0, "one value astray is none");
    for (size_t i = 0; i < COUNT; i++)
        values[i] = 7;
    rb_changes_find(values, COUNT, starts);
    ok(marks(starts, COUNT) == 0, "equal values have none");
    for (size_t i = 0; i < 12; i++)
        values[i] = i < 6 ? 1 + noise(3, i) : 3 + noise(3, i);
    rb_changes_find(values, 12, starts);
    ok(starts[6] && marks(starts, 12) == 1, "twelve values are enough");
    rb_changes_find(values + 3, 6, starts);
    ok(marks(starts, 6) == 0, "six tell nothing");
    ok(rb_changes_find(values, 0, starts), "nor does none");
}

static void check_noise(void)
{
    double values[COUNT];
    bool starts[COUNT];
    size_t alarms = 0;
    for (uint64_t series = 0; series < 200; series++) {
        for (size_t i = 0; i < COUNT; i++)
            values[i] = 100 - 10 * log(noise(100 + series, i) + 1e-9);
        rb_changes_find(values, COUNT, starts);
        alarms += marks(starts, COUNT) > 0;
    }
    ok(alarms <= 6, "of 200 series of noise %d have a change point", (int)alarms);
}

int main(void)
{
    check_steps();
    check_noise();
    return done();
}
