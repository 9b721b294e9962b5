#include "bench/table.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// Four digits, but no exponent.
static const char *format_ms(double ns, char text[24])
{
    snprintf(text, 24, ns >= 1e9 ? "%.0f" : "%.4g", ns * 1e-6);
    return text;
}

static void print_frame(const struct rb_scene_bench *bench, const struct rb_row *row)
{
    const struct rb_row *base = rb_scene_bench_row(bench, row->variant->baseline);
    printf("  %-18s ", row->variant->name);
    if (!rb_row_has_time(row)) {
        bool invalid = row->state == RB_ROW_INVALID;
        printf("%7s   %s %s\n", "-", invalid ? "INVALID: differs from" : "unavailable: needs",
               invalid ? rb_variants[0].name : row->variant->needs);
        return;
    }
    struct rb_estimate frame = rb_row_frame(row, bench->frame_rays);
    char interval[64] = "-", value[24], low[24], high[24];
    if (isfinite(frame.low))
        snprintf(interval, sizeof interval, "%s to %s", format_ms(frame.low, low),
                 format_ms(frame.high, high));
    printf("%7d %5s %10s  %-22s %8.3f", rb_row_threads(row),
           row->state == RB_ROW_ESTIMATED ? "est." : "", format_ms(frame.value, value), interval,
           bench->frame_rays / frame.value * 1e3);
    if (base && base != row && rb_row_has_time(base))
        printf("  %8.2f x %s", rb_row_frame(base, bench->frame_rays).value / frame.value,
               base->variant->name);
    printf("\n");
}

static int bounces_with_rays(const struct rb_scene_bench *bench)
{
    int bounces = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        if (bench->frame.tally[RB_STAGE_TRACE][bounce].rays)
            bounces = bounce + 1;
    return bounces;
}

static void print_ray_counts(const struct rb_scene_bench *bench, int bounces)
{
    static const struct {
        const char *name;
        enum rb_stage stage;
    } lines[] = {{"rays traced", RB_STAGE_TRACE}, {"shadow rays", RB_STAGE_TRACE_SHADOW}};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        printf("  %-33s", lines[i].name);
        for (int bounce = 0; bounce < bounces; bounce++)
            printf(" %9" PRIu64, bench->frame.tally[lines[i].stage][bounce].rays);
        printf("\n");
    }
}

static void print_grid(const struct rb_row *row, int bounces)
{
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++) {
        printf("  %-18s %-14s", stage ? "" : row->variant->name, rb_stage_names[stage]);
        for (int bounce = 0; bounce < bounces; bounce++) {
            double ns = rb_row_cell(row, (enum rb_stage)stage, bounce).value;
            if (isfinite(ns))
                printf(" %9.1f", ns);
            else
                printf(" %9s", "-");
        }
        printf("\n");
    }
}

// How many times as fast per ray as in the baseline row, where that is certain: the intervals do
// not overlap.
static void print_gain(const struct rb_row *row, const struct rb_row *base, enum rb_stage stage,
                       int bounce)
{
    struct rb_estimate a = rb_row_cell(base, stage, bounce), b = rb_row_cell(row, stage, bounce);
    bool known = isfinite(a.low) && isfinite(b.low);
    if (known && (a.low > b.high || a.high < b.low))
        printf(" %9.2f", a.value / b.value);
    else
        printf(" %9s", known ? "=" : isfinite(b.value) ? "?" : "-");
}

// What each serial row brings, kernel by kernel: parallel rows run the same kernels.
static void print_gains(const struct rb_scene_bench *bench, int bounces)
{
    printf("\n  %-18s %-14s  (= the 95 %% intervals overlap, ? there are none)\n",
           "x as fast per ray", "");
    for (int i = 0; i < bench->row_count; i++) {
        const struct rb_row *row = &bench->rows[i];
        const struct rb_row *base = rb_scene_bench_row(bench, row->variant->baseline);
        if (!base || base == row || rb_variant_parallel(row->variant) || !rb_row_has_time(row) ||
            !rb_row_has_time(base))
            continue;
        for (int stage = 0; stage < RB_KERNEL_COUNT; stage++) {
            char name[48] = "";
            if (stage < 2)
                snprintf(name, sizeof name, stage ? "  over %s" : "%s",
                         stage ? base->variant->name : row->variant->name);
            printf("  %-18s %-14s", name, rb_stage_names[stage]);
            for (int bounce = 0; bounce < bounces; bounce++)
                print_gain(row, base, (enum rb_stage)stage, bounce);
            printf("\n");
        }
    }
}

void rb_table_print(const struct rb_scene_bench *bench)
{
    const struct rb_settings *s = &bench->settings;
    int bounces = bounces_with_rays(bench);
    printf("\n%s: %d x %d, depth %d, %" PRIu32 " primitives, %.0f rays a frame\n", bench->name,
           s->width, s->height, s->depth, bench->scene->primitive_count, bench->frame_rays);
    printf("  hits and image of all rows agree with %s on %" PRIu32 " of %" PRIu32 " tiles%s\n",
           rb_variants[0].name, bench->tiles.group_count * bench->tiles.group_size,
           bench->tiles.total, bench->mismatch ? ", except the rows marked INVALID" : "");
    printf("\n  %-18s %7s %16s  %-22s %8s  %s\n", "variant", "threads", "ms/frame", "95 % interval",
           "Mrays/s", "speed-up");
    for (int i = 0; i < bench->row_count; i++)
        print_frame(bench, &bench->rows[i]);

    printf("\n  %-18s %-14s", "ns per ray", "bounce");
    for (int bounce = 0; bounce < bounces; bounce++)
        printf(" %9d", bounce);
    printf("\n");
    for (int i = 0; i < bench->row_count; i++)
        if (rb_row_has_time(&bench->rows[i]))
            print_grid(&bench->rows[i], bounces);
    print_ray_counts(bench, bounces);
    print_gains(bench, bounces);
    fflush(stdout);
}

void rb_table_print_probes(double probe_ns, double worst)
{
    printf("\nA probe costs %.1f ns; probes take at most %.3f %% of a frame (largest row).\n",
           probe_ns, worst * 100.0);
    printf("ns per ray: elapsed time of all threads over queue entries, misses included. Mrays/s:\n"
           "trace and trace_shadow rays per frame time. est.: from a random sample of tiles.\n");
}
