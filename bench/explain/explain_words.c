// The table in words. Every sentence is a rule over the numbers of one or two places; a number that
// is not known leaves its sentence out.
#define _POSIX_C_SOURCE 200809L
#include "bench/explain/explain_table.h"
#include "bench/explain/place.h"
#include "bench/explain/wrap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Three digits or more, but no exponent; ? for what is not known.
static const char *format(double value, char text[24])
{
    snprintf(text, 24, isnan(value) ? "?" : value >= 1000 ? "%.0f" : "%.3g", value);
    return text;
}

// A factor is worth a word from here on.
static const double NOTABLE = 1.15;

// A category is the cause from here on, in percent.
static const double DOMINANT = 35;

static double all_rays(const struct rb_cell *cell)
{
    double rays = 0;
    for (int stage = RB_STAGE_TRACE; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            rays += (double)cell->reference->frame.stage[stage][bounce].rays;
    return rays;
}

static void say_where(FILE *out, const struct rb_cell *cell, const struct rb_place *hot)
{
    char ns[24];
    double rays_pct = 100.0 * hot->rays / all_rays(cell), time_pct = 100.0 * hot->share;
    fprintf(
        out,
        "%s spends most in %s at bounce %d: %.0f %% of its time on %.0f %% of the queue entries "
        "of trace, shade and trace_shadow, %s ns each. ",
        cell->variant->name, rb_stage_names[hot->stage], hot->bounce, time_pct, rays_pct,
        format(hot->ns, ns));
    fprintf(out, "%s. ",
            time_pct > NOTABLE * rays_pct   ? "It is the price of a ray that makes it so"
            : rays_pct > NOTABLE * time_pct ? "It is their number that makes it so, not their price"
                                            : "Number and price are about average");
}

static void say_work(FILE *out, const struct rb_place *hot)
{
    char number[24];
    if (isnan(hot->steps))
        return;
    if (hot->nodes > 0)
        fprintf(out, "A ray visits %.3g nodes and tests %.3g boxes and %.3g primitives", hot->nodes,
                hot->boxes, hot->primitives);
    else if (hot->boxes > 0)
        fprintf(out, "A ray tests %s boxes and %.3g primitives", format(hot->boxes, number),
                hot->primitives);
    else
        fprintf(out, "A ray takes %.3g steps", hot->steps);
    if (hot->lanes > 1)
        fprintf(out, ", in steps of %.0f lanes of which %.0f %% are of use", hot->lanes,
                hot->lane_use_pct);
    if (isfinite(hot->events.instructions))
        fprintf(out, "; that takes %s instructions", format(hot->events.instructions, number));
    if (isfinite(hot->events.instructions) && hot->steps > 0)
        fprintf(out, ", %.3g a step", hot->events.instructions / hot->steps);
    fprintf(out, ". ");
}

static void say_categories(FILE *out, const struct rb_place *hot)
{
    const struct rb_simulated_figures *e = &hot->events;
    char l1[24], ll[24], branches[24];
    if (isnan(e->compute_pct))
        return;
    fprintf(out, "Of the %s cycles %.0f %% are instructions, ",
            hot->measured ? "measured" : "modelled", e->compute_pct);
    if (hot->measured)
        fprintf(out, "%.0f %% wait for results, ", hot->compute_stall_pct);
    fprintf(out,
            "%.0f %% wait for memory (%s misses of L1 a ray, %s of the last level), %.0f %% are "
            "other, mostly mispredicted branches (%s a ray). ",
            e->memory_stall_pct, format(e->l1_misses, l1), format(e->ll_misses, ll), e->other_pct,
            format(e->branch_misses, branches));
    if (hot->measured && hot->compute_stall_pct >= DOMINANT)
        fprintf(out, "It is bound by waiting for results: more rays at once would fill the gaps. ");
    else if (e->memory_stall_pct >= DOMINANT)
        fprintf(out, "It is bound by memory: smaller nodes, or rays in another order. ");
    else if (e->other_pct >= DOMINANT)
        fprintf(out, "It is bound by branches: decide for more rays or boxes at once. ");
    else if (hot->lanes > 1 && hot->lane_use_pct < 50)
        fprintf(out, "It is bound by instructions, and of their lanes most are idle: rays that "
                     "belong together would help, memory would not. ");
    else
        fprintf(out, "It is bound by instructions: %s would help, memory would not. ",
                hot->nodes > 0   ? "fewer nodes a ray, or fewer instructions a node,"
                : hot->boxes > 0 ? "fewer boxes a ray, as in a tree,"
                                 : "fewer of them a step, or more lanes,");
}

// "2.1 times the nodes", if that is worth it.
static void say_factor(FILE *out, bool *any, double factor, const char *what)
{
    if (!isfinite(factor) || factor < NOTABLE)
        return;
    fprintf(out, "%s%.3g times the %s", *any ? ", " : "", factor, what);
    *any = true;
}

// How the same kernel changes with the bounces.
static void say_growth(FILE *out, const struct rb_cell *cell, const struct rb_place *hot)
{
    int last = hot->bounce;
    while (last + 1 < RB_BOUNCE_MAX && rb_place_exists(cell, hot->stage, last + 1))
        last++;
    if (last == hot->bounce)
        return;
    struct rb_place deep = rb_place_of(cell, hot->stage, last);
    bool any = false;
    if (!(deep.ns > NOTABLE * hot->ns)) {
        fprintf(out, "At bounce %d a ray costs %.2g times as much. ", last, deep.ns / hot->ns);
        return;
    }
    fprintf(out, "At bounce %d a ray costs %.2g times as much: ", last, deep.ns / hot->ns);
    say_factor(out, &any, deep.nodes / hot->nodes, "nodes");
    say_factor(out, &any, deep.steps / hot->steps, "steps");
    say_factor(out, &any, deep.events.instructions / hot->events.instructions, "instructions");
    say_factor(out, &any, deep.events.branch_misses / hot->events.branch_misses,
               "mispredicted branches");
    say_factor(out, &any, deep.events.l1_misses / hot->events.l1_misses, "L1 misses");
    if (deep.lanes > 1 && deep.lane_use_pct * NOTABLE < hot->lane_use_pct)
        fprintf(out, "%s%.0f %% of the lanes in use", any ? ", and " : "", deep.lane_use_pct);
    else if (!any)
        fprintf(out, "for no reason that these numbers show");
    double before = hot->instructions_per_ns, after = deep.instructions_per_ns;
    if (before > NOTABLE * after)
        fprintf(out,
                "; and the processor gets through %.3g instructions a ns instead of %.3g, which is "
                "what the model does not see: the true price of mispredicted branches, and stalls",
                after, before);
    fprintf(out, ". ");
}

static void say_energy(FILE *out, const struct rb_cell *cell, const struct rb_place *hot)
{
    char nj[24];
    double all = 0;
    for (int stage = 0; stage < RB_KERNEL_COUNT && isfinite(hot->model_nj); stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            struct rb_place place = rb_place_of(cell, (enum rb_stage)stage, bounce);
            all += isfinite(place.model_nj) ? place.rays * place.model_nj : 0;
        }
    if (all > 0)
        fprintf(out,
                "By %s a ray takes %s nJ there, %.0f %% of the energy of all kernels, and %.0f %% "
                "of that moves data. ",
                cell->energy_model->label, format(hot->model_nj, nj),
                100 * hot->rays * hot->model_nj / all, hot->model_moved_pct);
}

// What the row brings over the one it builds on, in the same place.
static void say_gain(FILE *out, const struct rb_cell *base, const struct rb_place *hot)
{
    struct rb_place before = rb_place_of(base, hot->stage, hot->bounce);
    bool any = false;
    if (!isfinite(before.ns) || !isfinite(hot->ns))
        return;
    fprintf(out, "In this place it is %.3g times as fast as %s, which has ", before.ns / hot->ns,
            base->variant->name);
    say_factor(out, &any, before.boxes / hot->boxes, "boxes");
    say_factor(out, &any, before.steps / hot->steps, "steps");
    say_factor(out, &any, before.events.instructions / hot->events.instructions, "instructions");
    say_factor(out, &any, before.events.branch_misses / hot->events.branch_misses,
               "mispredicted branches");
    fprintf(out, "%s. ", any ? "" : "about the same counts");
}

static void say_rate(FILE *out, const struct rb_place *hot)
{
    double rate = hot->instructions_per_ns;
    if (!isfinite(rate))
        return;
    if (rb_place_rate_is_sane(rate))
        fprintf(out, "%.3g instructions a ns are what a processor can do.", rate);
    else
        fprintf(out,
                "%.3g instructions a ns are not what a processor does: do not trust this row's "
                "simulation or its time.",
                rate);
}

void rb_explain_print_words(const struct rb_cell *cell, const struct rb_cell *base)
{
    struct rb_place hot;
    char *text = NULL;
    size_t size;
    FILE *out = rb_place_find_hottest(cell, &hot) ? open_memstream(&text, &size) : NULL;
    if (!out)
        return;
    say_where(out, cell, &hot);
    say_work(out, &hot);
    say_categories(out, &hot);
    say_growth(out, cell, &hot);
    say_energy(out, cell, &hot);
    if (base)
        say_gain(out, base, &hot);
    say_rate(out, &hot);
    fclose(out);
    printf("\n");
    rb_wrap_print(0, text);
    free(text);
}
