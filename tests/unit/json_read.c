// The JSON reader on what RFC 8259 allows and forbids, and on mutated bytes.
#include "bench/data/json_read.h"

#include "tests/unit/tap.h"

#include <math.h>
#include <string.h>

static const char whole[] =
    "{\"host\": {\"name\": \"a\\\"b\\u0041\\n\", \"cpus\": 2, \"mhz\": 2.5e3},\n"
    " \"list\": [1, {\"x\": [true, null]}, \"]}\"],\n"
    " \"name\": \"outer\", \"none\": null, \"yes\": true, \"e\": {}}\n";

static void refuses(const char *text, unsigned long line, unsigned long column)
{
    struct rb_error error = {0};
    enum rb_status status = rb_json_check(text, &error);
    if (!ok(status == RB_INVALID && error.line == line && error.column == column && error.text[0],
            "refuses %zu bytes at %lu:%lu", strlen(text), line, column))
        note("%d at %lu:%lu in %s", (int)status, error.line, error.column, text);
}

static bool gives(const char *path, const char *expected)
{
    char text[32];
    bool found = rb_json_get_text(rb_json_find(whole, path), text, sizeof text);
    return found ? expected && strcmp(text, expected) == 0 : !expected && !text[0];
}

static void test_lookup(void)
{
    struct rb_error error = {0};
    ok(rb_json_check(whole, &error) == RB_OK, "a document");
    ok(gives("host.name", "a\"bA\n") && gives("name", "outer"), "strings by path");
    ok(gives("yes", "true") && gives("host.cpus", "2"), "words and numbers as text");
    ok(gives("none", NULL) && gives("list", NULL) && gives("e", NULL), "no text in these");
    ok(gives("nam", NULL) && gives("names", NULL) && gives("name.x", NULL) && gives("e.x", NULL),
       "paths that lead nowhere");
    ok(rb_json_get_number(rb_json_find(whole, "host.mhz")) == 2500, "a number");
    ok(isnan(rb_json_get_number(rb_json_find(whole, "name"))) && isnan(rb_json_get_number(NULL)),
       "no number");
    char text[4];
    ok(rb_json_get_text(rb_json_find(whole, "name"), text, sizeof text) && strcmp(text, "out") == 0,
       "a text that does not fit is cut");
    ok(!rb_json_find("[1]", "a") && !rb_json_find(NULL, "a"), "nothing in an array");
}

static void test_mistakes(void)
{
    static const char *const fine[] = {"0", "-1.5E+3", "\"\"", "[ ]", " {} ", "[[[]]]", "null"};
    struct rb_error error = {0};
    for (size_t i = 0; i < sizeof fine / sizeof *fine; i++)
        ok(rb_json_check(fine[i], &error) == RB_OK, "accepts %s", fine[i]);
    refuses("", 1, 1);
    refuses("{\"a\": 1,\n  \"b\" 2}", 2, 7);
    refuses("[1, ]", 1, 5);
    refuses("{\"a\": 1,}", 1, 9);
    refuses("[1 2]", 1, 4);
    refuses("01", 1, 2);
    refuses("1.", 1, 3);
    refuses("-", 1, 2);
    refuses("nul", 1, 1);
    refuses("\"a", 1, 3);
    refuses("\"\t\"", 1, 2);
    refuses("\"\\x\"", 1, 3);
    refuses("\"\\u12g4\"", 1, 6);
    refuses("{} {}", 1, 4);
    refuses("{a: 1}", 1, 2);
    char deep[RB_JSON_DEPTH_MAX + 2];
    memset(deep, '[', sizeof deep);
    deep[sizeof deep - 1] = '\0';
    refuses(deep, 1, RB_JSON_DEPTH_MAX + 1);
}

// Whatever passes the check can be searched.
static void test_mutations(void)
{
    static const char bytes[] = "\"\\{}[],:0-.eutn\n ";
    static const char *const paths[] = {"host.name", "host.mhz", "e.x", "list.x", "name"};
    unsigned state = 1;
    int passed = 0, count = 20000;
    for (int i = 0; i < count; i++) {
        char text[sizeof whole], value[16];
        memcpy(text, whole, sizeof whole);
        for (int k = 0; k <= i % 3; k++) {
            state = state * 1664525u + 1013904223u;
            text[(state >> 8) % (sizeof whole - 1)] = bytes[(state >> 24) % (sizeof bytes - 1)];
        }
        struct rb_error error = {0};
        if (rb_json_check(text, &error) != RB_OK)
            continue;
        passed++;
        for (size_t p = 0; p < sizeof paths / sizeof *paths; p++) {
            const char *found = rb_json_find(text, paths[p]);
            rb_json_get_text(found, value, sizeof value);
            (void)rb_json_get_number(found);
        }
    }
    ok(passed > count / 20 && passed < count, "mutated bytes: %d of %d pass", passed, count);
}

int main(void)
{
    test_lookup();
    test_mistakes();
    test_mutations();
    return done();
}
