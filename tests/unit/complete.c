// What can stand where on a command line: read off values and synopses, and off the synopsis of
// every command, which must agree with what its parser takes; and the scripts and the page made
// from it, with what needs escapes.
#define _POSIX_C_SOURCE 200809L
#include "bench/shell/complete.h"
#include "bench/shell/commands.h"
#include "bench/shell/man.h"
#include "tests/unit/tap.h"

#include <stdlib.h>
#include <string.h>

static const struct rb_option own[] = {
    {"--rows", "VARIANT,...", RB_OPTION_TEXT, 0, 0, 0, "it's [one]: or \\ more"},
    {"--quiet", NULL, RB_OPTION_FLAG, 0, 0, 0, "silence"},
    {.name = NULL},
};

static const struct rb_command example = {
    .name = "example",
    .summary = "an example",
    .synopsis = "--rows VARIANT,... [--quiet] RESULT [N] [SCENE...|PLAN] [options]",
    .text =
        "A text.\n.TH it isn't, `nor` a \\ or ^.\n\n  raybench example --rows a\n\n  kept as is",
    .groups = (const struct rb_option *const[]){own, NULL},
};

static const struct rb_command secret = {
    .name = "secret",
    .summary = "a secret",
    .synopsis = "",
    .text = "",
    .groups = (const struct rb_option *const[]){NULL},
    .hidden = true,
};

static const struct rb_command *const commands[] = {&secret, &example, &secret, NULL};

static bool words_are(const char *value, const char *expected)
{
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    rb_complete_words(out, value);
    fclose(out);
    bool same = strcmp(text, expected) == 0;
    if (!same)
        note("'%s'", text);
    free(text);
    return same;
}

static void test_values(void)
{
    ok(rb_complete_takes("N") == 0 && words_are("N", ""), "of a number nothing is known");
    ok(rb_complete_takes("WxH") == 0 && rb_complete_takes("") == 0, "nor of what has no name here");
    ok(rb_complete_takes("FILE") == RB_TAKES_FILES, "files");
    ok(rb_complete_takes("DIR|FILE") == (RB_TAKES_FILES | RB_TAKES_FOLDERS), "alternatives");
    ok(rb_complete_takes("auto|X") == RB_TAKES_WORDS && words_are("auto|X", "auto"), "words");
    ok(words_are("p3d|spd|google-benchmark", "p3d spd google-benchmark"), "several words");
    ok(words_are("GENERATOR|none", "balls mount balls_low balls_medium balls_high mount_low "
                                   "mount_high mount_very_high none"),
       "words of a table");
    ok(rb_complete_takes("VARIANT,...") == (RB_TAKES_WORDS | RB_TAKES_LIST), "a list");
    ok(rb_complete_takes("SCENES") == 0 && rb_complete_takes("SCEN") == 0, "whole names only");
}

static void test_positions(void)
{
    struct rb_position positions[RB_POSITIONS_MAX];
    ok(rb_complete_positions(&example, positions) == 3, "three arguments");
    ok(strcmp(positions[0].value, "RESULT") == 0 && !positions[0].optional, "the first");
    ok(strcmp(positions[1].value, "N") == 0 && positions[1].optional && !positions[1].repeated,
       "the second need not be there");
    ok(strcmp(positions[2].value, "SCENE|PLAN") == 0 && positions[2].repeated,
       "the third may be there often");
    ok(rb_complete_positions(&secret, positions) == 0, "no arguments");
}

static void test_synopses(void)
{
    for (const struct rb_command *const *command = rb_commands; *command; command++) {
        struct rb_position positions[RB_POSITIONS_MAX];
        int count = rb_complete_positions(*command, positions), needed = 0;
        bool repeated = false;
        for (int i = 0; i < count; i++) {
            needed += !positions[i].optional;
            repeated |= positions[i].repeated;
        }
        ok(needed == (*command)->positional_min && (repeated ? count <= (*command)->positional_max
                                                             : count == (*command)->positional_max),
           "the synopsis of %s has the arguments it takes", (*command)->name);
    }
}

typedef void put_fn(FILE *out, const struct rb_command *const *commands);

static bool prints(put_fn *put, const char *expected)
{
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    put(out, commands);
    fclose(out);
    bool passed = strstr(text, expected) && strstr(text, "example") && !strstr(text, "secret");
    free(text);
    return passed;
}

int main(void)
{
    test_values();
    test_positions();
    test_synopses();
    ok(prints(rb_complete_bash, "example:--rows) words='naive "), "bash, without hidden commands");
    ok(prints(rb_complete_zsh, "'--rows=[it'\\''s \\[one\\]\\: or \\\\ more]:VARIANT,...: "
                               "_raybench_offer -l naive "),
       "zsh, with its escapes");
    ok(prints(rb_complete_fish, "-d 'it\\'s [one]: or \\\\ more' -l rows -r -f -a "
                                "'(__raybench_list naive "),
       "fish, with its escapes");
    ok(prints(rb_man_write,
              "\n.SS raybench example \\-\\-rows VARIANT,... [\\-\\-quiet] RESULT [N] "
              "[SCENE...|PLAN] [options]\nan example\n.PP\nA text.\n\\&.TH it "
              "isn\\(aqt, \\(ganor\\(ga a \\(rs or \\(ha.\n.PP\n  kept as is\n.TP\n"
              "\\fB\\-\\-rows\\fR \\fIVARIANT,...\\fR\nit\\(aqs [one]: or \\(rs more\n"),
       "the manual page, with its escapes");
    ok(prints(rb_man_write,
              "To an example:\n.PP\n.nf\n.RS 4\nraybench example \\-\\-rows a\n.RE\n"),
       "and its examples");
    return done();
}
