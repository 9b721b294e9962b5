#include "bench/times/render_plan.h"

static double cost(const struct rb_render_cell *cell)
{
    return cell->estimate_s * (cell->warmups + cell->runs);
}

double rb_render_plan_seconds(const struct rb_render_cell *cells, size_t count)
{
    double total = 0;
    for (size_t i = 0; i < count; i++)
        total += cost(&cells[i]);
    return total;
}

static int wanted(double seconds, int runs)
{
    int most = seconds >= RB_LONG_S ? 1 : seconds >= RB_SHORT_S ? RB_RUNS_MEDIUM : runs;
    return runs < most ? runs : most;
}

// The long cell whose time is needed: the cheapest that frees `excess_s`, or else the dearest. NULL
// if there is no more to give way.
static struct rb_render_cell *to_give_way(struct rb_render_cell *cells, size_t count,
                                          double excess_s)
{
    struct rb_render_cell *chosen = NULL;
    for (struct rb_render_cell *cell = cells; cell < cells + count; cell++) {
        if (cell->runs == 0 || cell->estimate_s < RB_SHORT_S)
            continue;
        bool enough = cost(cell) >= excess_s;
        bool chosen_enough = chosen && cost(chosen) >= excess_s;
        if (!chosen || (enough && !chosen_enough) ||
            (enough ? cost(cell) < cost(chosen) : !chosen_enough && cost(cell) > cost(chosen)))
            chosen = cell;
    }
    return chosen;
}

double rb_render_plan(struct rb_render_cell *cells, size_t count, int runs, double budget_s)
{
    for (size_t i = 0; i < count; i++) {
        cells[i].warmups = cells[i].estimate_s < RB_LONG_S;
        cells[i].runs = wanted(cells[i].estimate_s, runs);
    }
    struct rb_render_cell *victim;
    double total;
    while ((total = rb_render_plan_seconds(cells, count)) > budget_s &&
           (victim = to_give_way(cells, count, total - budget_s)) != NULL)
        victim->runs = victim->warmups = 0;
    for (int most = runs - 1; most >= 1 && rb_render_plan_seconds(cells, count) > budget_s; most--)
        for (size_t i = 0; i < count; i++)
            cells[i].runs = cells[i].runs > most ? most : cells[i].runs;
    return rb_render_plan_seconds(cells, count);
}

double rb_render_extrapolate(double small_s, double small, double medium_s, double medium,
                             double full)
{
    double pixel_s = (medium_s - small_s) / (medium - small);
    return medium_s + (pixel_s > 0 ? pixel_s : 0) * (full - medium);
}
