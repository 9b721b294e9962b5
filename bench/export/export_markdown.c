// Tables to read, for each scene (and settings): frames with their intervals, then time per ray by
// kernel and bounce.
#include "bench/export/export_load.h"

#include <math.h>
#include <string.h>

enum { FRAME_MS, FRAME_LO, FRAME_HI, CI_LEVEL, MRAYS, FRAME_COLUMNS };
enum { NS_PER_RAY, FLAGS, KERNEL_COLUMNS };

struct tables {
    FILE *out;
    const struct rb_export *result;
    int frame[FRAME_COLUMNS];                      // in frame.csv
    int kernel[KERNEL_COLUMNS], key[RB_KEY_COUNT]; // in kernels.csv
};

// What may stand in a cell of a table.
static void put_text(FILE *out, const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (*c < ' ')
            fputc(' ', out);
        else
            fprintf(out, strchr("|\\`*_<", *c) ? "\\%c" : "%c", *c);
}

static void put_number(FILE *out, double value)
{
    if (isfinite(value))
        fprintf(out, " %.4g |", value);
    else
        fputs(" - |", out);
}

// Whether two keys are of one scene at the same settings; tiles differ between variants.
static bool same_scene(const char *const *a, const char *const *b)
{
    for (int i = RB_KEY_SCENE; i < RB_KEY_TILE; i++)
        if (strcmp(a[i], b[i]) != 0)
            return false;
    return true;
}

static double frame_number(const struct tables *t, const struct rb_export_series *frame, int column)
{
    return rb_csv_number(&t->result->frames, frame->row, t->frame[column]);
}

static void put_heading(const struct tables *t, const struct rb_export_series *first)
{
    const char *const *key = first->key;
    fputs("## ", t->out);
    put_text(t->out, key[RB_KEY_SCENE]);
    fprintf(t->out, "\n\n%s x %s pixels, depth %s", key[RB_KEY_WIDTH], key[RB_KEY_HEIGHT],
            key[RB_KEY_DEPTH]);
    if (strcmp(key[RB_KEY_AA], "1") != 0)
        fprintf(t->out, ", %s x %s samples a pixel", key[RB_KEY_AA], key[RB_KEY_AA]);
    if (strcmp(key[RB_KEY_LIGHT_SAMPLES], "1") != 0)
        fprintf(t->out, ", %s samples a light", key[RB_KEY_LIGHT_SAMPLES]);
    fputs("\n\n| variant | threads | tile | ms a frame | interval | level | Mrays/s | speed-up |\n"
          "|---|--:|--:|--:|--:|--:|--:|--:|\n",
          t->out);
}

// How many times as fast as `first`; with ~ where the intervals overlap, ? where there is none.
static void put_speed_up(const struct tables *t, const struct rb_export_series *first,
                         const struct rb_export_series *frame)
{
    double low = frame_number(t, frame, FRAME_LO), high = frame_number(t, frame, FRAME_HI);
    double first_low = frame_number(t, first, FRAME_LO);
    double first_high = frame_number(t, first, FRAME_HI);
    const char *mark = "";
    if (isnan(low + high + first_low + first_high))
        mark = " ?";
    else if (low <= first_high && first_low <= high)
        mark = " ~";
    if (frame == first)
        fputs(" |\n", t->out);
    else
        fprintf(t->out, " %.2f%s |\n",
                frame_number(t, first, FRAME_MS) / frame_number(t, frame, FRAME_MS), mark);
}

static void put_frame(const struct tables *t, const struct rb_export_series *first,
                      const struct rb_export_series *frame)
{
    double low = frame_number(t, frame, FRAME_LO), high = frame_number(t, frame, FRAME_HI);
    fputs("| ", t->out);
    put_text(t->out, frame->key[RB_KEY_VARIANT]);
    fprintf(t->out, " | %s | %s |", frame->key[RB_KEY_THREADS], frame->key[RB_KEY_TILE]);
    put_number(t->out, frame_number(t, frame, FRAME_MS));
    if (isfinite(low) && isfinite(high))
        fprintf(t->out, " %.4g to %.4g |", low, high);
    else
        fputs(" - |", t->out);
    put_number(t->out, frame_number(t, frame, CI_LEVEL));
    put_number(t->out, frame_number(t, frame, MRAYS));
    put_speed_up(t, first, frame);
}

static const char *kernel_text(const struct tables *t, size_t row, enum rb_key key)
{
    return rb_csv_text(&t->result->kernels, row, t->key[key]);
}

static int bounce_of(const struct tables *t, size_t row)
{
    uint64_t bounce;
    bool known = rb_csv_word(&t->result->kernels, row, t->key[RB_KEY_BOUNCE], &bounce, 10);
    return known && bounce < RB_DEPTH_MAX ? (int)bounce : RB_DEPTH_MAX;
}

// Whether a line of kernels.csv is of this cell and has a bounce.
static bool is_of(const struct tables *t, size_t row, const struct rb_export_series *frame)
{
    for (int i = 0; i < RB_KEY_CELL; i++)
        if (strcmp(kernel_text(t, row, (enum rb_key)i), frame->key[i]) != 0)
            return false;
    return kernel_text(t, row, RB_KEY_BOUNCE)[0] != '\0';
}

