#include "bench/run/columns.h"

#include "bench/data/csv_write.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

struct rb_value rb_none(void)
{
    return (struct rb_value){.kind = RB_VALUE_NONE};
}

struct rb_value rb_text(const char *text)
{
    return text && *text ? (struct rb_value){.kind = RB_VALUE_TEXT, .text = text} : rb_none();
}

struct rb_value rb_integer(int64_t value)
{
    return (struct rb_value){.kind = RB_VALUE_INTEGER, .integer = value};
}

struct rb_value rb_number(double value)
{
    return isfinite(value) ? (struct rb_value){.kind = RB_VALUE_NUMBER, .number = value}
                           : rb_none();
}

struct rb_value rb_hash(uint64_t value)
{
    return (struct rb_value){.kind = RB_VALUE_HASH, .hash = value};
}

static void put_csv(FILE *out, struct rb_value value)
{
    switch (value.kind) {
    case RB_VALUE_NONE:
        break;
    case RB_VALUE_TEXT:
        rb_csv_put_text(out, value.text);
        break;
    case RB_VALUE_INTEGER:
        fprintf(out, "%" PRId64, value.integer);
        break;
    case RB_VALUE_NUMBER:
        fprintf(out, "%.6g", value.number);
        break;
    case RB_VALUE_HASH:
        fprintf(out, "%016" PRIx64, value.hash);
        break;
    }
}

void rb_columns_csv_header(FILE *out, const struct rb_column *columns)
{
    for (const struct rb_column *c = columns; c->name; c++)
        fprintf(out, "%s%s", c == columns ? "" : ",", c->name);
    fputs("\r\n", out);
}

void rb_columns_csv_row(FILE *out, const struct rb_column *columns, const struct rb_line *line)
{
    for (const struct rb_column *c = columns; c->name; c++) {
        if (c != columns)
            fputc(',', out);
        put_csv(out, c->of(line));
    }
    fputs("\r\n", out);
}

static void put_json(struct rb_json *json, const char *key, struct rb_value value)
{
    switch (value.kind) {
    case RB_VALUE_NONE:
        rb_json_string(json, key, NULL);
        break;
    case RB_VALUE_TEXT:
        rb_json_string(json, key, value.text);
        break;
    case RB_VALUE_INTEGER:
        rb_json_integer(json, key, value.integer);
        break;
    case RB_VALUE_NUMBER:
        rb_json_number(json, key, value.number);
        break;
    case RB_VALUE_HASH:
        rb_json_hash(json, key, value.hash);
        break;
    }
}

void rb_columns_json_row(struct rb_json *json, const struct rb_column *columns,
                         const struct rb_line *line)
{
    rb_json_object(json, NULL);
    for (const struct rb_column *c = columns; c->name; c++)
        put_json(json, c->name, c->of(line));
    rb_json_end_object(json);
}

struct rb_value rb_cell_scene(const struct rb_line *line)
{
    return rb_text(line->cell->reference->scene_name);
}

struct rb_value rb_cell_width(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.width);
}

struct rb_value rb_cell_height(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.height);
}

struct rb_value rb_cell_depth(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.depth);
}

struct rb_value rb_cell_aa(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.aa);
}

struct rb_value rb_cell_light_samples(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.light_samples);
}

struct rb_value rb_cell_tile(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.tile);
}

struct rb_value rb_cell_variant(const struct rb_line *line)
{
    return rb_text(line->cell->variant->name);
}

struct rb_value rb_cell_threads(const struct rb_line *line)
{
    return rb_integer(line->cell->settings.threads);
}

// The text lives until the next call.
struct rb_value rb_cell_flag_words(const struct rb_line *line)
{
    static char text[128];
    rb_cell_flags(line->cell, line->partial, line->probe_ns, text);
    return rb_text(text);
}

struct rb_value rb_cell_note_text(const struct rb_line *line)
{
    return rb_text(rb_cell_note(line->cell));
}

struct rb_value rb_cell_overhead_pct(const struct rb_line *line)
{
    return rb_number(100.0 * rb_cell_overhead(line->cell, line->probe_ns));
}

struct rb_value rb_schema_version(const struct rb_line *line)
{
    (void)line;
    return rb_integer(RB_SCHEMA_VERSION);
}
