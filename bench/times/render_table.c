#include "bench/times/render_table.h"

#include "bench/data/csv_write.h"

#include "base/memory.h"
#include "scene/generate.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_FORMAT "%.6g"

enum kind { TEXT, WHOLE, NUMBER };

#define COLUMN(kind, name)                                                                         \
    {                                                                                              \
#name, kind, offsetof(struct rb_render_row, name)                                          \
    }

// Reader and writer loop over this. Columns are only ever appended.
static const struct column {
    const char *name;
    enum kind kind;
    size_t offset;
} columns[] = {
    COLUMN(TEXT, scene),
    COLUMN(NUMBER, paper_s),
    COLUMN(TEXT, variant),
    COLUMN(WHOLE, threads),
    COLUMN(NUMBER, median_s),
    COLUMN(NUMBER, mean_s),
    COLUMN(NUMBER, min_s),
    COLUMN(NUMBER, max_s),
    COLUMN(WHOLE, runs),
    COLUMN(TEXT, source),
    COLUMN(NUMBER, speedup_over_naive),
    COLUMN(NUMBER, speedup_over_paper),
    COLUMN(TEXT, note),
    COLUMN(TEXT, cpu_model),
    COLUMN(TEXT, git_commit),
    COLUMN(TEXT, utc),
    COLUMN(TEXT, available),
    COLUMN(NUMBER, user_s),
    COLUMN(NUMBER, system_s),
    COLUMN(NUMBER, frame_j),
};

// The last column is there if there is energy.
enum { COLUMN_COUNT = sizeof columns / sizeof *columns, COLUMNS_ALWAYS = COLUMN_COUNT - 1 };

enum rb_status rb_render_table_create(struct rb_render_table *table, size_t count,
                                      struct rb_error *error)
{
    *table = (struct rb_render_table){.rows = rb_alloc(count, sizeof *table->rows), .count = count};
    return table->rows ? RB_OK : rb_error_memory(error, "the render-time table");
}

void rb_render_table_free(struct rb_render_table *table)
{
    rb_free(table->rows);
    rb_csv_free(&table->csv);
    *table = (struct rb_render_table){0};
}

const struct rb_render_row *rb_render_table_find(const struct rb_render_table *table,
                                                 const char *scene, const char *variant)
{
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(table->rows[i].scene, scene) == 0 &&
            strcmp(table->rows[i].variant, variant) == 0)
            return &table->rows[i];
    return NULL;
}

bool rb_render_row_estimated(const struct rb_render_row *row)
{
    return row->runs == 0 && isfinite(row->median_s);
}

bool rb_render_table_has_energy(const struct rb_render_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        if (isfinite(table->rows[i].frame_j))
            return true;
    return false;
}

// As a reader of the CSV will have it: six digits.
static double as_written(double value)
{
    char text[32];
    snprintf(text, sizeof text, NUMBER_FORMAT, value);
    return strtod(text, NULL);
}

static double ratio(double a, double b)
{
    return b > 0 ? a / b : (double)NAN;
}

void rb_render_table_derive(struct rb_render_table *table)
{
    for (struct rb_render_row *row = table->rows; row < table->rows + table->count; row++)
        row->median_s = as_written(row->median_s);
    for (struct rb_render_row *row = table->rows; row < table->rows + table->count; row++) {
        const struct rb_render_row *naive = rb_render_table_find(table, row->scene, "naive");
        row->speedup_over_naive = naive ? ratio(naive->median_s, row->median_s) : (double)NAN;
        row->speedup_over_paper = ratio(row->paper_s, row->median_s);
    }
}

