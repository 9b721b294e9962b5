#include "cli/options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SETTING(field) offsetof(struct rb_arguments, settings.field)

const struct rb_option rb_options_settings[] = {
    {"--size", "WxH", RB_OPTION_SIZE, 0, 0, 0, "image size; default: the scene's resolution"},
    {"--aa", "N", RB_OPTION_INT, SETTING(aa), 1, RB_AA_MAX,
     "anti-aliasing: N x N stratified rays per pixel; default 1"},
    {"--light-size", "S", RB_OPTION_NUMBER, SETTING(light_size), 0, 1e6,
     "edge of the square lights in world units, for soft shadows; default 0"},
    {"--light-scale", "auto|X", RB_OPTION_LIGHT_SCALE, 0, 0, 0,
     "multiplies every light; auto = 1/sqrt(number of lights)"},
    {"--ambient", "A", RB_OPTION_NUMBER, SETTING(ambient), 0, 1e6,
     "adds A x Kd x colour to every hit; default 0"},
    {"--specular", "blinn|phong", RB_OPTION_SPECULAR, 0, 0, 0,
     "highlight by half vector or by mirrored ray; default blinn"},
    {"--spd", NULL, RB_OPTION_FLAG, SETTING(spd), 0, 0,
     "SPD's test rules: rays through pixel corners, one-sided opaque surfaces"},
    {"--seed", "N", RB_OPTION_SEED, SETTING(seed), 0, 0, "of the random numbers; default 0"},
    {.name = NULL},
};

const struct rb_option rb_options_levels[] = {
    {"--depth", "N", RB_OPTION_INT, SETTING(depth), 1, RB_DEPTH_MAX,
     "levels of the ray tree, 1 = camera rays only; default 5"},
    {"--light-samples", "N", RB_OPTION_INT, SETTING(light_samples), 1, RB_LIGHT_SAMPLES_MAX,
     "shadow rays per light; default 1"},
    {.name = NULL},
};

const struct rb_option rb_options_variant[] = {
    {"--variant", "NAME", RB_OPTION_TEXT, offsetof(struct rb_arguments, variant), 0, 0,
     "row of `raybench list variants`; default: the fastest available"},
    {.name = NULL},
};

const struct rb_option rb_options_threads[] = {
    {"--threads", "N", RB_OPTION_INT, SETTING(threads), 1, RB_THREADS_MAX,
     "threads of a +omp row; default: as OpenMP has it, all processors"},
    {"--tile", "N", RB_OPTION_INT, SETTING(tile), RB_BLOCK, RB_TILE_MAX,
     "edge of a tile in pixels, a multiple of 16; default 64"},
    {.name = NULL},
};

const struct rb_option rb_options_strict[] = {
    {"--strict", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, strict), 0, 0,
     "an unknown keyword in the scene is an error, not a warning"},
    {.name = NULL},
};

static const struct rb_option help_option = {
    "--help", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, help), 0, 0, "this text",
};

static const struct rb_option *find(const struct rb_command *command, const char *name,
                                    size_t length)
{
    for (const struct rb_option *const *group = command->groups; *group; group++)
        for (const struct rb_option *option = *group; option->name; option++)
            if (strlen(option->name) == length && memcmp(option->name, name, length) == 0)
                return option;
    bool help = (length == 6 && memcmp(name, "--help", 6) == 0) ||
                (length == 2 && memcmp(name, "-h", 2) == 0);
    return help ? &help_option : NULL;
}

static enum rb_status refuse(const struct rb_option *option, const char *text, const char *wanted,
                             struct rb_error *error)
{
    return rb_error_set(error, RB_INVALID, "%s %s: expected %s", option->name, text, wanted);
}

static bool parse_number(const char *text, double low, double high, double *value)
{
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    bool decimal = strspn(text, "0123456789+-.eE") == strlen(text);
    return end != text && *end == '\0' && decimal && errno == 0 && *value >= low && *value <= high;
}

