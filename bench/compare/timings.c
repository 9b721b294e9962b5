// Every line becomes a sample; a line with a bounce becomes a second one without it, and what then
// is equal after sorting is summed. So the sums over bounces need no table of their own.
#define _POSIX_C_SOURCE 200809L
#include "bench/compare/timings.h"

#include "base/file.h"
#include "base/memory.h"
#include "kernels/kernel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const struct rb_timed_kernel rb_timed_kernels[RB_TIMED_KERNELS] = {
    {"frame", false, true},  {"generate", true, true},     {"trace", true, true},
    {"shade", true, true},   {"trace_shadow", true, true}, {"resolve", false, false},
    {"other", false, false}, {"build", false, false},
};

// Columns in use, by position in the file.
struct columns {
    int key[RB_KEY_CELL];
    int process, repetition, kernel, bounce, rays, ns, wall_ns, image_hash;
};

static enum rb_status find_column(const struct rb_csv *csv, const char *name, int *column,
                                  struct rb_error *error)
{
    *column = rb_csv_column(csv, name);
    if (*column >= 0)
        return RB_OK;
    error->line = error->column = 1;
    return rb_error_set(error, RB_INVALID, "no column '%s': not the samples of raybench", name);
}

static enum rb_status find_columns(const struct rb_csv *csv, struct columns *columns,
                                   struct rb_error *error)
{
    const struct {
        const char *name;
        int *column;
    } wanted[] = {
        {"process", &columns->process}, {"repetition", &columns->repetition},
        {"kernel", &columns->kernel},   {"bounce", &columns->bounce},
        {"rays", &columns->rays},       {"ns", &columns->ns},
        {"wall_ns", &columns->wall_ns}, {"image_hash", &columns->image_hash},
    };
    enum rb_status status = RB_OK;
    for (int i = 0; i < RB_KEY_CELL && !status; i++)
        status = find_column(csv, rb_key_names[i], &columns->key[i], error);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted && !status; i++)
        status = find_column(csv, wanted[i].name, wanted[i].column, error);
    return status;
}

static bool is_cell(const struct rb_timed_cell *cell, const struct rb_csv *csv, size_t row,
                    const struct columns *columns)
{
    for (int i = 0; i < RB_KEY_CELL; i++)
        if (strcmp(cell->key[i], rb_csv_text(csv, row, columns->key[i])) != 0)
            return false;
    return true;
}

// The cell of a row, which is mostly that of the row before, `*cell`.
static enum rb_status find_cell(struct rb_array *cells, const struct rb_csv *csv, size_t row,
                                const struct columns *columns, size_t *cell, struct rb_error *error)
{
    const struct rb_timed_cell *known = cells->data;
    if (*cell < cells->count && is_cell(&known[*cell], csv, row, columns))
        return RB_OK;
    for (*cell = 0; *cell < cells->count; ++*cell)
        if (is_cell(&known[*cell], csv, row, columns))
            return RB_OK;
    struct rb_timed_cell added = {.image_hash = ""};
    for (int i = 0; i < RB_KEY_CELL; i++)
        added.key[i] = rb_csv_text(csv, row, columns->key[i]);
    if (cells->count == RB_CELLS_MAX) {
        rb_csv_place(csv, row, -1, error);
        return rb_error_set(error, RB_INVALID, "more than %d cells; split the file", RB_CELLS_MAX);
    }
    return rb_array_push(cells, &added, sizeof added) ? RB_OK : rb_error_memory(error, "cells");
}

static enum rb_status refuse(const struct rb_csv *csv, size_t row, int column, const char *what,
                             struct rb_error *error)
{
    rb_csv_place(csv, row, column, error);
    return rb_error_set(error, RB_INVALID, "'%.40s': expected %s", rb_csv_text(csv, row, column),
                        what);
}

// NaN where nothing was measured; what has no rays takes no time.
static enum rb_status read_time(const struct rb_csv *csv, size_t row, int column, int rays,
                                double *ns, struct rb_error *error)
{
    *ns = rb_csv_number(csv, row, column);
    if (rb_csv_text(csv, row, column)[0] == '\0') {
        if (strcmp(rb_csv_text(csv, row, rays), "0") == 0)
            *ns = 0;
        return RB_OK;
    }
    return *ns >= 0 ? RB_OK : refuse(csv, row, column, "a time in ns, or nothing", error);
}

