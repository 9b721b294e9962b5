// Data files of lines `key words`, read by a table of keys. `#` begins a comment; blank lines are
// skipped.
#ifndef RB_HARDWARE_SHEET_H
#define RB_HARDWARE_SHEET_H

#include "bench/hardware/formula.h"

#include <stddef.h>

// Takes what follows the key, without blanks around it. `error` has the place of `text`; to say
// where in it, add to its column.
struct rb_sheet_key {
    const char *name; // NULL ends a table
    enum rb_status (*take)(void *user, char *text, struct rb_error *error);
};

// RB_FAILED: the file cannot be read. RB_INVALID: a line is wrong; `error` has its place.
enum rb_status rb_sheet_read(const char *path, const struct rb_sheet_key *keys, void *user,
                             struct rb_error *error);

// Copies a text, dropping what does not fit. RB_INVALID if there is none.
enum rb_status rb_sheet_text(char *to, size_t size, const char *text, struct rb_error *error);

// Appends a line to a text. RB_INVALID if it does not fit.
enum rb_status rb_sheet_append(char *to, size_t size, const char *text, struct rb_error *error);

// Adds a value "NAME = FORMULA".
enum rb_status rb_sheet_value(struct rb_values *values, char *text, struct rb_error *error);

// The name of a file without folders and ending.
enum { RB_SHEET_STEM_MAX = 48 };
void rb_sheet_stem(const char *path, char stem[RB_SHEET_STEM_MAX]);

// Cuts "NAME = TEXT" in two; `*rest` is behind the sign. RB_INVALID if it is no such thing.
enum rb_status rb_sheet_cut(char *text, char **rest, struct rb_error *error);

// Finds a file of data that comes with the program: `folder` "bench/events" in the checkout we
// stand in, in the one the program was built in, or share/raybench/`installed`. Index 0, 1, ...
// until it returns NULL; the text lives until the next call.
const char *rb_sheet_folder(const char *folder, const char *installed, int index);

#endif
