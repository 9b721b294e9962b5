// What a simulator has seen of the pipeline's stages, and the cycles modelled from it.
//
// The simulator is valgrind's callgrind (Weidendorfer, Kowarschik, Trinitis 2004, "A Tool Suite for
// Simulation Based Analysis of Memory Access Behavior"): instructions one by one, two levels of
// cache with LRU, a predictor of branches. It sees no compute stalls, no overlap of misses with
// other work, no prefetching, no second level between L1 and the last one, no TLB; and a SIMD
// instruction counts as one, whatever its width.
//
// The model is KCachegrind's cycle estimation, CEst = Ir + 10 Bm + 10 L1m + 100 LLm:
//
//     compute       Ir
//     memory stall  10 (D1mr + D1mw) + 100 (DLmr + DLmw)
//     other         10 (Bcm + Bim) + 10 I1mr + 100 ILmr
//
// Compute stalls are not in it, and nothing here pretends that they are 0.
#ifndef RB_SIMULATE_SIMULATED_H
#define RB_SIMULATE_SIMULATED_H

#include "bench/simulate/caches.h"
#include "measure/probe.h"

// Callgrind's events: Instructions, Data, Branches (conditional, indirect); read, written; misses
// of the first (1) and the last level (L), mispredictions.
enum rb_sim_event {
    RB_SIM_IR,
    RB_SIM_DR,
    RB_SIM_DW,
    RB_SIM_I1MR,
    RB_SIM_D1MR,
    RB_SIM_D1MW,
    RB_SIM_ILMR,
    RB_SIM_DLMR,
    RB_SIM_DLMW,
    RB_SIM_BC,
    RB_SIM_BCM,
    RB_SIM_BI,
    RB_SIM_BIM,
    RB_SIM_EVENT_COUNT,
};

extern const char *const rb_sim_event_names[RB_SIM_EVENT_COUNT];

// A stage at a bounce. No laps: it was not simulated.
struct rb_simulated_place {
    uint64_t rays, laps;
    uint64_t events[RB_SIM_EVENT_COUNT];
    double native_ns_per_ray; // of the same tiles on the machine itself; 0: not known
};

struct rb_simulated {
    struct rb_simulated_place place[RB_STAGE_COUNT][RB_BOUNCE_MAX];
    struct rb_caches caches;
    uint64_t hits_hash; // of the work that was simulated
    char row[33];       // that did it
    char simulator[33]; // "callgrind-3.19.0"
    // Where tiles of a frame were simulated, else 0:
    uint32_t tiles, all_tiles;
    int tile; // edge in pixels
    uint64_t tree_bytes;
};

// Where the numbers come from, as results say it.
#define RB_SIM_SOURCE "sim"
#define RB_SIM_MODEL  "model:callgrind"

// Per ray, NaN where there are no rays; and shares of the modelled cycles, which add up to 100 %.
struct rb_simulated_figures {
    double instructions;
    double l1_misses; // of data
    double ll_misses; // of data and instructions
    double branch_misses;
    double cycles; // modelled
    double compute_pct, memory_stall_pct, other_pct;
};
struct rb_simulated_figures rb_simulated_figures(const struct rb_simulated_place *place);

// Where the numbers come from, in a line: the simulator, its caches, the tiles.
enum { RB_SIMULATED_TEXT = 256 };
void rb_simulated_describe(const struct rb_simulated *simulated, char text[RB_SIMULATED_TEXT]);

// A stage at all bounces together, or with stage -1 everything.
struct rb_simulated_place rb_simulated_sum(const struct rb_simulated *simulated, int stage);

#endif
