#include "cli/values.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The first `length` bytes of `text` as a decimal number within [low, high].
static bool number_within(const char *text, size_t length, double low, double high, double *value)
{
    char digits[64], *end;
    if (length == 0 || length >= sizeof digits || strspn(text, "0123456789+-.eE") < length)
        return false;
    memcpy(digits, text, length);
    digits[length] = '\0';
    errno = 0;
    *value = strtod(digits, &end);
    return *end == '\0' && errno == 0 && *value >= low && *value <= high;
}

static bool integer_within(const char *text, size_t length, double low, double high, int *value)
{
    double number;
    if (!number_within(text, length, low, high, &number) || number != floor(number))
        return false;
    *value = (int)number;
    return true;
}

// Is `text` the first or the second word? The answer goes to `second`.
static bool either(const char *text, const char *first_word, const char *second_word, bool *second)
{
    *second = strcmp(text, second_word) == 0;
    return *second || strcmp(text, first_word) == 0;
}

static void *field(const struct rb_option *option, struct rb_arguments *arguments)
{
    return (char *)arguments + option->offset;
}

// A parser writes to the field that the option names; false if the text will not do.
typedef bool parse_fn(const struct rb_option *option, const char *text,
                      struct rb_arguments *arguments);

static bool parse_flag(const struct rb_option *option, const char *text,
                       struct rb_arguments *arguments)
{
    return either(text, "no", "yes", field(option, arguments));
}

static bool parse_text(const struct rb_option *option, const char *text,
                       struct rb_arguments *arguments)
{
    *(const char **)field(option, arguments) = text;
    return true;
}

static bool parse_int(const struct rb_option *option, const char *text,
                      struct rb_arguments *arguments)
{
    return integer_within(text, strlen(text), option->low, option->high, field(option, arguments));
}

static bool parse_number(const struct rb_option *option, const char *text,
                         struct rb_arguments *arguments)
{
    return number_within(text, strlen(text), option->low, option->high, field(option, arguments));
}

static bool parse_time(const struct rb_option *option, const char *text,
                       struct rb_arguments *arguments)
{
    static const struct {
        const char *name;
        double s;
    } units[] = {{"", 1}, {"ms", 1e-3}, {"s", 1}, {"m", 60}, {"h", 3600}};
    double *seconds = field(option, arguments);
    size_t length = strcspn(text, "smh");
    if (!number_within(text, length, 0, HUGE_VAL, seconds))
        return false;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(text + length, units[i].name) == 0) {
            *seconds *= units[i].s;
            return *seconds >= option->low && *seconds <= option->high;
        }
    return false;
}

static bool parse_seed(const struct rb_option *option, const char *text,
                       struct rb_arguments *arguments)
{
    char *end;
    errno = 0;
    *(uint64_t *)field(option, arguments) = strtoull(text, &end, 10);
    return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0;
}

static bool parse_size(const struct rb_option *option, const char *text,
                       struct rb_arguments *arguments)
{
    struct rb_settings *settings = field(option, arguments);
    size_t width = strcspn(text, "x");
    return text[width] == 'x' && integer_within(text, width, 1, RB_SIZE_MAX, &settings->width) &&
           integer_within(text + width + 1, strlen(text) - width - 1, 1, RB_SIZE_MAX,
                          &settings->height);
}

static bool parse_specular(const struct rb_option *option, const char *text,
                           struct rb_arguments *arguments)
{
    return either(text, "blinn", "phong", field(option, arguments));
}

static bool parse_light_scale(const struct rb_option *option, const char *text,
                              struct rb_arguments *arguments)
{
    if (strcmp(text, "auto") != 0)
        return parse_number(option, text, arguments);
    *(double *)field(option, arguments) = 0;
    return true;
}

static bool parse_dialect(const struct rb_option *option, const char *text,
                          struct rb_arguments *arguments)
{
    bool spd;
    bool known = either(text, "p3d", "spd", &spd);
    *(enum rb_dialect *)field(option, arguments) = spd ? RB_DIALECT_SPD : RB_DIALECT_P3D;
    return known;
}

static bool parse_count(const struct rb_option *option, const char *text,
                        struct rb_arguments *arguments)
{
    arguments->size_given = true;
    return integer_within(text, strlen(text), 0, INT_MAX, field(option, arguments));
}

static const struct {
    parse_fn *parse;
    const char *wanted; // the range of the option is appended if it has one
} kinds[] = {
    [RB_OPTION_FLAG] = {parse_flag, "yes or no"},
    [RB_OPTION_TEXT] = {parse_text, "a text"},
    [RB_OPTION_INT] = {parse_int, "a whole number"},
    [RB_OPTION_NUMBER] = {parse_number, "a number"},
    [RB_OPTION_TIME] = {parse_time, "a time in seconds (or such as 500ms, 90s, 1.5m, 2h)"},
    [RB_OPTION_SEED] = {parse_seed, "a whole number below 2^64"},
    [RB_OPTION_SIZE] = {parse_size, "WIDTHxHEIGHT in pixels, such as 512x512"},
    [RB_OPTION_SPECULAR] = {parse_specular, "blinn or phong"},
    [RB_OPTION_LIGHT_SCALE] = {parse_light_scale, "auto or a number"},
    [RB_OPTION_DIALECT] = {parse_dialect, "p3d or spd"},
    [RB_OPTION_COUNT] = {parse_count, "a whole number"},
};

enum rb_status rb_value_assign(const struct rb_option *option, const char *name, const char *text,
                               struct rb_arguments *arguments, struct rb_error *error)
{
    char range[64] = "";
    if (kinds[option->kind].parse(option, text, arguments))
        return RB_OK;
    if (option->low < option->high)
        snprintf(range, sizeof range, " from %.10g to %.10g", option->low, option->high);
    return rb_error_set(error, RB_INVALID, "%s %.200s: expected %s%s", name, text,
                        kinds[option->kind].wanted, range);
}
