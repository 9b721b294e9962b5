// A scanner for the one shape of JSON that hyperfine exports,
//
//     {"results": [{"command": ..., "user": 0.1, "system": 0.1, "times": [0.2, ...], ...}]}
//
// with members in any order and unknown ones skipped. It checks the grammar of all of the text (RFC
// 8259, except that strings may hold any bytes but control characters).
#include "bench/times/hyperfine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MAX = 32, NAME_ROOM = 16, NUMBER_ROOM = 64 };

struct scanner {
    const char *start, *at, *end;
    const char *problem; // of the first thing wrong, NULL so far
    const char *problem_at;
    struct rb_run_times *times;
    int results; // objects in "results"
    bool user, system, times_seen;
};

static bool fail(struct scanner *s, const char *problem)
{
    if (!s->problem) {
        s->problem = problem;
        s->problem_at = s->at;
    }
    return false;
}

static char peek(struct scanner *s)
{
    while (s->at < s->end && *s->at && strchr(" \t\r\n", *s->at))
        s->at++;
    return s->at < s->end ? *s->at : '\0';
}

static bool expect(struct scanner *s, char c, const char *problem)
{
    if (peek(s) != c)
        return fail(s, problem);
    s->at++;
    return true;
}

static bool is_digit(const struct scanner *s)
{
    return s->at < s->end && *s->at >= '0' && *s->at <= '9';
}

static bool digits(struct scanner *s)
{
    if (!is_digit(s))
        return fail(s, "expected a digit");
    while (is_digit(s))
        s->at++;
    return true;
}

static bool number(struct scanner *s, double *value)
{
    char text[NUMBER_ROOM];
    const char *begin = (peek(s), s->at);
    if (s->at < s->end && *s->at == '-')
        s->at++;
    if (s->at < s->end && *s->at == '0')
        s->at++;
    else if (!digits(s))
        return false;
    if (s->at < s->end && *s->at == '.') {
        s->at++;
        if (!digits(s))
            return false;
    }
    if (s->at < s->end && (*s->at == 'e' || *s->at == 'E')) {
        s->at++;
        if (s->at < s->end && (*s->at == '+' || *s->at == '-'))
            s->at++;
        if (!digits(s))
            return false;
    }
    size_t length = (size_t)(s->at - begin);
    if (length >= sizeof text)
        return fail(s, "number too long");
    memcpy(text, begin, length);
    text[length] = '\0';
    *value = strtod(text, NULL);
    return true;
}

// A duration: finite and not negative.
static bool seconds(struct scanner *s, double *value)
{
    const char *begin = (peek(s), s->at);
    if (!number(s, value))
        return false;
    if (isfinite(*value) && *value >= 0)
        return true;
    s->at = begin;
    return fail(s, "expected a duration in seconds");
}

static bool escape(struct scanner *s)
{
    char c = s->at < s->end ? *s->at : '\0';
    if (c == '\0' || !strchr("\"\\/bfnrtu", c))
        return fail(s, "unknown escape in a string");
    s->at++;
    for (int i = 0; c == 'u' && i < 4; i++, s->at++)
        if (s->at == s->end || *s->at == '\0' || !strchr("0123456789abcdefABCDEF", *s->at))
            return fail(s, "expected four hexadecimal digits");
    return true;
}

// `name` gets the string as it stands, cut off where there is no room; NULL to skip it.
static bool string(struct scanner *s, char name[NAME_ROOM])
{
    if (!expect(s, '"', "expected a string"))
        return false;
    const char *begin = s->at;
    while (s->at < s->end && *s->at != '"') {
        if ((unsigned char)*s->at < 0x20)
            return fail(s, "control character in a string");
        if (*s->at++ == '\\' && !escape(s))
            return false;
    }
    if (s->at == s->end)
        return fail(s, "unfinished string");
    size_t length = (size_t)(s->at++ - begin);
    if (name) {
        length = length < NAME_ROOM ? length : NAME_ROOM - 1;
        memcpy(name, begin, length);
        name[length] = '\0';
    }
    return true;
}

