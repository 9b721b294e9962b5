// What can be wrong with an NFF file: every kind of mistake with its place, warnings, files that
// end too early, and no memory.
#define _POSIX_C_SOURCE 200809L
#include "tests/unit/read_nff.h"
#include "tests/unit/tap.h"

#include <stdlib.h>
#include <string.h>

struct mistake {
    const char *what, *text;
    unsigned long line, column;
    const char *says;
};

static const struct mistake mistakes[] = {
    {"empty file", "", 1, 1, "nothing in the file"},
    {"only comments", "# nothing\n\n", 3, 1, "nothing in the file"},
    {"missing view", "s 0 0 0 1\n", 2, 1, "no view"},
    {"view without hither", "v from 1 0 0 at 0 0 0 up 0 0 1 angle 45\nresolution 9 9\ns 0 0 0 1", 3,
     1, "add 'hither'"},
    {"view cut off", "v\nfrom 1 2 3\nat 0 0 0\n", 4, 1, "'up', 'angle', 'hither', 'resolution'"},
    {"number in the view", "v\nfrom 1 2 3 4\n", 2, 12, "too many"},
    {"field twice", "v\nfrom 1 2 3\nfrom 1 2 3\n", 3, 1, "second 'from'"},
    {"second view", VIEW VIEW, 8, 1, "second view"},
    {"field outside a view", VIEW "angle 45\n", 8, 1, "outside a view"},
    {"from equals at", "v from 1 2 3 at 1 2 3 up 0 0 1 angle 45 hither 0 resolution 9 9", 1, 1,
     "same point"},
    {"up parallel", "\n  v from 0 0 3 at 0 0 0 up 0 0 1 angle 45 hither 0 resolution 9 9", 2, 3,
     "parallel"},
    {"up zero", "v from 0 0 3 at 0 0 0 up 0 0 0 angle 45 hither 0 resolution 9 9", 1, 1, "'up'"},
    {"angle 180", "v from 0 0 3 at 0 0 0 up 0 1 0\nangle 180 hither 0 resolution 9 9", 2, 7,
     "between 0 and 180"},
    {"resolution 0", "v\nresolution 0 512", 2, 12, "from 1 to 65536"},
    {"resolution 1e9", "v\nresolution 512 1000000000", 2, 16, "from 1 to 65536"},
    {"resolution 1.5", "v\nresolution 1.5 2", 2, 12, "whole number"},
    {"too many pixels", "v from 0 1 3 at 0 0 0 up 0 0 1 angle 45 hither 0 resolution 65536 65536",
     1, 1, "pixels"},
    {"text for a number", VIEW "s 0 0 zero 1\n", 8, 7, "'zero' is not a number"},
    {"NaN", VIEW "s 0 nan 0 1\n", 8, 5, "'nan' is not finite"},
    {"minus infinity", VIEW "s 0 0 0\n -Inf\n", 9, 2, "'-Inf' is not finite"},
    {"overflow", VIEW "s 0 0 1e999 1\n", 8, 7, "too large"},
    {"beyond a scene", VIEW "s 0 0 1e13 1\n", 8, 7, "too large"},
    {"hexadecimal", VIEW "s 0 0 0x10 1\n", 8, 7, "hexadecimal"},
    {"decimal comma", VIEW "s 0 0 1,5 1\n", 8, 7, "decimal point"},
    {"lone sign", VIEW "s 0 0 - 1\n", 8, 7, "not a number"},
    {"half an exponent", VIEW "s 0 0 1e 1\n", 8, 7, "not a number"},
    {"sphere cut off", VIEW "s 0 0\n", 9, 1, "ends inside the sphere that begins at line 8"},
    {"sphere too short", VIEW "s 0 0 0\ns 1 1 1 1\n", 9, 1, "the radius of the sphere"},
    {"sphere too long", VIEW "s 0 0 0 1 2\n", 8, 11, "have too many?"},
    {"number first", "1 2 3\n", 1, 1, "begins with a keyword"},
    {"negative Shine", VIEW "f 1 1 1 1 1 -2 0 0\n", 8, 13, "Shine of the material"},
    {"negative colour", VIEW "b 0 -0.5 0\n", 8, 5, "is negative"},
    {"no index", VIEW "f 1 1 1 1 1 2 0.5 0\n", 8, 19, "index of refraction"},
    {"radii of mixed sign", VIEW "c 0 0 0 1\n0 0 1 -1\n", 9, 7, "same sign"},
    {"two vertices", VIEW "p 2 0 0 0 1 1 1\n", 8, 3, "'2': the number of vertices"},
    {"negative count", VIEW "p -3 0 0 0\n", 8, 3, "from 3 to"},
    {"count of 10^9", VIEW "p 1000000000 0 0 0\n1 1 1\n", 10, 1, "vertex 3 of the polygon"},
    {"count of 10^12", VIEW "p 1000000000000 0 0 0\n", 8, 3, "from 3 to"},
    {"text in a polygon", VIEW "p 3\n0 0 0\n0 1 x\n", 10, 5, "a coordinate of vertex 2"},
    {"zero normal", VIEW "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 0 0 1\n", 10, 7, "length zero"},
    {"collinear plane", VIEW "s 0 0 0 1\n pl 0.1 0.1 0.1 0.2 0.2 0.2 0.3 0.3 0.3\n", 9, 2,
     "on one line"},
    {"plane cut off", VIEW "pl 0 0 0 1 0 0 0 1", 8, 19, "ends inside the plane"},
    {"binary junk",
     "\x7f"
     "ELF\x02\x01 junk",
     1, 1, "'\\x7fELF\\x02\\x01' is neither"},
    {"other comments", VIEW "// comment\n", 8, 1, "neither a keyword"},
    {"a column behind tabs", VIEW "\t\ts 0 0 0 y", 8, 11, "'y'"},
};

