#include "bench/explain/count_table.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

// A column: counters that are added up and divided by the rays.
struct column {
    const char *name;
    enum rb_counter counter;
    int width;
};

static const struct column columns[] = {
    {"nodes", RB_COUNT_NODES, 7},
    {"boxes", RB_COUNT_BOXES, 8},
    {"spheres", RB_COUNT_SPHERES, 8},
    {"triangles", RB_COUNT_TRIANGLES, 9},
    {"cones", RB_COUNT_CONES, 7},
    {"planes", RB_COUNT_PLANES, 7},
    {"hits", RB_COUNT_HITS, 5},
    {"occluded", RB_COUNT_OCCLUDED, 8},
    {"shadings", RB_COUNT_SHADINGS, 8},
    {"tree B", RB_COUNT_TREE_BYTES, 7},
    {"prim. B", RB_COUNT_PRIMITIVE_BYTES, 8},
    {"steps", RB_COUNT_STEPS, 8},
};

enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

static uint64_t rays_of(const struct rb_cell *cell, int stage, int bounce)
{
    return cell->counted->sample.stage[stage][bounce].rays;
}

// Does any kernel of the cell count this?
static bool is_used(const struct rb_cell *cell, enum rb_counter counter)
{
    bool used = false;
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            used = used || cell->counted->table.at[stage][bounce].of[counter];
    return used;
}

static void print_per_ray(uint64_t count, double rays, int width)
{
    double value = (double)count / rays;
    if (count == 0)
        printf(" %*s", width, "-");
    else
        printf(" %*.*f", width, value < 9.995 ? 2 : value < 99.95 ? 1 : 0, value);
}

static void print_place(const struct rb_cell *cell, int stage, int bounce)
{
    const struct rb_counts *counts = &cell->counted->table.at[stage][bounce];
    double rays = (double)rays_of(cell, stage, bounce);
    printf("  %-12s %6d %9.0f", rb_stage_names[stage], bounce, rays);
    for (int c = 0; c < COLUMN_COUNT; c++)
        if (is_used(cell, columns[c].counter))
            print_per_ray(counts->of[columns[c].counter], rays, columns[c].width);
    printf(" %8.1f", rb_counts_lane_use_pct(counts));
    print_per_ray(counts->of[RB_COUNT_STACK], rays, 6);
    if (counts->stack_max)
        printf(" %9" PRIu64, counts->stack_max);
    else
        printf(" %9s", "-");
    printf("\n");
}

void rb_count_table_print(const struct rb_cell *cell)
{
    if (!cell->counted)
        return;
    printf("\n%s, %s: counts per ray%s\n  %-12s %6s %9s", cell->reference->scene_name,
           cell->variant->name, cell->group_tiles ? " of a random group of small tiles" : "",
           "kernel", "bounce", "rays");
    for (int c = 0; c < COLUMN_COUNT; c++)
        if (is_used(cell, columns[c].counter))
            printf(" %*s", columns[c].width, columns[c].name);
    printf(" %8s %6s %9s\n", "lanes %", "stack", "stack max");
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            if (rays_of(cell, stage, bounce))
                print_place(cell, stage, bounce);
}

void rb_count_table_print_notes(void)
{
    printf(
        "\nPer ray, counted by the kernels themselves, compiled a second time for that:\n"
        "  nodes     inner nodes visited          boxes     children of nodes and own boxes of\n"
        "                                                   primitives that were tested\n"
        "  spheres, triangles, cones, planes      tested: the ray passes their own box\n"
        "  shadings  surface points lit by a light sample\n"
        "  tree B, prim. B   bytes read from nodes and leaves, and from primitives, once a step\n"
        "  steps     nodes, primitives, surfaces handled by one operation for all lanes\n"
        "  lanes %%   of the lanes there were in the steps, those whose result was needed\n"
        "  stack     deepest stack of a traversal, mean over rays; stack max: of all rays\n");
}
