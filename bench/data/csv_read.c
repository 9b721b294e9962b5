// Fields become strings where they stand: the separator behind a field is overwritten with its
// terminator, and doubled quotes are closed up to the left, which never reaches text not yet read.
#include "bench/data/csv_read.h"

#include "base/file.h"
#include "base/memory.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct parser {
    struct rb_error *error;
    enum rb_status failure; // what ENDS_WRONG means
    char *text, *at, *end;  // *end is 0
    char *line_start;
    size_t line;
    bool partial;
    size_t column_count;
    struct rb_array fields; // const char *
    struct rb_array rows;   // struct rb_csv_row
};

enum ending { ENDS_FIELD, ENDS_ROW, ENDS_FILE, ENDS_WRONG };

// Sets the place to `at`, a byte of the current line.
static enum ending refuse(const struct parser *p, const char *at, const char *what)
{
    p->error->line = p->line;
    p->error->column = (unsigned long)(at - p->line_start) + 1;
    rb_error_set(p->error, RB_INVALID, "%s", what);
    return ENDS_WRONG;
}

// Whether there is no NUL among the bytes of a quoted field; counts the lines they end.
static bool take_quoted(struct parser *p, char *from, const char *to)
{
    for (char *c = from; c < to; c++) {
        if (*c == '\n') {
            p->line++;
            p->line_start = c + 1;
        } else if (*c == '\0') {
            refuse(p, c, "NUL byte: this is no text file");
            return false;
        }
    }
    return true;
}

// What stands behind a field decides what comes next; it is stepped over.
static enum ending read_separator(struct parser *p, bool quoted)
{
    char *at = p->at;
    if (at == p->end)
        return ENDS_FILE;
    if (*at == ',') {
        p->at = at + 1;
        return ENDS_FIELD;
    }
    if (*at == '\r' && at + 1 == p->end && p->partial)
        return ENDS_FILE;
    if (*at == '\n' || (*at == '\r' && at[1] == '\n')) {
        p->at = at + 1 + (*at == '\r');
        p->line++;
        p->line_start = p->at;
        return ENDS_ROW;
    }
    if (*at == '\0')
        return refuse(p, at, "NUL byte: this is no text file");
    if (quoted)
        return refuse(p, at, "text behind the closing quote; write a quote in a field twice");
    if (*at == '\r')
        return refuse(p, at, "carriage return without line feed; lines end in CRLF or LF");
    return refuse(p, at, "quote within an unquoted field; quote the whole field");
}

// From the opening quote; the field is closed up and terminated in place.
static enum ending read_quoted(struct parser *p)
{
    char *out = p->at + 1;
    struct parser open = *p;
    do {
        char *from = ++p->at, *quote = memchr(from, '"', (size_t)(p->end - from));
        size_t length = (size_t)((quote ? quote : p->end) - from);
        if (!take_quoted(p, from, from + length))
            return ENDS_WRONG;
        if (!quote && p->partial && p->line == open.line)
            return ENDS_FILE;
        if (!quote)
            return refuse(&open, open.at, "this quote is never closed");
        memmove(out, from, length + 1);
        out += length + 1; // with the quote, which stays if there are two
        p->at = quote + 1;
    } while (*p->at == '"');
    enum ending ending = read_separator(p, true);
    out[-1] = '\0';
    return ending;
}

static enum ending read_plain(struct parser *p)
{
    static const bool stops[256] = {['\0'] = 1, ['\n'] = 1, ['\r'] = 1, ['"'] = 1, [','] = 1};
    char *at = p->at;
    while (!stops[(unsigned char)*at])
        at++;
    p->at = at;
    enum ending ending = read_separator(p, false);
    if (ending != ENDS_WRONG)
        *at = '\0';
    return ending;
}

// All fields of a row go to p->fields.
static enum ending read_row(struct parser *p)
{
    enum ending ending;
    size_t first = p->fields.count;
    do {
        const char *field = p->at + (*p->at == '"');
        if (p->fields.count - first == RB_CSV_COLUMNS_MAX)
            return refuse(p, p->at, "too many fields");
        if (!rb_array_push(&p->fields, &field, sizeof field)) {
            p->failure = rb_error_memory(p->error, "the table");
            return ENDS_WRONG;
        }
        ending = *p->at == '"' ? read_quoted(p) : read_plain(p);
    } while (ending == ENDS_FIELD);
    return ending;
}

static const char *field_at(const struct parser *p, size_t i)
{
    return ((const char *const *)p->fields.data)[i];
}

// The first row names the columns; the others have as many fields. `start` is where it begins.
static enum ending check_row(struct parser *p, const struct parser *start, size_t first)
{
    char what[96];
    size_t count = p->fields.count - first, columns = first ? p->column_count : count;
    snprintf(what, sizeof what, "%zu fields, but the header names %zu columns", count, columns);
    if (count != columns)
        return refuse(start, start->at, what);
    p->column_count = columns;
    for (size_t i = 0; first == 0 && i < count; i++) {
        for (size_t k = 0; k < i; k++) {
            if (strcmp(field_at(p, i), field_at(p, k)) != 0)
                continue;
            snprintf(what, sizeof what, "columns %zu and %zu have the same name", k + 1, i + 1);
            return refuse(start, start->at, what);
        }
    }
    return ENDS_ROW;
}

