// Header and rows come from one table of columns, so they cannot disagree. What was not measured is
// empty, and the column `note` says why.
#include "bench/csv.h"

#include <inttypes.h>
#include <math.h>

struct line {
    const struct rb_scene_bench *bench;
    const struct rb_row *row;
    const char *kernel;
    int bounce;                   // -1: of the whole frame
    const struct rb_tally *count; // of a whole frame, NULL where there are none
    struct rb_estimate ns_per_ray;
    double ns; // of a whole frame
};

static void put_number(FILE *out, double value)
{
    if (isfinite(value))
        fprintf(out, "%.6g", value);
}

static void put_scene(FILE *out, const struct line *line)
{
    const char *name = line->bench->name;
    fputc('"', out); // a file name may hold anything: quoted as RFC 4180 has it
    for (; *name; name++)
        fprintf(out, *name == '"' ? "\"\"" : "%c", *name);
    fputc('"', out);
}

static void put_width(FILE *out, const struct line *line)
{
    fprintf(out, "%d", line->bench->settings.width);
}

static void put_height(FILE *out, const struct line *line)
{
    fprintf(out, "%d", line->bench->settings.height);
}

static void put_depth(FILE *out, const struct line *line)
{
    fprintf(out, "%d", line->bench->settings.depth);
}

static void put_aa(FILE *out, const struct line *line)
{
    fprintf(out, "%d", line->bench->settings.aa);
}

static void put_light_samples(FILE *out, const struct line *line)
{
    fprintf(out, "%d", line->bench->settings.light_samples);
}

static void put_tile(FILE *out, const struct line *line)
{
    if (line->row->renderer)
        fprintf(out, "%d", rb_renderer_settings(line->row->renderer)->tile);
}

static void put_variant(FILE *out, const struct line *line)
{
    fputs(line->row->variant->name, out);
}

static void put_threads(FILE *out, const struct line *line)
{
    if (rb_row_has_time(line->row))
        fprintf(out, "%d", rb_row_threads(line->row));
}

static void put_kernel(FILE *out, const struct line *line)
{
    fputs(line->kernel, out);
}

static void put_bounce(FILE *out, const struct line *line)
{
    if (line->bounce >= 0)
        fprintf(out, "%d", line->bounce);
}

static void put_rays(FILE *out, const struct line *line)
{
    if (line->count)
        fprintf(out, "%" PRIu64, line->count->rays);
}

static void put_ns_per_ray(FILE *out, const struct line *line)
{
    put_number(out, line->ns_per_ray.value);
}

static void put_ns_per_ray_low(FILE *out, const struct line *line)
{
    put_number(out, line->ns_per_ray.low);
}

static void put_ns_per_ray_high(FILE *out, const struct line *line)
{
    put_number(out, line->ns_per_ray.high);
}

static void put_ns_per_pixel(FILE *out, const struct line *line)
{
    const struct rb_settings *s = &line->bench->settings;
    put_number(out, line->ns / ((double)s->width * s->height));
}

static void put_samples(FILE *out, const struct line *line)
{
    fprintf(out, "%d", line->row->sample_count);
}

static void put_note(FILE *out, const struct line *line)
{
    static const char *const notes[] = {
        [RB_ROW_UNAVAILABLE] = "unavailable",
        [RB_ROW_INVALID] = "invalid: differs from the reference",
        [RB_ROW_MEASURED] = "",
        [RB_ROW_ESTIMATED] = "estimated from a sample of tiles",
    };
    fputs(notes[line->row->state], out);
}

static const struct column {
    const char *name;
    void (*put)(FILE *out, const struct line *line);
} columns[] = {
    {"scene", put_scene},
    {"width", put_width},
    {"height", put_height},
    {"depth", put_depth},
    {"aa", put_aa},
    {"light_samples", put_light_samples},
    {"tile", put_tile},
    {"variant", put_variant},
    {"threads", put_threads},
    {"kernel", put_kernel},
    {"bounce", put_bounce},
    {"rays", put_rays},
    {"ns_per_ray", put_ns_per_ray},
    {"ns_per_ray_lo", put_ns_per_ray_low},
    {"ns_per_ray_hi", put_ns_per_ray_high},
    {"ns_per_pixel", put_ns_per_pixel},
    {"n", put_samples},
    {"note", put_note},
};

enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

void rb_csv_header(FILE *out)
{
    for (int i = 0; i < COLUMN_COUNT; i++)
        fprintf(out, "%s%s", i ? "," : "", columns[i].name);
    fputs("\r\n", out);
}

static void put_line(FILE *out, const struct line *line)
{
    for (int i = 0; i < COLUMN_COUNT; i++) {
        if (i)
            fputc(',', out);
        columns[i].put(out, line);
    }
    fputs("\r\n", out);
}

// The kernels at every bounce that has rays; a row without a time has them with empty times.
static void put_kernels(FILE *out, struct line line)
{
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++) {
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            line.count = &line.bench->frame.tally[stage][bounce];
            if (line.count->rays == 0)
                continue;
            line.kernel = rb_stage_names[stage];
            line.bounce = bounce;
            if (rb_row_has_time(line.row))
                line.ns_per_ray = rb_row_cell(line.row, (enum rb_stage)stage, bounce);
            line.ns = line.ns_per_ray.value * (double)line.count->rays;
            put_line(out, &line);
        }
    }
}

static void put_whole(FILE *out, struct line line, const char *kernel, double ns)
{
    line.kernel = kernel;
    line.bounce = -1;
    line.ns = ns;
    put_line(out, &line);
}

void rb_csv_rows(FILE *out, const struct rb_scene_bench *bench)
{
    const struct rb_estimate none = {(double)NAN, (double)NAN, (double)NAN};
    for (int i = 0; i < bench->row_count; i++) {
        const struct rb_row *row = &bench->rows[i];
        struct line line = {.bench = bench, .row = row, .ns_per_ray = none};
        put_kernels(out, line);
        if (!rb_row_has_time(row))
            continue;
        for (int stage = RB_KERNEL_COUNT; stage < RB_STAGE_COUNT; stage++)
            put_whole(out, line, rb_stage_names[stage],
                      rb_row_stage(row, (enum rb_stage)stage, bench->frame_rays).value);
        if (row->variant->accelerator != RB_ACCEL_NONE)
            put_whole(out, line, "build", (double)rb_renderer_build_ns(row->renderer));
        put_whole(out, line, "frame", rb_row_frame(row, bench->frame_rays).value);
    }
}
