#include "bench/explain/explain_table.h"

#include "bench/explain/hardware_table.h"
#include "bench/explain/place.h"
#include "bench/explain/wrap.h"

#include <math.h>
#include <stdio.h>

static const struct {
    const char *title;
    int width;
} columns[] = {
    {"rays", 8},    {"ns/ray", 8},    {"time %", 6},   {"nodes", 6},   {"boxes", 7},
    {"prims", 6},   {"steps", 7},     {"lanes %", 7},  {"instr.", 8},  {"L1 miss", 8},
    {"LL miss", 8}, {"br. miss", 8},  {"compute", 7},  {"c.stall", 7}, {"m.stall", 7},
    {"other", 6},   {"instr./ns", 9}, {"nJ model", 8},
};

enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

// Three digits or so; what is not known is a dash.
static void print_cell(double value, int width)
{
    double size = fabs(value);
    int digits = size >= 100 || value == 0 ? 0 : size >= 9.995 ? 1 : size >= 0.0995 ? 2 : 4;
    if (isfinite(value))
        printf(" %*.*f", width, digits, value);
    else
        printf(" %*s", width, "-");
}

static void print_place(const struct rb_place *p)
{
    const double values[COLUMN_COUNT] = {
        p->rays,
        p->ns,
        100.0 * p->share,
        p->nodes,
        p->boxes,
        p->primitives,
        p->steps,
        p->lane_use_pct,
        p->events.instructions,
        p->events.l1_misses,
        p->events.ll_misses,
        p->events.branch_misses,
        p->events.compute_pct,
        p->compute_stall_pct,
        p->events.memory_stall_pct,
        p->events.other_pct,
        p->instructions_per_ns,
        p->model_nj,
    };
    printf("  %-12s %6d", rb_stage_names[p->stage], p->bounce);
    for (int c = 0; c < COLUMN_COUNT; c++)
        print_cell(values[c], columns[c].width);
    printf("\n");
}

void rb_explain_print_table(const struct rb_cell *cell)
{
    printf("\n%s, %s\n  %-12s %6s", cell->reference->scene_name, cell->variant->name, "kernel",
           "bounce");
    for (int c = 0; c < COLUMN_COUNT; c++)
        printf(" %*s", columns[c].width, columns[c].title);
    printf("\n");
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            if (rb_place_exists(cell, (enum rb_stage)stage, bounce)) {
                struct rb_place place = rb_place_of(cell, (enum rb_stage)stage, bounce);
                print_place(&place);
            }
    if (cell->hardware) {
        printf("  counted in frames of a process of its own:\n");
        rb_hardware_table_print(cell->hardware);
    }
}

// True if the place has a rate that no processor has, which is then told.
static bool tell_rate(const struct rb_cell *cell, const struct rb_place *place)
{
    double rate = place->instructions_per_ns;
    bool strange = isfinite(rate) && !rb_place_rate_is_sane(rate);
    if (strange)
        printf("%s, %s, %s at bounce %d: %.3g instructions a ns are not what a processor does; do "
               "not trust its simulation or its time.\n",
               cell->reference->scene_name, cell->variant->name, rb_stage_names[place->stage],
               place->bounce, rate);
    return strange;
}

void rb_explain_print_rates(const struct rb_plan *plan)
{
    double low = (double)INFINITY, high = 0;
    int strange = 0;
    printf("\n");
    for (int i = 0; i < plan->cell_count; i++)
        for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
            for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
                const struct rb_cell *cell = &plan->cells[i];
                if (!rb_place_exists(cell, (enum rb_stage)stage, bounce))
                    continue;
                struct rb_place place = rb_place_of(cell, (enum rb_stage)stage, bounce);
                strange += tell_rate(cell, &place);
                low = fmin(low, place.instructions_per_ns);
                high = fmax(high, place.instructions_per_ns);
            }
    if (!strange && high > 0)
        printf("Instructions and times fit: all rates, %.3g to %.3g instructions a ns, are what a "
               "processor can do.\n",
               low, high);
}

void rb_explain_print_notes(const struct rb_energy_model *model)
{
    char text[640];
    printf(
        "\nmeasured   ns/ray: median over processes; time %%: share of the frame's thread time\n"
        "count      per ray, exact: inner nodes visited, boxes and primitives tested; steps:\n"
        "           nodes, primitives, surfaces handled by one operation for all lanes of a\n"
        "           packet; lanes %%: of the lanes in these steps, those whose result was needed\n"
        "sim        per ray, valgrind's callgrind on runs of neighbouring tiles after a warm\n"
        "           pass: instructions (a SIMD instruction is one), misses of the L1 data cache\n"
        "           and of the last level, mispredicted branches\n"
        "model:callgrind   percent of the cycles KCachegrind estimates from these events\n"
        "  compute  a cycle an instruction: executing, were there nothing to wait for\n"
        "  c.stall  compute stall, waiting for the result of an instruction that is no load: the\n"
        "           simulator cannot see it; what it hides is in compute, or in a low rate\n"
        "  m.stall  memory stall, waiting for a load: 10 cycles an L1 miss of data, 100 more an\n"
        "           LL miss\n"
        "  other    10 cycles a mispredicted branch; instruction misses as those of data\n"
        "instr./ns  simulated instructions over the native time of the same tiles: divided by the\n"
        "           clock in GHz it is instructions a cycle. The simulator sees neither overlap\n"
        "           nor prefetching, and its branch predictor is a simple one, so a kernel may\n"
        "           be faster than its modelled cycles.\n");
    if (!model)
        return;
    rb_energy_model_describe(model, text);
    printf("nJ model   energy a ray\n");
    rb_wrap_print(11, text);
    rb_wrap_print(11, model->prose);
}