// The next line of a cell from `row` on; the number of lines if there is none.
static size_t next_line(const struct tables *t, size_t row, const struct rb_export_series *frame)
{
    while (row < t->result->kernels.row_count && !is_of(t, row, frame))
        row++;
    return row;
}

static void put_kernel(const struct tables *t, const struct rb_export_series *frame,
                       const char *kernel, const double *ns, int bounces)
{
    fputs("| ", t->out);
    put_text(t->out, frame->key[RB_KEY_VARIANT]);
    fprintf(t->out, " | %s | ", frame->key[RB_KEY_THREADS]);
    put_text(t->out, kernel);
    fputs(" |", t->out);
    for (int bounce = 0; bounce < bounces; bounce++)
        put_number(t->out, ns[bounce]);
    fputc('\n', t->out);
}

// The kernels of a cell, a line each.
static void put_kernels(const struct tables *t, const struct rb_export_series *frame, int bounces)
{
    const struct rb_csv *csv = &t->result->kernels;
    const char *kernel = NULL;
    double ns[RB_DEPTH_MAX];
    for (size_t row = 0; (row = next_line(t, row, frame)) < csv->row_count; row++) {
        const char *here = kernel_text(t, row, RB_KEY_KERNEL);
        int bounce = bounce_of(t, row);
        double value = rb_csv_number(csv, row, t->kernel[NS_PER_RAY]);
        bool invalid = rb_export_has_flag(rb_csv_text(csv, row, t->kernel[FLAGS]), "invalid");
        if (invalid || isnan(value) || bounce == RB_DEPTH_MAX)
            continue;
        if (!kernel || strcmp(kernel, here) != 0) {
            if (kernel)
                put_kernel(t, frame, kernel, ns, bounces);
            for (int i = 0; i < RB_DEPTH_MAX; i++)
                ns[i] = (double)NAN;
            kernel = here;
        }
        ns[bounce] = value;
    }
    if (kernel)
        put_kernel(t, frame, kernel, ns, bounces);
}

// The kernels of all cells of a scene, or with 0 bounces their frames. `first` is its first frame.
static void put_lines(const struct tables *t, const struct rb_export_series *first, int bounces)
{
    const struct rb_export_series *end = t->result->series.data;
    end += t->result->series.count;
    for (const struct rb_export_series *frame = first; frame < end; frame++) {
        if (!same_scene(frame->key, first->key))
            continue;
        if (bounces)
            put_kernels(t, frame, bounces);
        else
            put_frame(t, first, frame);
    }
}

static void put_scene(const struct tables *t, const struct rb_export_series *first)
{
    int bounces = 0;
    put_heading(t, first);
    put_lines(t, first, 0);
    fprintf(t->out, "\nSpeed-up is over the first line; ~ the intervals overlap, ? there is none."
                    "\n\nns per ray, time of all threads, by bounce:\n\n"
                    "| variant | threads | kernel |");
    for (size_t row = 0; row < t->result->kernels.row_count; row++) {
        const char *key[RB_KEY_TILE];
        for (int i = 0; i < RB_KEY_TILE; i++)
            key[i] = kernel_text(t, row, (enum rb_key)i);
        int bounce = kernel_text(t, row, RB_KEY_BOUNCE)[0] ? bounce_of(t, row) : -1;
        if (bounce >= bounces && bounce < RB_DEPTH_MAX && same_scene(key, first->key))
            bounces = bounce + 1;
    }
    for (int bounce = 0; bounce < bounces; bounce++)
        fprintf(t->out, " %d |", bounce);
    fputs("\n|---|--:|---|", t->out);
    for (int bounce = 0; bounce < bounces; bounce++)
        fputs("--:|", t->out);
    fputc('\n', t->out);
    if (bounces)
        put_lines(t, first, bounces);
    fputc('\n', t->out);
}

enum rb_status rb_export_markdown(const struct rb_export *result, FILE *out, struct rb_error *error)
{
    static const char *const frame_names[] = {"frame_ms", "frame_ms_lo", "frame_ms_hi", "ci_level",
                                              "mrays_per_s"};
    static const char *const kernel_names[] = {"ns_per_ray", "flags"};
    struct tables t = {.out = out, .result = result};
    const struct rb_csv *kernels = &result->kernels;
    if (rb_export_columns(&result->frames, frame_names, FRAME_COLUMNS, t.frame, error) ||
        rb_export_columns(kernels, kernel_names, KERNEL_COLUMNS, t.kernel, error) ||
        rb_export_columns(kernels, rb_key_names, RB_KEY_COUNT, t.key, error))
        return RB_INVALID;
    const struct rb_export_series *series = result->series.data;
    for (size_t i = 0; i < result->series.count; i++) {
        bool seen = false;
        for (size_t k = 0; k < i; k++)
            seen = seen || same_scene(series[k].key, series[i].key);
        if (!seen)
            put_scene(&t, &series[i]);
    }
    return RB_OK;
}
