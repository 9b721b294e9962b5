// The option parser: every kind of value, keys of files, suggestions, and any text whatever.
#include "cli/options.h"
#include "base/hash.h"
#include "cli/suggest.h"
#include "tests/unit/tap.h"

#include <string.h>

static const struct rb_option own[] = {
    {"--budget", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 0.1, 86400, ""},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0, ""},
    {"--variant", "NAME", RB_OPTION_TEXT, offsetof(struct rb_arguments, variant), 0, 0, ""},
    {"--count", "N", RB_OPTION_COUNT, offsetof(struct rb_arguments, size), 0, 0, ""},
    {"--brightness", "auto|X", RB_OPTION_LIGHT_SCALE,
     offsetof(struct rb_arguments, settings.light_scale), 1e-6, 1e6, ""},
    {"--pixels", "WxH", RB_OPTION_SIZE, offsetof(struct rb_arguments, settings), 0, 0, ""},
    {"--random", "N", RB_OPTION_SEED, offsetof(struct rb_arguments, settings.seed), 0, 0, ""},
    {"--dialect", "p3d|spd", RB_OPTION_DIALECT, offsetof(struct rb_arguments, dialect), 0, 0, ""},
    {"-o", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0, ""},
    {.name = NULL},
};

static const struct rb_command command = {
    .name = "test",
    .synopsis = "",
    .groups = (const struct rb_option *const[]){own, rb_options_settings, rb_options_levels,
                                                rb_options_threads, NULL},
};

static struct rb_arguments arguments;
static struct rb_error error;

static bool assigns(const char *name, const char *value)
{
    error.text[0] = '\0';
    return rb_options_assign(&command, name, value, &arguments, &error) == RB_OK;
}

static bool complains(const char *name, const char *value, const char *text)
{
    bool passed = !assigns(name, value) && strcmp(error.text, text) == 0;
    if (!passed)
        note("%s", error.text);
    return passed;
}

