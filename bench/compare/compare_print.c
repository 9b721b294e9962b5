#include "bench/compare/compare_print.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// How a column of the key is put in words; one that has its usual value goes without saying.
static const struct {
    enum rb_key key;
    const char *before, *after, *usual;
} label_parts[] = {
    {RB_KEY_SCENE, "", "", ""},
    {RB_KEY_WIDTH, " ", "", ""},
    {RB_KEY_HEIGHT, "x", "", ""},
    {RB_KEY_DEPTH, ", depth ", "", ""},
    {RB_KEY_AA, ", aa ", "", "1"},
    {RB_KEY_LIGHT_SAMPLES, ", light samples ", "", "1"},
    {RB_KEY_TILE, ", tile ", "", "64"},
    {RB_KEY_VARIANT, ", ", "", ""},
    {RB_KEY_THREADS, ", ", " threads", "1"},
};

void rb_compare_label(const struct rb_timed_cell *cell, unsigned skip,
                      char label[RB_CELL_LABEL_MAX])
{
    size_t used = 0;
    label[0] = '\0';
    for (size_t i = 0; i < sizeof label_parts / sizeof *label_parts; i++) {
        const char *text = cell->key[label_parts[i].key];
        size_t room = RB_CELL_LABEL_MAX - used;
        if (skip >> label_parts[i].key & 1 || strcmp(text, label_parts[i].usual) == 0)
            continue;
        int length = snprintf(label + used, room, "%s%.100s%s", label_parts[i].before, text,
                              label_parts[i].after);
        used += (size_t)length < room ? (size_t)length : room - 1;
    }
}

static void print_run(const struct rb_compare_report *report, int side)
{
    const struct rb_compare_run *run = report->runs[side];
    printf("%c  %s", "AB"[side], run -> folder);
    if (report->variants[side])
        printf(", variant %s", report->variants[side]);
    if (run->commit[0])
        printf(", commit %.12s", run->commit);
    printf("%s\n", run->samples.unfinished ? ", a run that has not ended" : "");
}

static void print_family(const struct rb_compare_family *family, const char *what, double level)
{
    if (family->rows)
        printf("   %zu %s: all intervals hold at once with %g %%, each with %.5g %% or more\n",
               family->rows, what, 100 * level, 100 * family->level);
}

static void print_head(const struct rb_compare_report *report)
{
    print_run(report, 0);
    print_run(report, 1);
    printf("   ratio: time of B over time of A; below 1, B is faster\n");
    if (report->options->paired)
        printf("   paired: process p of A ran beside process p of B\n");
    else
        printf("   two runs: if the machine changed between them, that is in the ratio and not in "
               "the interval\n");
    print_family(&report->comparison->kernels, "rows", report->options->level);
    print_family(&report->comparison->bounces, "rows of single bounces", report->options->level);
}

static void print_verdict(const struct rb_compare_row *row, size_t needed)
{
    size_t count = row->a_count < row->b_count ? row->a_count : row->b_count;
    switch (row->verdict) {
    case RB_VERDICT_FASTER:
        printf("faster: %.4g x as fast\n", 1 / row->ratio.value);
        break;
    case RB_VERDICT_SLOWER:
        printf("slower: %.4g x the time\n", row->ratio.value);
        break;
    case RB_VERDICT_UNRESOLVED:
        printf("not resolved\n");
        break;
    case RB_VERDICT_TOO_FEW:
        printf("too few processes (%zu, needs %zu)\n", count, needed);
        break;
    }
}

static void print_row(const struct rb_comparison *comparison, const struct rb_compare_row *row)
{
    char name[32], interval[32] = "-", processes[48];
    const char *kernel = rb_timed_kernels[row->kernel].name;
    if (row->bounce == RB_ALL_BOUNCES)
        snprintf(name, sizeof name, "%s", kernel);
    else
        snprintf(name, sizeof name, "  bounce %d", row->bounce);
    if (!isnan(row->ratio.low))
        snprintf(interval, sizeof interval, "%.4f to %.4f", row->ratio.low, row->ratio.high);
    if (row->a_count == row->b_count)
        snprintf(processes, sizeof processes, "%zu", row->a_count);
    else
        snprintf(processes, sizeof processes, "%zu, %zu", row->a_count, row->b_count);
    printf("  %-14s %11.5g %11.5g %9.4f  %-18s %6s  ", name, row->a_ns * 1e-6, row->b_ns * 1e-6,
           row->ratio.value, interval, processes);
    print_verdict(row, rb_comparison_family(comparison, row)->needed);
}

static void print_cell(const struct rb_comparison *comparison, const struct rb_compare_cell *cell)
{
    char label[RB_CELL_LABEL_MAX];
    rb_compare_label(cell->a, comparison->key_skip, label);
    printf("\n%s\n", label);
    if (!cell->same_image)
        printf("  not compared: the images differ, so this is not the same work\n");
    else if (cell->row_count == 0)
        printf("  not compared: no kernel was measured on both sides\n");
    else
        printf("  %-14s %11s %11s %9s  %-18s %6s  %s\n", "", "A ms", "B ms", "ratio", "interval",
               "n", "B is");
    for (size_t i = 0; i < cell->row_count; i++)
        print_row(comparison, &comparison->rows[cell->first_row + i]);
}

static void print_means(const struct rb_comparison *comparison)
{
    struct rb_compare_mean mean;
    char label[RB_CELL_LABEL_MAX];
    size_t first = 0;
    const char *gap = "\n";
    while (rb_comparison_next_mean(comparison, &first, &mean)) {
        rb_compare_label(mean.like, comparison->key_skip | 1u << RB_KEY_SCENE, label);
        printf("%sframe, geometric mean of the ratios of %zu scenes: %.4f (%s)\n", gap, mean.scenes,
               mean.ratio, label + strspn(label, " ,"));
        gap = "";
    }
}

static void print_only(const struct rb_comparison *comparison)
{
    char label[RB_CELL_LABEL_MAX];
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < comparison->only_count[side]; i++) {
            rb_compare_label(comparison->only[side][i], 0, label);
            printf("%sonly in %c: %s\n", i ? "" : "\n", "AB"[side], label);
        }
    }
}

void rb_compare_print(const struct rb_compare_report *report)
{
    const struct rb_comparison *comparison = report->comparison;
    print_head(report);
    for (size_t i = 0; i < comparison->cell_count; i++)
        print_cell(comparison, &comparison->cells[i]);
    print_means(comparison);
    print_only(comparison);
    if (report->gate.asked)
        printf("\ngate: %zu rows slower by more than %g %%, %zu undecided\n", report->gate.slower,
               report->gate.threshold_pct, report->gate.undecided);
}
