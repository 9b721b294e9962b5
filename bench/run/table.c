#include "bench/run/table.h"

#include "bench/run/results.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TABLES_MAX = 64 };

// The cells of one table.
struct view {
    const struct rb_cell *cells[256];
    int count;
    int bounces;
};

static struct view select_cells(const struct rb_plan *plan, const struct rb_reference *reference,
                                int side)
{
    struct view view = {.count = 0};
    for (int i = 0; i < plan->cell_count && view.count < 256; i++) {
        const struct rb_cell *cell = &plan->cells[i];
        if (cell->reference == reference && cell->side == side)
            view.cells[view.count++] = cell;
    }
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        if (reference->frame.stage[RB_STAGE_TRACE][bounce].rays)
            view.bounces = bounce + 1;
    return view;
}

// The cell of the row's baseline with the same settings; a serial baseline has one thread.
static const struct rb_cell *baseline_of(const struct view *view, const struct rb_cell *cell)
{
    for (int i = 0; i < view->count; i++) {
        const struct rb_cell *other = view->cells[i];
        bool same_threads = other->settings.threads == cell->settings.threads ||
                            !rb_variant_parallel(other->variant);
        bool same_tile = other->settings.tile == cell->settings.tile || other->group_tiles;
        if (strcmp(other->variant->name, cell->variant->baseline) == 0 && other != cell &&
            same_threads && same_tile && rb_cell_has_time(other))
            return other;
    }
    return NULL;
}

// Four digits, but no exponent.
static const char *format(double value, char text[24])
{
    snprintf(text, 24, value >= 1000 ? "%.0f" : "%.4g", value);
    return text;
}

static void print_frame(const struct view *view, const struct rb_cell *cell, double probe_ns)
{
    const struct rb_cell *base = baseline_of(view, cell);
    char flags[128], interval[64] = "-", value[24], low[24], high[24];
    printf("  %-18s ", cell->variant->name);
    if (!rb_cell_has_time(cell)) {
        bool needs = cell->state == RB_CELL_UNAVAILABLE;
        printf("%7s   %s%s%s\n", "-", rb_cell_note(cell), needs ? ": needs " : "",
               needs ? cell->variant->needs : "");
        return;
    }
    struct rb_figure frame = rb_cell_frame_ns(cell);
    if (isfinite(frame.low))
        snprintf(interval, sizeof interval, "%s to %s", format(frame.low * 1e-6, low),
                 format(frame.high * 1e-6, high));
    printf("%7d %4d %10s  %-22s %8.3f", cell->settings.threads, cell->settings.tile,
           format(frame.value * 1e-6, value), interval, cell->reference->rays / frame.value * 1e3);
    if (base)
        printf("  %8.2f x %-16s", rb_cell_frame_ns(base).value / frame.value, base->variant->name);
    else
        printf("  %8s   %-16s", "", "");
    rb_cell_flags(cell, false, probe_ns, flags);
    printf(" %2" PRIu32 "  %s\n", cell->process_count, flags);
}

// Which kernel at which bounce takes most of the row's time, and how sure that is.
static void print_hot_spot(const struct rb_cell *cell, int bounces)
{
    struct rb_line most = {.share = 0}, second = {.share = 0};
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < bounces; bounce++) {
            struct rb_line line = rb_results_line(cell, (enum rb_stage)stage, bounce);
            if (line.share > most.share) {
                second = most;
                most = line;
            } else if (line.share > second.share) {
                second = line;
            }
        }
    if (!most.kernel)
        return;
    char value[24], low[24], high[24];
    printf("  %-18s %s at bounce %d: %.0f %% of the time, %s ns per ray", cell->variant->name,
           most.kernel, most.bounce, 100.0 * most.share, format(most.per_ray.value, value));
    if (isfinite(most.per_ray.low))
        printf(" (%s to %s)", format(most.per_ray.low, low), format(most.per_ray.high, high));
    if (second.kernel)
        printf("; then %s at bounce %d: %.0f %%", second.kernel, second.bounce,
               100.0 * second.share);
    printf("\n");
}

static void print_grid(const struct rb_cell *cell, int bounces)
{
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++) {
        printf("  %-18s %-14s", stage ? "" : cell->variant->name, rb_stage_names[stage]);
        for (int bounce = 0; bounce < bounces; bounce++) {
            double ns = rb_cell_ns_per_ray(cell, (enum rb_stage)stage, bounce).value;
            if (isfinite(ns))
                printf(" %9.1f", ns);
            else
                printf(" %9s", "-");
        }
        printf("\n");
    }
}

static void print_ray_counts(const struct rb_reference *reference, int bounces)
{
    static const struct {
        const char *name;
        enum rb_stage stage;
    } lines[] = {{"rays traced", RB_STAGE_TRACE}, {"shadow rays", RB_STAGE_TRACE_SHADOW}};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        printf("  %-33s", lines[i].name);
        for (int bounce = 0; bounce < bounces; bounce++)
            printf(" %9" PRIu64, reference->frame.stage[lines[i].stage][bounce].rays);
        printf("\n");
    }
}

// How many times as fast per ray as in the baseline row, where that is certain: the intervals do
// not overlap.
static void print_gain(const struct rb_cell *cell, const struct rb_cell *base, enum rb_stage stage,
                       int bounce)
{
    struct rb_figure a = rb_cell_ns_per_ray(base, stage, bounce);
    struct rb_figure b = rb_cell_ns_per_ray(cell, stage, bounce);
    bool known = isfinite(a.low) && isfinite(b.low);
    if (known && (a.low > b.high || a.high < b.low))
        printf(" %9.2f", a.value / b.value);
    else
        printf(" %9s", known ? "=" : isfinite(b.value) ? "?" : "-");
}

