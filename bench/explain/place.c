#include "bench/explain/place.h"

#include <math.h>

static const double RATE_LOW = 0.3, RATE_HIGH = 30;

bool rb_place_exists(const struct rb_cell *cell, enum rb_stage stage, int bounce)
{
    return cell->reference->frame.stage[stage][bounce].rays > 0;
}

bool rb_place_rate_is_sane(double instructions_per_ns)
{
    return instructions_per_ns >= RATE_LOW && instructions_per_ns <= RATE_HIGH;
}

static void add_counts(const struct rb_cell *cell, struct rb_place *place)
{
    const struct rb_counts *counts = &cell->counted->table.at[place->stage][place->bounce];
    double rays = (double)cell->counted->sample.stage[place->stage][place->bounce].rays;
    const uint64_t *of = counts->of;
    if (rays == 0) // none in the tiles that were counted
        return;
    place->nodes = (double)of[RB_COUNT_NODES] / rays;
    place->boxes = (double)of[RB_COUNT_BOXES] / rays;
    place->primitives = (double)(of[RB_COUNT_SPHERES] + of[RB_COUNT_TRIANGLES] +
                                 of[RB_COUNT_CONES] + of[RB_COUNT_PLANES]) /
                        rays;
    place->steps = (double)of[RB_COUNT_STEPS] / rays;
    place->lanes_active = (double)of[RB_COUNT_LANES_ACTIVE] / rays;
    place->lane_use_pct = rb_counts_lane_use_pct(counts);
    place->lanes = (double)of[RB_COUNT_LANES_POSSIBLE] / (double)of[RB_COUNT_STEPS];
}

static void add_simulated(const struct rb_cell *cell, struct rb_place *place)
{
    const struct rb_simulated_place *simulated =
        &cell->simulated->place[place->stage][place->bounce];
    place->events = rb_simulated_figures(simulated);
    if (simulated->native_ns_per_ray > 0)
        place->instructions_per_ns = place->events.instructions / simulated->native_ns_per_ray;
}

// What moves data is what would be saved if all of it were in the L1 cache, and nothing accessed.
static void add_energy(const struct rb_cell *cell, struct rb_place *place)
{
    static const enum rb_sim_event moves[] = {RB_SIM_DR,   RB_SIM_DW,   RB_SIM_D1MR, RB_SIM_D1MW,
                                              RB_SIM_ILMR, RB_SIM_DLMR, RB_SIM_DLMW};
    struct rb_simulated_place at_rest = cell->simulated->place[place->stage][place->bounce];
    double joules = rb_energy_model_joules(cell->energy_model, &at_rest);
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++)
        at_rest.events[moves[i]] = 0;
    place->model_nj = 1e9 * joules;
    place->model_moved_pct =
        100 * (1 - rb_energy_model_joules(cell->energy_model, &at_rest) / joules);
}

// In place of what was simulated, where hardware tells the categories.
static void add_hardware(const struct rb_cell *cell, struct rb_place *place)
{
    const struct rb_hardware *hardware = cell->hardware;
    struct rb_hardware_figures f = rb_hardware_figures(hardware, place->stage, place->bounce);
    place->measured = isfinite(f.compute_pct);
    if (!place->measured)
        return;
    place->events = (struct rb_simulated_figures){
        .instructions = rb_hardware_value(hardware, &f, "instructions"),
        .l1_misses = rb_hardware_value(hardware, &f, "l1d_misses"),
        .ll_misses = rb_hardware_value(hardware, &f, "llc_misses"),
        .branch_misses = rb_hardware_value(hardware, &f, "branch_misses"),
        .cycles = rb_hardware_value(hardware, &f, "cycles"),
        .compute_pct = f.compute_pct,
        .memory_stall_pct = f.memory_stall_pct,
        .other_pct = f.other_pct,
    };
    place->compute_stall_pct = f.compute_stall_pct;
    place->instructions_per_ns = place->events.instructions / place->ns;
}

struct rb_place rb_place_of(const struct rb_cell *cell, enum rb_stage stage, int bounce)
{
    const double none = (double)NAN;
    struct rb_place place = {
        .stage = stage,
        .bounce = bounce,
        .rays = (double)cell->reference->frame.stage[stage][bounce].rays,
        .ns = rb_cell_ns_per_ray(cell, stage, bounce).value,
        .share = rb_cell_share(cell, stage, bounce),
        .nodes = none,
        .boxes = none,
        .primitives = none,
        .steps = none,
        .lanes_active = none,
        .lane_use_pct = none,
        .lanes = none,
        .events = {none, none, none, none, none, none, none, none},
        .compute_stall_pct = none,
        .instructions_per_ns = none,
        .model_nj = none,
        .model_moved_pct = none,
    };
    if (cell->counted)
        add_counts(cell, &place);
    if (cell->simulated)
        add_simulated(cell, &place);
    if (cell->simulated && cell->energy_model)
        add_energy(cell, &place);
    if (cell->hardware)
        add_hardware(cell, &place);
    return place;
}

bool rb_place_find_hottest(const struct rb_cell *cell, struct rb_place *hottest)
{
    double most = 0;
    for (int stage = 0; stage < RB_KERNEL_COUNT && rb_cell_has_time(cell); stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            double share = rb_cell_share(cell, (enum rb_stage)stage, bounce);
            if (share > most) {
                most = share;
                *hottest = rb_place_of(cell, (enum rb_stage)stage, bounce);
            }
        }
    return most > 0;
}
