#include "bench/gate/verdict.h"

#include <math.h>

enum rb_moved rb_gate_judge(const struct rb_median *median, const struct rb_median *low,
                            double floor)
{
    if (isnan(median->low) || isnan(low->value) || isnan(floor))
        return RB_MOVED_UNDECIDED;
    if (median->low > floor && low->value > floor)
        return RB_MOVED_WORSE;
    if (median->high < 1 / floor && low->value < 1 / floor)
        return RB_MOVED_BETTER;
    bool within = median->low >= 1 / floor && median->high <= floor;
    return within ? RB_MOVED_NOT : RB_MOVED_UNDECIDED;
}