static void print_gain_lines(const struct rb_cell *cell, const struct rb_cell *base, int bounces)
{
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++) {
        char name[48] = "";
        if (stage < 2)
            snprintf(name, sizeof name, stage ? "  over %s" : "%s",
                     stage ? base->variant->name : cell->variant->name);
        printf("  %-18s %-14s", name, rb_stage_names[stage]);
        for (int bounce = 0; bounce < bounces; bounce++)
            print_gain(cell, base, (enum rb_stage)stage, bounce);
        printf("\n");
    }
}

// What each serial row brings, kernel by kernel: parallel rows run the same kernels.
static void print_gains(const struct view *view)
{
    bool begun = false;
    for (int i = 0; i < view->count; i++) {
        const struct rb_cell *cell = view->cells[i], *base = baseline_of(view, cell);
        if (!base || rb_variant_parallel(cell->variant) || !rb_cell_has_time(cell))
            continue;
        if (!begun)
            printf("\n  %-18s %-14s  (= the 95 %% intervals overlap, ? there are none)\n",
                   "x as fast per ray", "");
        begun = true;
        print_gain_lines(cell, base, view->bounces);
    }
}

void rb_table_print(const struct rb_plan *plan, const struct rb_reference *reference, int side,
                    double probe_ns)
{
    const struct view view = select_cells(plan, reference, side);
    const struct rb_settings *s = &reference->settings;
    printf("\n%s: %d x %d, depth %d, %" PRIu32 " primitives, %.0f rays a frame\n",
           reference->scene_name, s->width, s->height, s->depth, reference->primitive_count,
           reference->rays);
    printf("  reference: %s\n", strcmp(reference->made_by, "bvh") == 0
                                    ? "bvh, which agreed with naive on a random sample of tiles"
                                : reference->cached ? "naive, in full, kept from an earlier run"
                                                    : "naive, in full");
    printf("\n  %-18s %7s %4s %10s  %-22s %8s  %-27s %2s  %s\n", "variant", "threads", "tile",
           "ms/frame", "95 % interval", "Mrays/s", "speed-up", "n", "flags");
    for (int i = 0; i < view.count; i++)
        print_frame(&view, view.cells[i], probe_ns);
    printf("\n  where most of the time goes\n");
    for (int i = 0; i < view.count; i++)
        if (rb_cell_has_time(view.cells[i]))
            print_hot_spot(view.cells[i], view.bounces);
    printf("\n  %-18s %-14s", "ns per ray", "bounce");
    for (int bounce = 0; bounce < view.bounces; bounce++)
        printf(" %9d", bounce);
    printf("\n");
    for (int i = 0; i < view.count; i++)
        if (rb_cell_has_time(view.cells[i]))
            print_grid(view.cells[i], view.bounces);
    print_ray_counts(reference, view.bounces);
    print_gains(&view);
    fflush(stdout);
}

// The cell of another reference that is like this one.
static const struct rb_cell *counterpart(const struct view *view, const struct rb_cell *cell)
{
    for (int i = 0; i < view->count; i++) {
        const struct rb_cell *other = view->cells[i];
        if (other->variant == cell->variant && other->settings.threads == cell->settings.threads &&
            (other->settings.tile == cell->settings.tile || other->group_tiles ||
             cell->group_tiles) &&
            rb_cell_has_time(other))
            return other;
    }
    return NULL;
}

// Means of a row over all references; false if one of them lacks it.
static bool print_means(const struct rb_plan *plan, const struct rb_cell *cell)
{
    double rates[TABLES_MAX], ratios[TABLES_MAX];
    size_t count = 0, compared = 0;
    for (int r = 0; r < plan->reference_count; r++) {
        const struct view view = select_cells(plan, &plan->references[r], 0);
        const struct rb_cell *here = counterpart(&view, cell);
        if (!here)
            return false;
        const struct rb_cell *base = baseline_of(&view, here);
        double frame_ns = rb_cell_frame_ns(here).value;
        rates[count++] = here->reference->rays / frame_ns * 1e3;
        if (base)
            ratios[compared++] = rb_cell_frame_ns(base).value / frame_ns;
    }
    printf("  %-18s %7d %12.3f", cell->variant->name, cell->settings.threads,
           rb_stats_harmonic_mean(rates, count));
    if (compared == count)
        printf("  %10.2f x %s", rb_stats_geometric_mean(ratios, compared), cell->variant->baseline);
    printf("\n");
    return true;
}

void rb_table_print_summary(const struct rb_plan *plan)
{
    if (plan->reference_count < 2 || plan->reference_count > TABLES_MAX)
        return;
    const struct view first = select_cells(plan, &plan->references[0], 0);
    printf("\nall %d tables above\n  %-18s %7s %12s  %12s\n", plan->reference_count, "variant",
           "threads", "Mrays/s", "speed-up");
    for (int i = 0; i < first.count; i++)
        if (rb_cell_has_time(first.cells[i]) && !print_means(plan, first.cells[i]))
            printf("  %-18s %7d   not measured everywhere\n", first.cells[i]->variant->name,
                   first.cells[i]->settings.threads);
    printf("  Mrays/s: harmonic mean; speed-up: geometric mean\n");
}
