// What the render-time table measures, and how often, within a budget.
#ifndef RB_TIMES_RENDER_PLAN_H
#define RB_TIMES_RENDER_PLAN_H

#include "render/variants.h"
#include "scene/generate.h"

#include <stdbool.h>
#include <stddef.h>

// A run of more than RB_LONG_S seconds is not repeated, one of less than RB_SHORT_S always is.
#define RB_SHORT_S 1.0
#define RB_LONG_S  10.0

enum { RB_RUNS_DEFAULT = 10, RB_RUNS_MEDIUM = 3 };

// One row of the table to be.
struct rb_render_cell {
    const struct rb_preset *scene;
    const struct rb_variant *variant;
    double estimate_s; // of one run
    int warmups, runs; // to do; 0 runs: the estimate has to do
};

// Chooses warm-ups and runs for `count` cells whose estimates are known, `runs` of what is short,
// so that all of it takes no longer than `budget_s`. Where that is too little, first the runs of a
// second and more give way to their estimates, as few as need be; then all others are repeated less
// often, but run once even if the budget is exceeded. Returns the seconds all of it will take.
double rb_render_plan(struct rb_render_cell *cells, size_t count, int runs, double budget_s);

// Seconds that the cells will take as planned.
double rb_render_plan_seconds(const struct rb_render_cell *cells, size_t count);

// The time of a whole process that renders `full` pixels, from those of two small images of the
// same view: start-up, loading and building, which all have, plus a time per pixel. The pixels of
// a small image are a regular sample of those of the large one.
double rb_render_extrapolate(double small_s, double small, double medium_s, double medium,
                             double full);

#endif
