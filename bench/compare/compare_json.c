#include "bench/compare/compare_print.h"
#include "bench/data/json.h"

#include <stdlib.h>
#include <string.h>

enum { SCHEMA_VERSION = 1 };

static const char *const verdict_names[] = {
    [RB_VERDICT_FASTER] = "faster",
    [RB_VERDICT_SLOWER] = "slower",
    [RB_VERDICT_UNRESOLVED] = "not resolved",
    [RB_VERDICT_TOO_FEW] = "too few processes",
};

static const char *known(const char *text)
{
    return text[0] ? text : NULL;
}

static void put_run(struct rb_json *json, const char *key, const struct rb_compare_run *run,
                    const char *variant)
{
    rb_json_object(json, key);
    rb_json_string(json, "folder", run->folder);
    rb_json_string(json, "variant", variant);
    rb_json_string(json, "session", known(run->session));
    rb_json_string(json, "host", known(run->host));
    rb_json_string(json, "cpu_model", known(run->cpu_model));
    rb_json_string(json, "commit", known(run->commit));
    rb_json_bool(json, "unfinished", run->samples.unfinished);
    rb_json_end_object(json);
}

static void put_family(struct rb_json *json, const char *key,
                       const struct rb_compare_family *family)
{
    rb_json_object(json, key);
    rb_json_integer(json, "rows", (int64_t)family->rows);
    rb_json_number(json, "level", family->level);
    rb_json_integer(json, "processes_needed", (int64_t)family->needed);
    rb_json_end_object(json);
}

// Numbers as numbers; members of the object that is open.
static void put_key(struct rb_json *json, const struct rb_timed_cell *cell, unsigned skip)
{
    for (int i = 0; i < RB_KEY_CELL; i++) {
        const char *text = cell->key[i];
        bool number = i != RB_KEY_SCENE && i != RB_KEY_VARIANT && text[0] &&
                      strspn(text, "0123456789") == strlen(text) && strlen(text) < 10;
        if (skip >> i & 1)
            continue;
        if (number)
            rb_json_integer(json, rb_key_names[i], strtol(text, NULL, 10));
        else
            rb_json_string(json, rb_key_names[i], text);
    }
}

static void put_row(struct rb_json *json, const struct rb_compare_row *row)
{
    rb_json_object(json, NULL);
    rb_json_string(json, "kernel", rb_timed_kernels[row->kernel].name);
    if (row->bounce == RB_ALL_BOUNCES)
        rb_json_string(json, "bounce", NULL);
    else
        rb_json_integer(json, "bounce", row->bounce);
    rb_json_integer(json, "a_processes", (int64_t)row->a_count);
    rb_json_integer(json, "b_processes", (int64_t)row->b_count);
    rb_json_number(json, "a_ns", row->a_ns);
    rb_json_number(json, "b_ns", row->b_ns);
    rb_json_number(json, "ratio", row->ratio.value);
    rb_json_number(json, "ratio_lo", row->ratio.low);
    rb_json_number(json, "ratio_hi", row->ratio.high);
    rb_json_number(json, "ci_level", row->ratio.level);
    rb_json_string(json, "verdict", verdict_names[row->verdict]);
    rb_json_end_object(json);
}

static void put_cells(struct rb_json *json, const struct rb_comparison *comparison)
{
    rb_json_array(json, "cells");
    for (size_t i = 0; i < comparison->cell_count; i++) {
        const struct rb_compare_cell *cell = &comparison->cells[i];
        rb_json_object(json, NULL);
        put_key(json, cell->a, comparison->key_skip);
        rb_json_bool(json, "same_image", cell->same_image);
        rb_json_array(json, "rows");
        for (size_t r = 0; r < cell->row_count; r++)
            put_row(json, &comparison->rows[cell->first_row + r]);
        rb_json_end_array(json);
        rb_json_end_object(json);
    }
    rb_json_end_array(json);
}

static void put_means(struct rb_json *json, const struct rb_comparison *comparison)
{
    struct rb_compare_mean mean;
    size_t first = 0;
    rb_json_array(json, "frame_means");
    while (rb_comparison_next_mean(comparison, &first, &mean)) {
        rb_json_object(json, NULL);
        put_key(json, mean.like, comparison->key_skip | 1u << RB_KEY_SCENE);
        rb_json_integer(json, "scenes", (int64_t)mean.scenes);
        rb_json_number(json, "geometric_mean_ratio", mean.ratio);
        rb_json_end_object(json);
    }
    rb_json_end_array(json);
}

static void put_only(struct rb_json *json, const struct rb_comparison *comparison, int side)
{
    rb_json_array(json, side ? "only_in_b" : "only_in_a");
    for (size_t i = 0; i < comparison->only_count[side]; i++) {
        rb_json_object(json, NULL);
        put_key(json, comparison->only[side][i], 0);
        rb_json_end_object(json);
    }
    rb_json_end_array(json);
}

void rb_compare_print_json(const struct rb_compare_report *report)
{
    const struct rb_comparison *comparison = report->comparison;
    struct rb_json json = {.out = stdout};
    rb_json_object(&json, NULL);
    rb_json_integer(&json, "schema_version", SCHEMA_VERSION);
    rb_json_string(&json, "ratio_is", "time of b over time of a");
    put_run(&json, "a", report->runs[0], report->variants[0]);
    put_run(&json, "b", report->runs[1], report->variants[1]);
    rb_json_bool(&json, "paired", report->options->paired);
    rb_json_number(&json, "family_level", report->options->level);
    put_family(&json, "family", &comparison->kernels);
    put_family(&json, "bounce_family", &comparison->bounces);
    put_cells(&json, comparison);
    put_means(&json, comparison);
    put_only(&json, comparison, 0);
    put_only(&json, comparison, 1);
    if (report->gate.asked) {
        rb_json_object(&json, "gate");
        rb_json_number(&json, "threshold_pct", report->gate.threshold_pct);
        rb_json_integer(&json, "slower", (int64_t)report->gate.slower);
        rb_json_integer(&json, "undecided", (int64_t)report->gate.undecided);
        rb_json_end_object(&json);
    }
    rb_json_end_object(&json);
}
