// hyperfine's JSON: the shape it has, every way to break it, and bytes at random.
#define _POSIX_C_SOURCE 200809L
#include "bench/times/hyperfine.h"
#include "base/random.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// As hyperfine 1.15.0 writes it.
static const char good[] =
    "{\n  \"results\": [\n    {\n"
    "      \"command\": \"'a b' \\\"c\\u00e9\\\\\",\n"
    "      \"mean\": 0.25,\n      \"stddev\": null,\n"
    "      \"user\": 0.125,\n      \"system\": 5e-1,\n"
    "      \"times\": [\n        0.25,\n        0.5,\n        1E0\n      ],\n"
    "      \"exit_codes\": [0, 0, 0],\n      \"parameters\": {\"x\": [{}]}\n"
    "    }\n  ]\n}\n";

// Parses a copy that ends exactly where the text does, for the sanitizers.
static enum rb_status parse(const char *text, size_t length, struct rb_run_times *times,
                            struct rb_error *error)
{
    char *copy = malloc(length + 1);
    memcpy(copy, text, length);
    copy[length] = '\0';
    *error = (struct rb_error){0};
    enum rb_status status = rb_hyperfine_parse(copy, length, times, error);
    free(copy);
    return status;
}

static void check_good(void)
{
    struct rb_run_times times;
    struct rb_error error;
    bool read = parse(good, sizeof good - 1, &times, &error) == RB_OK;
    const double *t = times.wall_s.data;
    ok(read && times.wall_s.count == 3 && t[0] == 0.25 && t[1] == 0.5 && t[2] == 1.0,
       "the times of all runs");
    ok(read && times.user_s == 0.125 && times.system_s == 0.5, "user and system time");
    rb_run_times_free(&times);
}

static void check_bad(void)
{
    static const struct {
        const char *text, *problem;
        unsigned long line, column;
    } cases[] = {
        {"", "an object", 1, 1},
        {"[]", "an object", 1, 1},
        {"{}", "a result with times", 1, 3},
        {"{\"results\": []}", "a result with times", 1, 16},
        {"{\"results\": [{\"times\": [1], \"user\": 1}]}", "a result with times", 1, 41},
        {"{\"results\": [{\"times\": [], \"user\": 1, \"system\": 1}]}", "a result with", 1, 53},
        {"{\"results\": [{}, {}]}", "of one command", 1, 18},
        {"{\"results\": [{\"user\": 1,\n \"user\": 1}]}", "twice", 2, 9},
        {"{\"results\": [{\"times\": [-1]}]}", "duration", 1, 25},
        {"{\"results\": [{\"times\": [1e999]}]}", "duration", 1, 25},
        {"{\"results\": [{\"times\": [null]}]}", "a digit", 1, 25},
        {"{\"results\": [{\"times\": [01]}]}", "a comma", 1, 26},
        {"{\"results\": [{\"times\": [1.]}]}", "a digit", 1, 27},
        {"{\"results\": [{\"times\": [1e]}]}", "a digit", 1, 27},
        {"{\"results\": [{\"times\": [1,]}]}", "a digit", 1, 27},
        {"{\"results\": [{\"times\": 1}]}", "an array", 1, 24},
        {"{\"a\": \"\\x\"}", "escape", 1, 9},
        {"{\"a\": \"\\u12g4\"}", "hexadecimal", 1, 12},
        {"{\"a\": \"\n\"}", "control", 1, 8},
        {"{\"a\": \"b", "unfinished", 1, 9},
        {"{\"a\" 1}", "a colon", 1, 6},
        {"{\"a\": nul}", "a value", 1, 7},
        {"{\"a\": 1} x", "the end of the file", 1, 10},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct rb_run_times times;
        struct rb_error error;
        enum rb_status status = parse(cases[i].text, strlen(cases[i].text), &times, &error);
        if (!ok(status == RB_INVALID && strstr(error.text, cases[i].problem) &&
                    error.line == cases[i].line && error.column == cases[i].column,
                "refused: %s", cases[i].problem))
            note("%lu:%lu: %s", error.line, error.column, error.text);
    }
    char deep[4000] = "{\"a\": ";
    memset(deep + 6, '[', sizeof deep - 7);
    struct rb_run_times times;
    struct rb_error error;
    ok(parse(deep, strlen(deep), &times, &error) == RB_INVALID &&
           strstr(error.text, "nested too deep"),
       "refused: nested too deep");
}

// Whatever the bytes: an answer, and finite times if there are any.
static void check_mutations(void)
{
    enum { ROUNDS = 20000 };
    bool sane = true;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        char text[sizeof good];
        size_t length = sizeof good - 1;
        memcpy(text, good, sizeof good);
        for (uint32_t k = 0; k < 1 + round % 4; k++) {
            size_t at = (size_t)(rb_random(1, round, k, 0, 0) * (float)length);
            static const char bytes[] = "{}[],:\"\\-+.eE019ntu \n\xff";
            size_t which = (size_t)(rb_random(1, round, k, 1, 0) * (float)sizeof bytes);
            text[at] = bytes[which]; // its final NUL included
        }
        if (round % 3 == 0)
            length = (size_t)(rb_random(1, round, 9, 2, 0) * (float)length);
        struct rb_run_times times;
        struct rb_error error;
        if (parse(text, length, &times, &error) != RB_OK) {
            sane = sane && error.line > 0 && error.text[0];
            continue;
        }
        for (size_t i = 0; i < times.wall_s.count; i++)
            sane = sane && isfinite(((double *)times.wall_s.data)[i]);
        rb_run_times_free(&times);
    }
    ok(sane, "%d mutated texts", ROUNDS);
    ok(rb_memory_live_count() == 0, "all memory is released");
}

static void check_quotes(void)
{
    char line[64], small[8];
    char *words[] = {"/a b/x", "it's", "", NULL};
    ok(rb_hyperfine_quote(words, line, sizeof line) && strcmp(line, "'/a b/x' 'it'\\''s' ''") == 0,
       "words are quoted");
    ok(!rb_hyperfine_quote(words, small, sizeof small), "a line too long is refused");
}

int main(void)
{
    check_good();
    check_bad();
    check_mutations();
    check_quotes();
    return done();
}
