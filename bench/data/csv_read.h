// Reads CSV files as RFC 4180 describes them: a header line, rows of as many fields, fields quoted
// where need be, quotes doubled, line feeds within quotes; lines end in CRLF or LF.
//
// The file is read in one go and split in place, so 100 MB take about half a second and four
// times the memory. A table is read-only once loaded and then safe to share between threads.
#ifndef RB_DATA_CSV_READ_H
#define RB_DATA_CSV_READ_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { RB_CSV_COLUMNS_MAX = 1024 };

// Where a row starts in the file.
struct rb_csv_row {
    size_t line;   // from 1; the header is a row, too
    size_t offset; // in bytes
};

struct rb_csv {
    char *path; // as given
    char *text; // the file, cut into fields
    const char **fields;
    struct rb_csv_row *rows; // the header's first, then row_count more
    int column_count;
    size_t row_count; // without the header
};

// Loads the file. RB_FAILED: it cannot be read, or there is no memory. RB_INVALID: it is empty or
// malformed, holds a NUL byte, two columns of one name or a row with the wrong number of fields;
// `error` (not NULL) has the place. On failure there is nothing to free.
enum rb_status rb_csv_load(const char *path, struct rb_csv *csv, struct rb_error *error);

// The same for a file whose writer may have been stopped at any byte: a last line that lacks its
// line feed or fields is left out, and `*dropped` says so. A file without a whole header has 0
// columns and 0 rows. An open quote that swallows whole lines remains an error: no crash does that.
enum rb_status rb_csv_load_partial(const char *path, struct rb_csv *csv, bool *dropped,
                                   struct rb_error *error);

// Harmless on a zeroed table and after a failed load.
void rb_csv_free(struct rb_csv *csv);

// Index of the column, -1 if there is none of that name.
int rb_csv_column(const struct rb_csv *csv, const char *name);

// Field of a row (from 0, without the header); "" for column -1. Lives as long as the table.
const char *rb_csv_text(const struct rb_csv *csv, size_t row, int column);

// The field as a number; NaN if it is empty or anything but one finite decimal number.
double rb_csv_number(const struct rb_csv *csv, size_t row, int column);

// The field as an exact whole number in `base` 10 or 16, digits alone. False, and `value` is
// untouched, if it is anything else or does not fit.
bool rb_csv_word(const struct rb_csv *csv, size_t row, int column, uint64_t *value, int base);

// Line of the file on which the row starts.
size_t rb_csv_line(const struct rb_csv *csv, size_t row);

// Puts file, line and column (in bytes from where the row starts) of a field into `error`; column
// -1 is the start of the row.
void rb_csv_place(const struct rb_csv *csv, size_t row, int column, struct rb_error *error);

#endif