static bool parse_integer(const char *text, double low, double high, int *value)
{
    double number;
    if (!parse_number(text, low, high, &number) || number != floor(number))
        return false;
    *value = (int)number;
    return true;
}

static bool parse_time(const char *text, double low, double high, double *seconds)
{
    static const struct {
        const char *suffix;
        double seconds;
    } units[] = {{"ms", 1e-3}, {"s", 1}, {"m", 60}, {"h", 3600}, {"", 1}};
    char number[32];
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        size_t length = strlen(text), suffix = strlen(units[i].suffix);
        if (length < suffix || length - suffix >= sizeof number ||
            strcmp(text + length - suffix, units[i].suffix) != 0)
            continue;
        snprintf(number, sizeof number, "%.*s", (int)(length - suffix), text);
        if (!parse_number(number, 0, HUGE_VAL, seconds))
            return false;
        *seconds *= units[i].seconds;
        return *seconds >= low && *seconds <= high;
    }
    return false;
}

static bool parse_size(const char *text, struct rb_settings *settings)
{
    char width[16] = "";
    const char *x = strchr(text, 'x');
    if (!x || (size_t)(x - text) >= sizeof width)
        return false;
    memcpy(width, text, (size_t)(x - text));
    return parse_integer(width, 1, RB_SIZE_MAX, &settings->width) &&
           parse_integer(x + 1, 1, RB_SIZE_MAX, &settings->height);
}

static bool parse_seed(const char *text, uint64_t *seed)
{
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    *seed = value;
    return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0;
}

// Is `text` the first or the second word? The answer goes to `second`.
static bool parse_either(const char *text, const char *first_word, const char *second_word,
                         bool *second)
{
    *second = strcmp(text, second_word) == 0;
    return *second || strcmp(text, first_word) == 0;
}

static enum rb_status assign(const struct rb_option *option, const char *text,
                             struct rb_arguments *arguments, struct rb_error *error)
{
    void *target = (char *)arguments + option->offset;
    char wanted[96];
    bool second = false;
    switch (option->kind) {
    case RB_OPTION_FLAG:
        *(bool *)target = true;
        return RB_OK;
    case RB_OPTION_TEXT:
        *(const char **)target = text;
        return RB_OK;
    case RB_OPTION_INT:
        snprintf(wanted, sizeof wanted, "a whole number from %.0f to %.0f", option->low,
                 option->high);
        return parse_integer(text, option->low, option->high, target)
                   ? RB_OK
                   : refuse(option, text, wanted, error);
    case RB_OPTION_NUMBER:
        snprintf(wanted, sizeof wanted, "a number from %g to %g", option->low, option->high);
        return parse_number(text, option->low, option->high, target)
                   ? RB_OK
                   : refuse(option, text, wanted, error);
    case RB_OPTION_TIME:
        snprintf(wanted, sizeof wanted, "a time such as 90s or 5m, from %g s to %g s", option->low,
                 option->high);
        return parse_time(text, option->low, option->high, target)
                   ? RB_OK
                   : refuse(option, text, wanted, error);
    case RB_OPTION_SEED:
        return parse_seed(text, target) ? RB_OK
                                        : refuse(option, text, "a whole number below 2^64", error);
    case RB_OPTION_SIZE:
        return parse_size(text, &arguments->settings)
                   ? RB_OK
                   : refuse(option, text, "WIDTHxHEIGHT in pixels, such as 512x512", error);
    case RB_OPTION_SPECULAR:
        if (!parse_either(text, "blinn", "phong", &arguments->settings.phong))
            return refuse(option, text, "blinn or phong", error);
        return RB_OK;
    case RB_OPTION_LIGHT_SCALE:
        if (strcmp(text, "auto") == 0)
            arguments->settings.light_scale = 0;
        else if (!parse_number(text, 1e-6, 1e6, &arguments->settings.light_scale))
            return refuse(option, text, "auto or a number from 1e-6 to 1e6", error);
        return RB_OK;
    case RB_OPTION_DIALECT:
        if (!parse_either(text, "p3d", "spd", &second))
            return refuse(option, text, "p3d or spd", error);
        arguments->dialect = second ? RB_DIALECT_SPD : RB_DIALECT_P3D;
        return RB_OK;
    case RB_OPTION_COUNT:
        arguments->size_given = true;
        return parse_integer(text, 0, INT_MAX, &arguments->size)
                   ? RB_OK
                   : refuse(option, text, "a whole number", error);
    }
    return RB_INVALID;
}