static enum rb_status read_bounce(const struct rb_csv *csv, size_t row, int column,
                                  bool has_bounces, int16_t *bounce, struct rb_error *error)
{
    uint64_t number = 0;
    bool empty = rb_csv_text(csv, row, column)[0] == '\0';
    if (!has_bounces && !empty)
        return refuse(csv, row, column, "no bounce with this kernel", error);
    if (has_bounces && (!rb_csv_word(csv, row, column, &number, 10) || number >= RB_DEPTH_MAX))
        return refuse(csv, row, column, "the number of a bounce", error);
    *bounce = empty ? RB_ALL_BOUNCES : (int16_t)number;
    return RB_OK;
}

static enum rb_status read_sample(const struct rb_csv *csv, size_t row,
                                  const struct columns *columns, struct rb_timing *sample,
                                  struct rb_error *error)
{
    *sample = (struct rb_timing){.row = row, .parts = 1};
    const char *name = rb_csv_text(csv, row, columns->kernel);
    while (sample->kernel < RB_TIMED_KERNELS &&
           strcmp(rb_timed_kernels[sample->kernel].name, name) != 0)
        sample->kernel++;
    if (sample->kernel == RB_TIMED_KERNELS)
        return refuse(csv, row, columns->kernel, "the name of a kernel", error);
    if (!rb_csv_word(csv, row, columns->process, &sample->process, 10))
        return refuse(csv, row, columns->process, "the number of a process", error);
    if (!rb_csv_word(csv, row, columns->repetition, &sample->repetition, 10))
        return refuse(csv, row, columns->repetition, "the number of a repetition", error);
    bool has_bounces = rb_timed_kernels[sample->kernel].has_bounces;
    enum rb_status status =
        read_bounce(csv, row, columns->bounce, has_bounces, &sample->bounce, error);
    if (status)
        return status;
    int time = sample->kernel == 0 ? columns->wall_ns : columns->ns;
    return read_time(csv, row, time, columns->rays, &sample->ns, error);
}

static void note_image(struct rb_timed_cell *cell, const char *hash)
{
    if (cell->image_hash[0] == '\0')
        cell->image_hash = hash;
    else if (hash[0] && strcmp(cell->image_hash, hash) != 0)
        cell->images_differ = true;
}

static enum rb_status read_rows(const struct rb_csv *csv, struct rb_array *cells,
                                struct rb_array *list, struct rb_error *error)
{
    struct columns columns;
    enum rb_status status = find_columns(csv, &columns, error);
    size_t cell = 0;
    for (size_t row = 0; row < csv->row_count && !status; row++) {
        struct rb_timing sample;
        status = read_sample(csv, row, &columns, &sample, error);
        if (!status)
            status = find_cell(cells, csv, row, &columns, &cell, error);
        if (status)
            break;
        sample.cell = (uint32_t)cell;
        note_image((struct rb_timed_cell *)cells->data + cell,
                   rb_csv_text(csv, row, columns.image_hash));
        bool pushed = rb_array_push(list, &sample, sizeof sample);
        if (pushed && sample.bounce != RB_ALL_BOUNCES) {
            sample.bounce = RB_ALL_BOUNCES;
            pushed = rb_array_push(list, &sample, sizeof sample);
        }
        status = pushed ? RB_OK : rb_error_memory(error, "the samples");
    }
    return status;
}

static int order(uint64_t a, uint64_t b)
{
    return (a > b) - (a < b);
}

static int compare_series(const struct rb_timing *a, const struct rb_timing *b)
{
    int by = order(a->cell, b->cell);
    by = by ? by : a->kernel - b->kernel;
    return by ? by : a->bounce - b->bounce;
}

static int compare_samples(const void *left, const void *right)
{
    const struct rb_timing *a = left, *b = right;
    int by = compare_series(a, b);
    by = by ? by : order(a->process, b->process);
    return by ? by : order(a->repetition, b->repetition);
}

// Sums what is the same but for the bounce. The same bounce twice is a mistake: it would count
// double, or, in two runs poured into one file, mix processes that have nothing in common.
static enum rb_status sum_bounces(struct rb_timings *samples, struct rb_error *error)
{
    size_t kept = 0;
    for (size_t i = 0; i < samples->count; i++) {
        const struct rb_timing *sample = &samples->list[i];
        struct rb_timing *last = kept ? &samples->list[kept - 1] : NULL;
        if (!last || compare_samples(last, sample) != 0) {
            samples->list[kept++] = *sample;
        } else if (sample->bounce == RB_ALL_BOUNCES &&
                   rb_timed_kernels[sample->kernel].has_bounces) {
            last->ns += sample->ns;
            last->parts++;
        } else {
            size_t first = last->row < sample->row ? last->row : sample->row;
            rb_csv_place(&samples->csv, first == sample->row ? last->row : sample->row, -1, error);
            return rb_error_set(error, RB_INVALID,
                                "the same process, repetition, kernel and bounce as line %zu",
                                rb_csv_line(&samples->csv, first));
        }
    }
    samples->count = kept;
    return RB_OK;
}