static void test_mistakes(void)
{
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        const struct mistake *m = &mistakes[i];
        enum rb_status status = read_text(m->text);
        if (!ok(status == RB_INVALID && error.line == m->line && error.column == m->column &&
                    strstr(error.text, m->says) && strcmp(error.file, "test.nff") == 0 &&
                    !strchr(error.text, '\n') && scene.primitive_count == 0 && !scene.spheres,
                "%s", m->what))
            note("%d %s:%lu:%lu: %s; expected %lu:%lu ...%s...", (int)status, error.file,
                 error.line, error.column, error.text, m->line, m->column, m->says);
    }
    char longest[6000] = "";
    snprintf(longest, sizeof longest, VIEW "s 0 0 %05000d 1", 7);
    ok(read_text(longest) == RB_INVALID && error.line == 8 && error.column == 7 &&
           strstr(error.text, "too long"),
       "a number of 5000 digits: %s", error.text);
    memset(longest, 'k', sizeof longest - 1);
    ok(read_text(longest) == RB_INVALID && strstr(error.text, "'kkkkkkkkkkkkkkkkkkkkkkkk...'"),
       "a keyword of 6000 bytes: %s", error.text);
}

static void test_warnings(void)
{
    enum rb_status status =
        read_text("bclr 0 0 0\n" VIEW "  env sky\nmesh 1 2 # 3\nenv sea\ns 0 0 0 1\n");
    ok(status == RB_OK && warning_count == 3 && warnings[0].line == 1 && warnings[1].line == 9 &&
           warnings[1].column == 3 && strstr(warnings[1].text, "'env'") && warnings[2].line == 10 &&
           scene.count[RB_SPHERE] == 1,
       "each unknown keyword warns once and its lines are skipped");
    status = read_text("v\nfrom 1 0 0\nat 0 0 0\nup 0 0 1\nangle 45\naperture 3\nhither 1\n"
                       "resolution 9 9\ns 0 0 0 1\n");
    ok(status == RB_OK && warning_count == 1 && warnings[0].line == 6,
       "an unknown field of the view");
    ok(read_text(VIEW "mesh 3\n1 2 3\n") == RB_INVALID && error.line == 9 &&
           strstr(error.text, "unknown keyword of line 8"),
       "numbers behind an unknown keyword: %s", error.text);

    char many[4000] = VIEW "s 0 0 0 1\n";
    for (int i = 0; i < 100; i++)
        snprintf(many + strlen(many), 32, "word%d 1 2 3\n", i);
    ok(read_text(many) == RB_OK && warning_count == 33 && strstr(warnings[32].text, "further"),
       "100 unknown keywords give 33 warnings");

    const char *unknown = VIEW "s 0 0 0 1\n box 0 0 0 1 1 1\n";
    ok(read_bytes(unknown, strlen(unknown), true) == RB_INVALID && error.line == 9 &&
           error.column == 2 && strstr(error.text, "'box'"),
       "strict: %s", error.text);
    ok(read_text(VIEW) == RB_OK && warning_count == 1 && strstr(warnings[0].text, "no objects"),
       "a scene without objects: %s", warnings[0].text);
    ok(read_text(VIEW "s 0 0 0 0\np 3 0 0 0 1 1 1 2 2 2\nc 0 0 0 1 0 0 0 1\nc 0 0 0 0 1 1 1 0\n"
                      "p 4 0 0 0 1 0 0 2 0 0 3 0 0\ns 0 0 0 1e-60\n") == RB_OK &&
           scene.primitive_count == 0 && warning_count == 2 && warnings[0].line == 0 &&
           strstr(warnings[0].text, "6 objects without extent dropped, the first at line 8"),
       "objects without extent: %s", warnings[0].text);
    ok(read_text(VIEW "p 5 0 0 0 1 0 0 2 0 0 2 2 0 0 2 0") == RB_OK && warning_count == 0,
       "a straight vertex is no reason to warn");
}