static bool word(struct scanner *s)
{
    static const char *const words[] = {"null", "true", "false"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        size_t length = strlen(words[i]);
        if ((size_t)(s->end - s->at) >= length && memcmp(s->at, words[i], length) == 0) {
            s->at += length;
            return true;
        }
    }
    return fail(s, "expected a value");
}

typedef bool member_fn(struct scanner *s, const char *name, int depth);

static bool skip(struct scanner *s, const char *name, int depth);

// A list between brackets; `element` reads one, its name "" in an array.
static bool group(struct scanner *s, char open, char close, member_fn *element, int depth)
{
    char name[NAME_ROOM] = "";
    if (!expect(s, open, open == '{' ? "expected an object" : "expected an array"))
        return false;
    if (depth == DEPTH_MAX)
        return fail(s, "nested too deep");
    if (peek(s) == close) {
        s->at++;
        return true;
    }
    for (;;) {
        if (open == '{' && (!string(s, name) || !expect(s, ':', "expected a colon")))
            return false;
        if (!element(s, name, depth + 1))
            return false;
        if (peek(s) == close) {
            s->at++;
            return true;
        }
        if (!expect(s, ',', "expected a comma or the end of the list"))
            return false;
    }
}

static bool skip(struct scanner *s, const char *name, int depth)
{
    (void)name;
    double ignored;
    char c = peek(s);
    if (c == '{' || c == '[')
        return group(s, c, c == '{' ? '}' : ']', skip, depth);
    if (c == '"')
        return string(s, NULL);
    return c == '-' || is_digit(s) ? number(s, &ignored) : word(s);
}

static bool one_time(struct scanner *s, const char *name, int depth)
{
    (void)name, (void)depth;
    double value;
    return seconds(s, &value) && (rb_array_push(&s->times->wall_s, &value, sizeof value) ||
                                  fail(s, "not enough memory for the times"));
}

// True the first time.
static bool once(struct scanner *s, bool *seen)
{
    bool first = !*seen;
    *seen = true;
    return first || fail(s, "a member is there twice");
}

static bool result_member(struct scanner *s, const char *name, int depth)
{
    if (strcmp(name, "times") == 0)
        return once(s, &s->times_seen) && group(s, '[', ']', one_time, depth);
    if (strcmp(name, "user") == 0)
        return once(s, &s->user) && seconds(s, &s->times->user_s);
    if (strcmp(name, "system") == 0)
        return once(s, &s->system) && seconds(s, &s->times->system_s);
    return skip(s, name, depth);
}

static bool result(struct scanner *s, const char *name, int depth)
{
    (void)name;
    if (peek(s), s->results++)
        return fail(s, "expected the result of one command");
    return group(s, '{', '}', result_member, depth);
}

static bool top_member(struct scanner *s, const char *name, int depth)
{
    return strcmp(name, "results") == 0 ? group(s, '[', ']', result, depth) : skip(s, name, depth);
}

static bool document(struct scanner *s)
{
    if (!group(s, '{', '}', top_member, 0))
        return false;
    if (peek(s), s->at < s->end)
        return fail(s, "expected the end of the file");
    if (!s->times_seen || !s->user || !s->system || s->times->wall_s.count == 0)
        return fail(s, "expected a result with times, user and system");
    return true;
}

enum rb_status rb_hyperfine_parse(const char *text, size_t length, struct rb_run_times *times,
                                  struct rb_error *error)
{
    *times = (struct rb_run_times){0};
    struct scanner s = {.start = text, .at = text, .end = text + length, .times = times};
    if (document(&s))
        return RB_OK;
    error->line = error->column = 1;
    for (const char *c = text; c < s.problem_at; c++) {
        error->line += *c == '\n';
        error->column = *c == '\n' ? 1 : error->column + 1;
    }
    rb_run_times_free(times);
    return rb_error_set(error, RB_INVALID, "not hyperfine's JSON: %s", s.problem);
}
