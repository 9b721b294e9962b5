// Writes JSON (RFC 8259) to a stream: indented, one member a line, strings escaped, numbers that
// are not finite as null. Errors are the stream's: check ferror at the end.
#ifndef RB_DATA_JSON_H
#define RB_DATA_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct rb_json {
    FILE *out;
    int depth;
    bool begun; // something was written at this depth
    bool line;  // all of it on one line, as NDJSON has it
};

// All take the key of the member; NULL inside of an array and at the outermost level.
void rb_json_object(struct rb_json *json, const char *key);
void rb_json_array(struct rb_json *json, const char *key);
void rb_json_end_object(struct rb_json *json); // the outermost ends with a newline
void rb_json_end_array(struct rb_json *json);
void rb_json_string(struct rb_json *json, const char *key, const char *value); // NULL is null
void rb_json_number(struct rb_json *json, const char *key, double value);
void rb_json_integer(struct rb_json *json, const char *key, int64_t value);
void rb_json_unsigned(struct rb_json *json, const char *key, uint64_t value);
void rb_json_hash(struct rb_json *json, const char *key, uint64_t value); // 16 hex digits, a string
void rb_json_bool(struct rb_json *json, const char *key, bool value);

#endif
