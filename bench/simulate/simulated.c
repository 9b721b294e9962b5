#include "bench/simulate/simulated.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

const char *const rb_sim_event_names[RB_SIM_EVENT_COUNT] = {
    "Ir", "Dr", "Dw", "I1mr", "D1mr", "D1mw", "ILmr", "DLmr", "DLmw", "Bc", "Bcm", "Bi", "Bim",
};

// Cycles of KCachegrind's estimation.
static const double L1_MISS = 10, LL_MISS = 100, BRANCH_MISS = 10;

static double sum(const struct rb_simulated_place *place, enum rb_sim_event a, enum rb_sim_event b)
{
    return (double)place->events[a] + (double)place->events[b];
}

struct rb_simulated_figures rb_simulated_figures(const struct rb_simulated_place *place)
{
    double rays = place->rays ? (double)place->rays : (double)NAN;
    double compute = (double)place->events[RB_SIM_IR];
    double branch_misses = sum(place, RB_SIM_BCM, RB_SIM_BIM);
    double l1_misses = sum(place, RB_SIM_D1MR, RB_SIM_D1MW);
    double ll_misses = sum(place, RB_SIM_DLMR, RB_SIM_DLMW);
    double ll_fetches = (double)place->events[RB_SIM_ILMR];
    double memory = L1_MISS * l1_misses + LL_MISS * ll_misses;
    double other = BRANCH_MISS * branch_misses + L1_MISS * (double)place->events[RB_SIM_I1MR] +
                   LL_MISS * ll_fetches;
    double cycles = compute + memory + other;
    double percent = cycles > 0 ? 100.0 / cycles : (double)NAN;
    return (struct rb_simulated_figures){
        .instructions = compute / rays,
        .l1_misses = l1_misses / rays,
        .ll_misses = (ll_misses + ll_fetches) / rays,
        .branch_misses = branch_misses / rays,
        .cycles = cycles / rays,
        .compute_pct = percent * compute,
        .memory_stall_pct = percent * memory,
        .other_pct = percent * other,
    };
}

void rb_simulated_describe(const struct rb_simulated *simulated, char text[RB_SIMULATED_TEXT])
{
    char l1i[32], l1d[32], ll[32];
    rb_cache_text(&simulated->caches.l1i, l1i);
    rb_cache_text(&simulated->caches.l1d, l1d);
    rb_cache_text(&simulated->caches.ll, ll);
    snprintf(text, RB_SIMULATED_TEXT,
             "%s; %s; L1 instructions %s; L1 data %s; LL %s; %" PRIu32 " of %" PRIu32
             " tiles of edge %d",
             simulated->simulator, simulated->row, l1i, l1d, ll, simulated->tiles,
             simulated->all_tiles, simulated->tile);
}

struct rb_simulated_place rb_simulated_sum(const struct rb_simulated *simulated, int stage)
{
    struct rb_simulated_place total = {0};
    for (int s = 0; s < RB_STAGE_COUNT; s++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            const struct rb_simulated_place *place = &simulated->place[s][bounce];
            if (stage >= 0 && s != stage)
                continue;
            total.rays += place->rays;
            total.laps += place->laps;
            for (int event = 0; event < RB_SIM_EVENT_COUNT; event++)
                total.events[event] += place->events[event];
        }
    return total;
}
