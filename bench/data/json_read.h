// Reads JSON files (RFC 8259): checks the whole text once, then finds members by their path. Meant
// for small files such as env.json; a lookup walks the text.
#ifndef RB_DATA_JSON_READ_H
#define RB_DATA_JSON_READ_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { RB_JSON_DEPTH_MAX = 64 };

// Checks a text that ends with a NUL. On RB_INVALID `error` has line and column; its file is left
// as it is.
enum rb_status rb_json_check(const char *text, struct rb_error *error);

// Reads and checks a file; release `*text` with rb_free. RB_FAILED: it cannot be read, or there is
// no memory. On failure `*text` is NULL.
enum rb_status rb_json_load(const char *path, char **text, struct rb_error *error);

// The value at a path of keys such as "host.name" in a checked text or value; NULL if there is
// none. The first of equal keys counts. Keys with dots or escapes cannot be asked for.
const char *rb_json_find(const char *value, const char *path);

// The value as text: a string unescaped (beyond Latin-1 as '?'), a number or word as it stands. Cut
// to `size` bytes with the terminator. False, and `out` is "", if it is NULL, null, an object or an
// array.
bool rb_json_get_text(const char *value, char *out, size_t size);

// The value as a number; NaN if it is NULL or no number.
double rb_json_get_number(const char *value);

#endif