static void test_times(void)
{
    static const struct {
        const char *text;
        double s;
    } good[] = {{"90", 90},   {"90s", 90},     {"1.5m", 90}, {"500ms", 0.5},
                {"2h", 7200}, {"1e2s", 100.0}, {".5", 0.5},  {"24h", 86400}};
    static const char *const bad[] = {"",    "s",   "ms",  "-5",  "-5s",   "5d",    "5 s",
                                      "5sm", "25h", "nan", "inf", "1e99",  "1e999", "99999999",
                                      "0",   "1ms", "5hh", "0x9", "1.2.3s"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        ok(assigns("budget", good[i].text) && arguments.budget_s == good[i].s, "time %s is %g s",
           good[i].text, good[i].s);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        ok(!assigns("budget", bad[i]), "no time: '%s'", bad[i]);
    ok(complains("budget", "5d",
                 "budget 5d: expected a time in seconds (or such as 500ms, 90s, 1.5m, 2h) "
                 "from 0.1 to 86400"),
       "a bad time says what was expected");
}

static void test_keys(void)
{
    ok(assigns("quiet", "yes") && arguments.quiet, "a flag is on with yes");
    ok(assigns("quiet", "no") && !arguments.quiet, "and off with no");
    ok(complains("quiet", "", "quiet : expected yes or no"), "and takes nothing else");
    ok(assigns("size", "64x48") && arguments.settings.width == 64 &&
           arguments.settings.height == 48,
       "a size");
    ok(!assigns("size", "64") && !assigns("size", "x") && !assigns("size", "64x48x2"), "no sizes");
    ok(assigns("depth", "7") && arguments.settings.depth == 7, "a whole number");
    ok(complains("depth", "7.5", "depth 7.5: expected a whole number from 1 to 32"),
       "no whole number");
    ok(assigns("seed", "18446744073709551615") && arguments.settings.seed == UINT64_MAX, "a seed");
    ok(!assigns("seed", "18446744073709551616") && !assigns("seed", "-1"), "no seeds");
    ok(assigns("specular", "phong") && arguments.settings.phong, "phong");
    ok(assigns("specular", "blinn") && !arguments.settings.phong, "blinn");
    ok(assigns("light-scale", "2") && arguments.settings.light_scale == 2, "a light scale");
    ok(assigns("light-scale", "auto") && arguments.settings.light_scale == 0, "auto");
    ok(complains("light-scale", "0",
                 "light-scale 0: expected auto or a number from 1e-06 to 1000000"),
       "no light scale");
    ok(assigns("dialect", "spd") && arguments.dialect == RB_DIALECT_SPD, "a dialect");
    ok(assigns("count", "3") && arguments.size == 3 && arguments.size_given, "a count");
    ok(assigns("variant", "bvh") && strcmp(arguments.variant, "bvh") == 0, "a text");
}

static void test_suggestions(void)
{
    ok(complains("dept", "3", "unknown key 'dept'; did you mean depth?"), "a letter missing");
    ok(complains("--depth", "3", "unknown key '--depth'; did you mean depth?"), "dashes");
    ok(complains("light-sise", "3", "unknown key 'light-sise'; did you mean light-size?"),
       "the nearer of two");
    ok(complains("light-s", "3", "unknown key 'light-s'"), "nothing near");
    ok(complains("o", "3", "unknown key 'o'"), "a key has a long name");
    ok(complains("help", "yes", "unknown key 'help'"), "help is no key");
    ok(complains("", "3", "unknown key ''"), "an empty key");
    ok(complains("dialext ", "3", "unknown key 'dialext '; did you mean dialect?"), "two letters");
    char long_word[1000];
    memset(long_word, 'x', sizeof long_word - 1);
    long_word[sizeof long_word - 1] = '\0';
    ok(!assigns(long_word, "3") && strstr(error.text, "xxx'"), "a long key is cut");

    struct rb_suggestion tie = {.typed = "bat-", .length = 3};
    char text[RB_SUGGESTION_TEXT];
    rb_suggestion_offer(&tie, "cat");
    ok(strcmp(rb_suggestion_text(&tie, text), "; did you mean cat?") == 0, "one near word");
    rb_suggestion_offer(&tie, "rat");
    ok(strcmp(rb_suggestion_text(&tie, text), "") == 0, "two words as near are none");
    rb_suggestion_offer(&tie, "bat");
    ok(strcmp(rb_suggestion_text(&tie, text), "; did you mean bat?") == 0, "unless one is nearer");
}

static void test_words(void)
{
    char *words[] = {"--depth=3", "--quiet", "--budget", "2m", "--aaa"};
    struct rb_arguments parsed = {0};
    ok(rb_options_parse(&command, 4, words, &parsed, &error) == RB_OK &&
           parsed.settings.depth == 3 && parsed.quiet && parsed.budget_s == 120,
       "words of a command line");
    ok(rb_options_parse(&command, 5, words, &parsed, &error) == RB_INVALID &&
           strcmp(error.text, "unknown option --aaa; did you mean --aa?") == 0,
       "an unknown one");
    char *help[] = {"--hepl"};
    ok(rb_options_parse(&command, 1, help, &parsed, &error) == RB_INVALID &&
           strcmp(error.text, "unknown option --hepl; did you mean --help?") == 0,
       "--help is suggested too");
    ok(rb_options_parse(&command, 3, words, &parsed, &error) == RB_INVALID &&
           strcmp(error.text, "--budget needs a value: TIME") == 0,
       "a value is missing");
}

// Any text in any option: for the sanitizers. What a parser refuses has its one line.
static void test_anything(void)
{
    static const char letters[] = "01259.-+eExsmh,ginfauto \n\x7f\xff";
    bool told = true;
    uint64_t hash = 0;
    for (uint64_t round = 0; round < 20000; round++)
        for (const struct rb_option *option = own; option->name; option++) {
            char text[12] = "";
            hash = rb_hash_word(hash, round);
            for (size_t i = 0; i < hash % sizeof text; i++)
                text[i] = letters[(hash >> 5 * i) % (sizeof letters - 1)];
            if (!assigns(option->name + strspn(option->name, "-"), text))
                told &= error.text[0] != '\0';
        }
    ok(told, "any text is parsed or refused with a line");
}

int main(void)
{
    test_times();
    test_keys();
    test_suggestions();
    test_words();
    test_anything();
    return done();
}
