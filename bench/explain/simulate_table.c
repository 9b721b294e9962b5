#include "bench/explain/simulate_table.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

void rb_simulate_print_caches(const struct rb_caches *caches)
{
    const struct {
        const char *name;
        const struct rb_cache_geometry *cache;
    } levels[] = {
        {"L1 instructions", &caches->l1i}, {"L1 data", &caches->l1d}, {"LL", &caches->ll}};
    printf("simulated caches:");
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        char text[32];
        rb_cache_text(levels[i].cache, text);
        printf("%s %s %s%s", i ? "," : "", levels[i].name, text,
               levels[i].cache->rounded ? " (made a power of two of sets)" : "");
    }
    printf("; lines of %" PRIu32 " bytes\n", caches->ll.line_bytes);
    const struct rb_variant *widest = rb_variant_resolve(rb_variant_find("auto"));
    if (widest)
        printf("valgrind has no AVX-512: auto means %s\n", widest->name);
}

// The figures of a line: per ray, and as a share of all that was simulated.
struct figures {
    struct rb_simulated_figures per_ray;
    double share_pct, none;
};

static const struct {
    const char *head;
    int width, decimals;
    size_t offset;
} columns[] = {
#define PER_RAY(field) offsetof(struct figures, per_ray.field)
    {"instructions", 13, 1, PER_RAY(instructions)},
    {"L1 misses", 10, 3, PER_RAY(l1_misses)},
    {"LL misses", 10, 4, PER_RAY(ll_misses)},
    {"br. misses", 11, 3, PER_RAY(branch_misses)},
    {"cycles", 11, 1, PER_RAY(cycles)},
    {"share", 7, 1, offsetof(struct figures, share_pct)},
    {"compute", 8, 1, PER_RAY(compute_pct)},
    {"c.stall", 8, 1, offsetof(struct figures, none)},
    {"m.stall", 8, 1, PER_RAY(memory_stall_pct)},
    {"other", 7, 1, PER_RAY(other_pct)},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

// Stages that have no rays of their own still have a share.
static double cycles_of(struct rb_simulated_place place)
{
    place.rays = 1;
    return rb_simulated_figures(&place).cycles;
}

static void print_place(const struct rb_simulated_place *place, const char *kernel, int bounce,
                        double all_cycles)
{
    const struct figures figures = {
        .per_ray = rb_simulated_figures(place),
        .share_pct = 100.0 * cycles_of(*place) / all_cycles,
        .none = (double)NAN,
    };
    char text[16] = "";
    if (bounce >= 0)
        snprintf(text, sizeof text, "%d", bounce);
    printf("  %-13s %6s", kernel, text);
    if (place->rays)
        printf(" %9" PRIu64, place->rays);
    else
        printf(" %9s", "-");
    for (int c = 0; c < COLUMN_COUNT; c++) {
        double value;
        memcpy(&value, (const char *)&figures + columns[c].offset, sizeof value);
        if (isnan(value))
            printf("%*s", columns[c].width, "-");
        else
            printf("%*.*f", columns[c].width, columns[c].decimals, value);
    }
    printf("\n");
}

void rb_simulate_print(const struct rb_cell *cell)
{
    const struct rb_simulated *simulated = cell->simulated;
    struct rb_simulated_place all = rb_simulated_sum(simulated, -1);
    double cycles = cycles_of(all);
    printf("\n%s, %s: ", cell->reference->scene_name, simulated->row);
    if (simulated->tiles)
        printf("%" PRIu32 " of %" PRIu32 " tiles of %d x %d pixels, ", simulated->tiles,
               simulated->all_tiles, simulated->tile, simulated->tile);
    printf("%.3g instructions\n", (double)all.events[RB_SIM_IR]);
    printf("  %-13s %6s %9s", "kernel", "bounce", "rays");
    for (int c = 0; c < COLUMN_COUNT; c++)
        printf("%*s", columns[c].width, columns[c].head);
    printf("\n");
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            if (simulated->place[stage][bounce].rays)
                print_place(&simulated->place[stage][bounce], rb_stage_names[stage], bounce,
                            cycles);
    for (int stage = RB_KERNEL_COUNT; stage < RB_STAGE_COUNT; stage++) {
        struct rb_simulated_place place = rb_simulated_sum(simulated, stage);
        if (place.laps)
            print_place(&place, rb_stage_names[stage], -1, cycles);
    }
}

static void print_scaling_line(const struct rb_cell *cell)
{
    static const enum rb_stage stages[] = {RB_STAGE_TRACE, RB_STAGE_TRACE_SHADOW};
    printf("  %-16s %-14s %12" PRIu32 " %14.1f", cell->reference->scene_name, cell->simulated->row,
           cell->reference->primitive_count, (double)cell->simulated->tree_bytes / 1024.0);
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        struct rb_simulated_place place = rb_simulated_sum(cell->simulated, (int)stages[i]);
        struct rb_simulated_figures figures = rb_simulated_figures(&place);
        printf(" %10.3f %10.4f", figures.l1_misses, figures.ll_misses);
    }
    printf("\n");
}

void rb_simulate_print_scaling(const struct rb_plan *plan)
{
    const struct rb_reference *last = &plan->references[plan->reference_count - 1];
    if (strcmp(plan->references[0].scene_name, last->scene_name) == 0)
        return;
    printf("\n  %-16s %-14s %12s %14s %21s %21s\n", "misses per ray", "", "primitives",
           "tree in KiB", "trace L1         LL", "trace_shadow L1   LL");
    for (int i = 0; i < plan->cell_count; i++)
        if (plan->cells[i].simulated)
            print_scaling_line(&plan->cells[i]);
}

void rb_simulate_print_notes(void)
{
    printf(
        "\nPer ray, sim: valgrind's callgrind on runs of neighbouring tiles, after one warm pass;\n"
        "L1 misses are those of data, LL (last level) those of data and instructions, br. misses\n"
        "mispredicted branches. cycles, share (of all) and the categories, in percent of cycles,\n"
        "are " RB_SIM_MODEL ", KCachegrind's estimation:\n"
        "  compute  instructions\n"
        "  m.stall  memory stalls: 10 an L1 miss of data, 100 more an LL miss of data\n"
        "  other    10 a mispredicted branch; 10 an L1 miss of instructions, 100 more an LL miss\n"
        "  c.stall  compute stalls: this simulator cannot see them\n"
        "Nor does it see what overlaps, what is prefetched, a cache between L1 and the last\n"
        "level, the TLB; and a SIMD instruction counts as one however wide it is. Believe the\n"
        "counts, compare the cycles between rows of one table, and measure times.\n");
}