// A file cut off anywhere is either still a scene or an error, never worse.
static void test_truncated(void)
{
    const char *text =
        "b 0.078 0.361 0.753 # sky\r\n" VIEW "l 4 3 2 1 1 1\nl 1 -4 4\n"
        "f 1 .75 0.33 0.8 0 1e5 0.5 1.5\ns 1 2 3 -0.5\nc 0 0 0 1\n0 0 2 0.5\n"
        "p 5 0 0 0 4 0 0 4 4 0 3 1 0 0 4 0\npp 3 0 0 0 0 0 2 1 0 0 0 2 0 0 1 0 1 0 0\n"
        "unknown 1 2 3\npl 12 12 -0.5 -12 12 -0.5 -12 -12 -0.5\n";
    size_t length = strlen(text), fine = 0, refused = 0;
    long live = 0;
    for (size_t cut = 0; cut <= length; cut++) {
        char *copy = malloc(cut + 1); // exact, so that a sanitizer sees one byte too far
        memcpy(copy, text, cut);
        enum rb_status status = read_bytes(copy, cut, false);
        fine += status == RB_OK;
        refused += status == RB_INVALID && error.text[0] != '\0' && error.line > 0;
        rb_scene_free(&scene);
        live += rb_memory_live_count();
        free(copy);
    }
    ok(fine + refused == length + 1 && fine > 10 && refused > 100 && live == 0,
       "cut off at each of %zu bytes: %zu scenes, %zu errors", length, fine, refused);
}

// Every allocation of a read may fail.
static void test_memory(void)
{
    const char *text = VIEW "l 4 3 2\nf 1 1 1 1 1 1 1 1.5\ns 1 2 3 4\nc 0 0 0 1 0 0 2 1\n"
                            "p 3 0 0 0 1 0 0 0 1 0\npp 3 0 0 0 0 0 2 1 0 0 0 2 0 0 1 0 1 0 0\n"
                            "p 4 0 0 0 4 0 0 4 4 0 3 1 0\npl 1 2 3 4 5 6 7 8 8\n";
    long failures = 0;
    bool clean = true;
    enum rb_status status = RB_FAILED;
    for (long n = 1; status != RB_OK && n < 1000; n++) {
        rb_scene_free(&scene);
        rb_memory_fail_at(n);
        status = read_text(text);
        rb_memory_fail_at(0);
        failures += status == RB_FAILED;
        clean = clean && (status == RB_OK || (rb_memory_live_count() == 0 && error.line == 0 &&
                                              strstr(error.text, "not enough memory")));
    }
    ok(status == RB_OK && failures > 20 && clean, "each of %ld allocations may fail", failures);
}

int main(void)
{
    test_mistakes();
    test_warnings();
    test_truncated();
    test_memory();
    rb_scene_free(&scene);
    ok(rb_memory_live_count() == 0, "no memory left behind");
    return done();
}