static enum rb_status read_field(const struct rb_csv *csv, size_t row, int from,
                                 const struct column *column, void *target, struct rb_error *error)
{
    uint64_t word;
    switch (column->kind) {
    case TEXT:
        *(const char **)target = rb_csv_text(csv, row, from);
        return RB_OK;
    case NUMBER:
        *(double *)target = rb_csv_number(csv, row, from);
        return RB_OK;
    case WHOLE:
        if (rb_csv_word(csv, row, from, &word, 10) && word <= INT_MAX) {
            *(int *)target = (int)word;
            return RB_OK;
        }
    }
    rb_csv_place(csv, row, from, error);
    return rb_error_set(error, RB_INVALID, "%s must be a whole number, not '%.40s'", column->name,
                        rb_csv_text(csv, row, from));
}

static const struct rb_preset *find_preset(const char *name)
{
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++)
        if (strcmp(preset->name, name) == 0)
            return preset;
    return NULL;
}

static enum rb_status read_row(struct rb_render_table *table, size_t index,
                               const int from[COLUMN_COUNT], struct rb_error *error)
{
    struct rb_render_row *row = &table->rows[index];
    row->frame_j = (double)NAN;
    for (size_t c = 0; c < COLUMN_COUNT; c++)
        if (from[c] >= 0 && read_field(&table->csv, index, from[c], &columns[c],
                                       (char *)row + columns[c].offset, error))
            return RB_INVALID;
    const struct rb_preset *preset = find_preset(row->scene);
    rb_csv_place(&table->csv, index, -1, error);
    if (!preset)
        return rb_error_set(error, RB_INVALID, "'%.40s' is not a scene of the 2019 report",
                            row->scene);
    row->paper_s = preset->paper_s;
    if (rb_render_table_find(table, row->scene, row->variant) != row)
        return rb_error_set(error, RB_INVALID, "a second row for %.40s on %s", row->variant,
                            row->scene);
    return RB_OK;
}

static enum rb_status read_rows(struct rb_render_table *table, struct rb_error *error)
{
    int from[COLUMN_COUNT];
    for (size_t c = 0; c < COLUMN_COUNT; c++) {
        from[c] = rb_csv_column(&table->csv, columns[c].name);
        if (c < COLUMNS_ALWAYS && from[c] < 0) {
            snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1,
                     table->csv.path);
            return rb_error_set(error, RB_INVALID, "there is no column %s; run make table",
                                columns[c].name);
        }
    }
    size_t count = table->csv.row_count;
    for (table->count = 0; table->count < count;) {
        table->count++; // so that a row finds itself, or its double
        if (read_row(table, table->count - 1, from, error))
            return RB_INVALID;
    }
    return RB_OK;
}

enum rb_status rb_render_table_load(const char *path, struct rb_render_table *table,
                                    struct rb_error *error)
{
    struct rb_csv csv;
    *table = (struct rb_render_table){0};
    enum rb_status status = rb_csv_load(path, &csv, error);
    if (status)
        return status;
    status = rb_render_table_create(table, csv.row_count, error);
    table->csv = csv;
    if (status == RB_OK)
        status = read_rows(table, error);
    if (status) {
        rb_render_table_free(table);
        return status;
    }
    *error = (struct rb_error){0};
    rb_render_table_derive(table);
    return RB_OK;
}

static void put_field(FILE *out, const struct column *column, const void *field)
{
    if (column->kind == TEXT)
        rb_csv_put_text(out, *(const char *const *)field);
    else if (column->kind == WHOLE)
        fprintf(out, "%d", *(const int *)field);
    else if (isfinite(*(const double *)field))
        fprintf(out, NUMBER_FORMAT, *(const double *)field);
}

void rb_render_table_write(FILE *out, const struct rb_render_table *table)
{
    size_t count = rb_render_table_has_energy(table) ? COLUMN_COUNT : COLUMNS_ALWAYS;
    for (size_t c = 0; c < count; c++)
        fprintf(out, "%s%s", c ? "," : "", columns[c].name);
    fprintf(out, "\r\n");
    for (size_t i = 0; i < table->count; i++)
        for (size_t c = 0; c < count; c++) {
            put_field(out, &columns[c], (const char *)&table->rows[i] + columns[c].offset);
            fprintf(out, "%s", c + 1 < count ? "," : "\r\n");
        }
}