static size_t series_end(const struct rb_timings *samples, size_t from)
{
    size_t end = from;
    while (end < samples->count && !compare_series(&samples->list[from], &samples->list[end]))
        end++;
    return end;
}

// Drops what was not measured, sums that lack bounces, and of a run that has not ended the
// repetition of the last line, `doubtful`: nothing tells whether it was whole.
static void drop_incomplete(struct rb_timings *samples, const struct rb_timing *doubtful)
{
    size_t kept = 0;
    for (size_t from = 0, end; from < samples->count; from = end) {
        uint32_t parts = 0;
        end = series_end(samples, from);
        for (size_t i = from; i < end; i++)
            parts = samples->list[i].parts > parts ? samples->list[i].parts : parts;
        for (size_t i = from; i < end; i++) {
            const struct rb_timing *sample = &samples->list[i];
            bool doubted = doubtful && sample->cell == doubtful->cell &&
                           sample->process == doubtful->process &&
                           sample->repetition == doubtful->repetition;
            if (sample->parts == parts && !isnan(sample->ns) && !doubted)
                samples->list[kept++] = *sample;
        }
    }
    samples->count = kept;
}

static enum rb_status load_csv(const char *folder, struct rb_timings *samples,
                               struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX];
    bool dropped;
    snprintf(path, sizeof path, "%s/samples.csv", folder);
    if (access(path, F_OK) == 0)
        return rb_csv_load(path, &samples->csv, error);
    snprintf(path, sizeof path, "%s/samples.csv.part", folder);
    samples->unfinished = access(path, F_OK) == 0;
    if (samples->unfinished)
        return rb_csv_load_partial(path, &samples->csv, &dropped, error);
    snprintf(error->file, sizeof error->file, "%.255s", folder);
    return rb_error_set(error, RB_INVALID,
                        "has neither samples.csv nor samples.csv.part: "
                        "not the folder of a run");
}

enum rb_status rb_timings_load(const char *folder, struct rb_timings *samples,
                               struct rb_error *error)
{
    *samples = (struct rb_timings){0};
    struct rb_array cells = {0}, list = {0};
    enum rb_status status = load_csv(folder, samples, error);
    if (!status && samples->csv.column_count)
        status = read_rows(&samples->csv, &cells, &list, error);
    samples->cells = cells.data;
    samples->cell_count = cells.count;
    samples->list = list.data;
    samples->count = list.count;
    if (status)
        return status;
    if (list.count == 0)
        return RB_OK;
    struct rb_timing last = samples->list[list.count - 1];
    qsort(list.data, list.count, sizeof *samples->list, compare_samples);
    status = sum_bounces(samples, error);
    if (!status)
        drop_incomplete(samples, samples->unfinished ? &last : NULL);
    return status;
}

void rb_timings_free(struct rb_timings *samples)
{
    rb_csv_free(&samples->csv);
    rb_free(samples->cells);
    rb_free(samples->list);
    *samples = (struct rb_timings){0};
}

struct rb_timing_range rb_timings_find(const struct rb_timings *samples, size_t cell, int kernel,
                                       int bounce)
{
    struct rb_timing wanted = {
        .cell = (uint32_t)cell, .kernel = (int16_t)kernel, .bounce = (int16_t)bounce};
    size_t low = 0, high = samples->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare_series(&samples->list[middle], &wanted) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    struct rb_timing_range range = {samples->list + low, 0};
    while (low + range.count < samples->count &&
           !compare_series(&range.first[range.count], &wanted))
        range.count++;
    return range;
}

static int compare_texts(const char *a, const char *b)
{
    bool a_words = a[strspn(a, "0123456789")] != '\0', b_words = b[strspn(b, "0123456789")] != '\0';
    int by = a_words - b_words;
    if (!by && !a_words) // without leading zeros, the longer number is the larger one
        by = order(strlen(a), strlen(b));
    return by ? by : strcmp(a, b);
}

int rb_cell_compare(const struct rb_timed_cell *a, const struct rb_timed_cell *b, unsigned skip)
{
    int by = 0;
    for (int i = 0; i < RB_KEY_CELL && !by; i++)
        by = skip >> i & 1 ? 0 : compare_texts(a->key[i], b->key[i]);
    return by;
}