// `*dropped`: the last line is not whole and was left out.
static enum rb_status read_rows(struct parser *p, bool *dropped)
{
    while (p->at < p->end) {
        struct parser start = *p;
        size_t first = p->fields.count;
        enum ending ending = read_row(p);
        if (ending == ENDS_WRONG)
            return p->failure;
        bool few = first && p->fields.count - first < p->column_count;
        *dropped = p->partial && (ending == ENDS_FILE || (few && p->at == p->end));
        if (*dropped) {
            p->fields.count = first;
            return RB_OK;
        }
        if (check_row(p, &start, first) == ENDS_WRONG)
            return p->failure;
        struct rb_csv_row row = {start.line, (size_t)(start.at - p->text)};
        if (!rb_array_push(&p->rows, &row, sizeof row))
            return rb_error_memory(p->error, "the table");
    }
    if (p->rows.count == 0 && !p->partial)
        return rb_error_set(p->error, RB_INVALID, "is empty; expected a line of column names");
    return RB_OK;
}

// Room for all fields at once: growing by doubling would touch three times the memory.
static bool reserve_fields(struct parser *p)
{
    size_t separators = 0;
    for (const char *c = p->text; c < p->end; c++)
        separators += (size_t)((*c == ',') | (*c == '\n'));
    return rb_array_reserve(&p->fields, separators + 1, sizeof(const char *));
}

static enum rb_status load(const char *path, bool partial, struct rb_csv *csv, bool *dropped,
                           struct rb_error *error)
{
    *csv = (struct rb_csv){0};
    *dropped = false;
    *error = (struct rb_error){0};
    size_t size = 0;
    enum rb_status status = rb_file_read(path, &csv->text, &size, error);
    csv->path = rb_alloc(strlen(path) + 1, 1);
    if (status == RB_OK && !csv->path)
        status = rb_error_memory(error, "the table");
    if (status == RB_OK) {
        strcpy(csv->path, path);
        struct parser p = {.error = error, .failure = RB_INVALID, .line = 1, .partial = partial};
        p.text = p.at = p.line_start = csv->text;
        p.end = p.text + size;
        status = reserve_fields(&p) ? read_rows(&p, dropped) : rb_error_memory(error, "the table");
        csv->fields = p.fields.data;
        csv->rows = p.rows.data;
        csv->column_count = (int)p.column_count;
        csv->row_count = p.rows.count ? p.rows.count - 1 : 0;
    }
    if (status)
        rb_csv_free(csv);
    return status;
}

enum rb_status rb_csv_load(const char *path, struct rb_csv *csv, struct rb_error *error)
{
    bool dropped;
    return load(path, false, csv, &dropped, error);
}

enum rb_status rb_csv_load_partial(const char *path, struct rb_csv *csv, bool *dropped,
                                   struct rb_error *error)
{
    return load(path, true, csv, dropped, error);
}

void rb_csv_free(struct rb_csv *csv)
{
    rb_free(csv->path);
    rb_free(csv->text);
    rb_free(csv->fields);
    rb_free(csv->rows);
    *csv = (struct rb_csv){0};
}

int rb_csv_column(const struct rb_csv *csv, const char *name)
{
    for (int i = 0; i < csv->column_count; i++)
        if (strcmp(csv->fields[i], name) == 0)
            return i;
    return -1;
}

const char *rb_csv_text(const struct rb_csv *csv, size_t row, int column)
{
    return column < 0 ? "" : csv->fields[(row + 1) * (size_t)csv->column_count + (size_t)column];
}

double rb_csv_number(const struct rb_csv *csv, size_t row, int column)
{
    const char *text = rb_csv_text(csv, row, column);
    char *end;
    double value = strtod(text, &end);
    bool decimal = text[0] && text[strspn(text, "0123456789+-.eE")] == '\0';
    return decimal && *end == '\0' && isfinite(value) ? value : (double)NAN;
}

bool rb_csv_word(const struct rb_csv *csv, size_t row, int column, uint64_t *value, int base)
{
    const char *text = rb_csv_text(csv, row, column);
    const char *digits = base == 16 ? "0123456789abcdefABCDEF" : "0123456789";
    if (!text[0] || text[strspn(text, digits)] != '\0')
        return false;
    errno = 0;
    unsigned long long word = strtoull(text, NULL, base);
    if (errno)
        return false;
    *value = word;
    return true;
}

size_t rb_csv_line(const struct rb_csv *csv, size_t row)
{
    return csv->rows[row + 1].line;
}

void rb_csv_place(const struct rb_csv *csv, size_t row, int column, struct rb_error *error)
{
    const char *start = csv->text + csv->rows[row + 1].offset;
    const char *field = column < 0 ? start : rb_csv_text(csv, row, column);
    snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, csv->path);
    error->line = csv->rows[row + 1].line;
    error->column = (unsigned long)(field - start) + 1;
}
