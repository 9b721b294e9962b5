// What the gate by the clock makes of intervals and noise.
#include "bench/gate/verdict.h"
#include "tests/unit/tap.h"

#include <math.h>

static struct rb_median ratio(double low, double value, double high)
{
    return (struct rb_median){value, low, high, 0.99};
}

static void check_verdicts(void)
{
    const double none = (double)NAN;
    const struct {
        struct rb_median median, low;
        double floor;
        enum rb_moved moved;
        const char *what;
    } cases[] = {
        {ratio(1.05, 1.1, 1.2), ratio(1.05, 1.1, 1.2), 1.02, RB_MOVED_WORSE, "above the noise"},
        {ratio(1.05, 1.1, 1.2), ratio(0.9, 1.01, 1.2), 1.02, RB_MOVED_UNDECIDED,
         "the low quantile disagrees"},
        {ratio(1.01, 1.1, 1.2), ratio(1.05, 1.1, 1.2), 1.02, RB_MOVED_UNDECIDED,
         "the interval reaches into the noise"},
        {ratio(1.05, 1.1, 1.2), ratio(1.05, 1.1, 1.2), 1.15, RB_MOVED_UNDECIDED, "a noisy host"},
        {ratio(0.99, 1.0, 1.01), ratio(0.99, 1.0, 1.01), 1.02, RB_MOVED_NOT, "within the noise"},
        {ratio(1.001, 1.005, 1.01), ratio(0.99, 1.0, 1.01), 1.02, RB_MOVED_NOT,
         "a difference that is real and small"},
        {ratio(0.97, 1.0, 1.01), ratio(0.99, 1.0, 1.01), 1.02, RB_MOVED_UNDECIDED,
         "equivalence is not shown"},
        {ratio(0.7, 0.8, 0.9), ratio(0.7, 0.8, 0.9), 1.02, RB_MOVED_BETTER, "below the noise"},
        {ratio(none, 1.5, none), ratio(none, 1.5, none), 1.02, RB_MOVED_UNDECIDED,
         "too few processes"},
        {ratio(1.05, 1.1, 1.2), ratio(1.05, 1.1, 1.2), none, RB_MOVED_UNDECIDED,
         "a noise that is not known"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        ok(rb_gate_judge(&cases[i].median, &cases[i].low, cases[i].floor) == cases[i].moved,
           "verdict: %s", cases[i].what);
}

int main(void)
{
    check_verdicts();
    return done();
}
