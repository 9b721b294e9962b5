// All that is known of one kernel at one bounce of a cell: time, counts, simulation, per ray. What
// is not known is NaN.
#ifndef RB_EXPLAIN_PLACE_H
#define RB_EXPLAIN_PLACE_H

#include "bench/run/cell.h"

struct rb_place {
    enum rb_stage stage;
    int bounce;
    double rays;                        // in a frame
    double ns, share;                   // per ray; of the frame's thread time
    double nodes, boxes, primitives;    // counted
    double steps, lanes_active;         // counted
    double lane_use_pct, lanes;         // counted; lanes a step has
    bool measured;                      // are events and categories those of hardware?
    struct rb_simulated_figures events; // simulated, or counted by hardware
    double compute_stall_pct;           // of hardware alone
    double instructions_per_ns;         // of the same tiles, or places
    double model_nj, model_moved_pct;   // modelled energy, and the share of it that moves data
};

// Is there anything to know: does the frame have such rays?
bool rb_place_exists(const struct rb_cell *cell, enum rb_stage stage, int bounce);
struct rb_place rb_place_of(const struct rb_cell *cell, enum rb_stage stage, int bounce);

// The place that takes most of the frame's time. False if nothing was timed.
bool rb_place_find_hottest(const struct rb_cell *cell, struct rb_place *hottest);

// Can a processor do that many instructions a nanosecond? From 0.3, an instruction in three cycles
// at 1 GHz, to 30, five a cycle at 6 GHz.
bool rb_place_rate_is_sane(double instructions_per_ns);

#endif