enum rb_status rb_options_parse(const struct rb_command *command, int count, char **words,
                                struct rb_arguments *arguments, struct rb_error *error)
{
    bool options_end = false;
    for (int i = 0; i < count; i++) {
        char *word = words[i];
        if (options_end || word[0] != '-' || strcmp(word, "-") == 0) {
            if (arguments->positional_count == command->positional_max)
                return rb_error_set(error, RB_INVALID, "unexpected argument '%s'", word);
            arguments->positional[arguments->positional_count++] = word;
            continue;
        }
        options_end = strcmp(word, "--") == 0;
        if (options_end)
            continue;
        const char *equals = strncmp(word, "--", 2) == 0 ? strchr(word, '=') : NULL;
        size_t length = equals ? (size_t)(equals - word) : strlen(word);
        const struct rb_option *option = find(command, word, length);
        if (!option)
            return rb_error_set(error, RB_INVALID, "unknown option %s", word);
        if (!option->value && equals)
            return rb_error_set(error, RB_INVALID, "%s takes no value", option->name);
        if (option->value && !equals && i + 1 == count)
            return rb_error_set(error, RB_INVALID, "%s needs a value: %s", option->name,
                                option->value);
        const char *value = equals ? equals + 1 : option->value ? words[++i] : "";
        if (assign(option, value, arguments, error))
            return RB_INVALID;
        if (arguments->given_count == RB_GIVEN_MAX)
            return rb_error_set(error, RB_INVALID, "too many options");
        arguments->given[arguments->given_count].name = option->name;
        arguments->given[arguments->given_count++].value = value;
    }
    if (!arguments->help && arguments->positional_count < command->positional_min)
        return rb_error_set(error, RB_INVALID, "missing argument; usage: raybench %s %s",
                            command->name, command->synopsis);
    return RB_OK;
}

enum rb_status rb_options_assign(const struct rb_command *command, const char *key,
                                 const char *value, struct rb_arguments *arguments,
                                 struct rb_error *error)
{
    char name[64];
    snprintf(name, sizeof name, "--%.60s", key);
    const struct rb_option *option = find(command, name, strlen(name));
    if (!option)
        return rb_error_set(error, RB_INVALID, "unknown key '%.60s'; see raybench %s --help", key,
                            command->name);
    if (option->value)
        return assign(option, value, arguments, error);
    if (strcmp(value, "yes") != 0 && strcmp(value, "no") != 0)
        return rb_error_set(error, RB_INVALID, "%.60s: expected yes or no", key);
    *(bool *)((char *)arguments + option->offset) = strcmp(value, "yes") == 0;
    return RB_OK;
}

static void help_line(const struct rb_option *option)
{
    char left[48];
    snprintf(left, sizeof left, "%s%s%s", option->name, option->value ? " " : "",
             option->value ? option->value : "");
    printf("  %-24s %s\n", left, option->help);
}

void rb_options_help(const struct rb_command *command)
{
    printf("raybench %s - %s\n\nusage: raybench %s %s\n\n%s\n", command->name, command->summary,
           command->name, command->synopsis, command->text);
    printf("\nOptions:\n");
    for (const struct rb_option *const *group = command->groups; *group; group++)
        for (const struct rb_option *option = *group; option->name; option++)
            help_line(option);
    help_line(&help_option);
}
