#include "bench/data/json_read.h"

#include "base/file.h"
#include "base/memory.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Each skip returns the first byte behind what it names, or NULL with `wrong` at what is not right.
struct scan {
    const char *wrong;
    int depth;
};

static const char *skip_value(struct scan *scan, const char *at);

static const char *skip_space(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

static const char *stop(struct scan *scan, const char *at)
{
    scan->wrong = at;
    return NULL;
}

static const char *skip_string(struct scan *scan, const char *at)
{
    if (*at != '"')
        return stop(scan, at);
    for (at++; *at != '"'; at++) {
        if ((unsigned char)*at < 0x20)
            return stop(scan, at);
        if (*at != '\\')
            continue;
        at++;
        if (*at == 'u') {
            for (int i = 0; i < 4; i++)
                if (!isxdigit((unsigned char)*++at))
                    return stop(scan, at);
        } else if (!*at || !strchr("\"\\/bfnrt", *at)) {
            return stop(scan, at);
        }
    }
    return at + 1;
}

static const char *skip_digits(struct scan *scan, const char *at)
{
    size_t count = strspn(at, "0123456789");
    return count ? at + count : stop(scan, at);
}

static const char *skip_number(struct scan *scan, const char *at)
{
    at += *at == '-';
    at = *at == '0' ? at + 1 : skip_digits(scan, at);
    if (at && *at == '.')
        at = skip_digits(scan, at + 1);
    if (at && (*at == 'e' || *at == 'E')) {
        at++;
        at = skip_digits(scan, at + (*at == '-' || *at == '+'));
    }
    return at;
}

static const char *skip_word(struct scan *scan, const char *at)
{
    static const char *const words[] = {"true", "false", "null"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strncmp(at, words[i], strlen(words[i])) == 0)
            return at + strlen(words[i]);
    return stop(scan, at);
}

// A key and its colon; returns where the value begins.
static const char *skip_key(struct scan *scan, const char *at)
{
    at = skip_string(scan, at);
    if (!at)
        return NULL;
    at = skip_space(at);
    return *at == ':' ? skip_space(at + 1) : stop(scan, at);
}

// An object or an array.
static const char *skip_group(struct scan *scan, const char *at)
{
    bool object = *at == '{';
    char end = object ? '}' : ']';
    if (scan->depth == RB_JSON_DEPTH_MAX)
        return stop(scan, at);
    scan->depth++;
    at = skip_space(at + 1);
    while (at && *at != end) {
        if (object)
            at = skip_key(scan, at);
        at = at ? skip_value(scan, at) : NULL;
        at = at ? skip_space(at) : NULL;
        if (!at || *at == end)
            continue;
        if (*at != ',')
            return stop(scan, at);
        at = skip_space(at + 1);
        if (*at == end)
            return stop(scan, at);
    }
    scan->depth--;
    return at ? at + 1 : NULL;
}

static const char *skip_value(struct scan *scan, const char *at)
{
    if (*at == '{' || *at == '[')
        return skip_group(scan, at);
    if (*at == '"')
        return skip_string(scan, at);
    if (*at == '-' || isdigit((unsigned char)*at))
        return skip_number(scan, at);
    return skip_word(scan, at);
}

enum rb_status rb_json_check(const char *text, struct rb_error *error)
{
    struct scan scan = {0};
    const char *end = skip_value(&scan, skip_space(text));
    end = end ? skip_space(end) : NULL;
    if (end && *end == '\0')
        return RB_OK;
    const char *wrong = end ? end : scan.wrong, *line_start = text;
    unsigned long line = 1;
    for (const char *c = text; c < wrong; c++) {
        if (*c == '\n') {
            line++;
            line_start = c + 1;
        }
    }
    error->line = line;
    error->column = (unsigned long)(wrong - line_start) + 1;
    return rb_error_set(error, RB_INVALID, "this is not JSON%s",
                        scan.depth == RB_JSON_DEPTH_MAX ? ", or nested too deeply" : "");
}

enum rb_status rb_json_load(const char *path, char **text, struct rb_error *error)
{
    size_t size;
    enum rb_status status = rb_file_read(path, text, &size, error);
    if (status)
        return status;
    status = rb_json_check(*text, error);
    if (status == RB_OK && strlen(*text) != size)
        status = rb_error_set(error, RB_INVALID, "this is not JSON: it holds a NUL byte");
    if (status) {
        rb_free(*text);
        *text = NULL;
    }
    return status;
}

// The member of the object at `value` whose key is the `length` bytes at `key`.
static const char *find_member(const char *value, const char *key, size_t length)
{
    struct scan scan = {0};
    if (*value != '{')
        return NULL;
    for (const char *at = skip_space(value + 1); *at == '"';) {
        const char *name = at + 1, *member = skip_key(&scan, at);
        if (strncmp(name, key, length) == 0 && name[length] == '"')
            return member;
        at = skip_space(skip_value(&scan, member));
        at += *at == ',';
        at = skip_space(at);
    }
    return NULL;
}

const char *rb_json_find(const char *value, const char *path)
{
    value = value ? skip_space(value) : NULL;
    while (value && *path) {
        size_t length = strcspn(path, ".");
        value = find_member(value, path, length);
        path += length + (path[length] == '.');
    }
    return value;
}

// The character at a backslash, and how many bytes of text stand for it.
static char unescape(const char *at, size_t *length)
{
    static const char from[] = "bfnrt", to[] = "\b\f\n\r\t";
    *length = at[1] == 'u' ? 6 : 2;
    if (at[1] != 'u') {
        const char *known = strchr(from, at[1]);
        return known ? to[known - from] : at[1];
    }
    char digits[5] = {at[2], at[3], at[4], at[5], '\0'};
    unsigned long code = strtoul(digits, NULL, 16);
    return code && code < 256 ? (char)code : '?';
}

bool rb_json_get_text(const char *value, char *out, size_t size)
{
    struct scan scan = {0};
    out[0] = '\0';
    if (!value || *value == '{' || *value == '[' || *value == 'n')
        return false;
    bool quoted = *value == '"';
    const char *end = skip_value(&scan, value) - quoted;
    size_t used = 0, step;
    for (const char *at = value + quoted; at < end && used + 1 < size; at += step) {
        step = 1;
        out[used++] = *at == '\\' ? unescape(at, &step) : *at;
    }
    out[used] = '\0';
    return true;
}

double rb_json_get_number(const char *value)
{
    if (!value || !(*value == '-' || isdigit((unsigned char)*value)))
        return (double)NAN;
    return strtod(value, NULL);
}
