// What a row of a comparison says, measured against the noise of its host.
#ifndef RB_GATE_VERDICT_H
#define RB_GATE_VERDICT_H

#include "bench/compare/comparison.h"
#include "bench/gate/report.h"

// `median` and `low` are ratios of head over base by the median and by a low quantile of each
// process; `floor` is that of the host, NaN if there is none. Worse: the whole interval lies above
// the floor, and the low quantile does. Better likewise. Not moved: the whole interval lies within
// the floor, so that any difference is shown to be smaller. Undecided: everything else. A pure
// function.
enum rb_moved rb_gate_judge(const struct rb_median *median, const struct rb_median *low,
                            double floor);

#endif
