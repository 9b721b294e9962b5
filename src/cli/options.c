#include "cli/options.h"

#include "cli/suggest.h"
#include "cli/values.h"

#include <stdio.h>
#include <string.h>

#define SETTING(field) offsetof(struct rb_arguments, settings.field)

const struct rb_option rb_options_settings[] = {
    {"--size", "WxH", RB_OPTION_SIZE, offsetof(struct rb_arguments, settings), 0, 0,
     "image size; default: the scene's resolution"},
    {"--aa", "N", RB_OPTION_INT, SETTING(aa), 1, RB_AA_MAX,
     "anti-aliasing: N x N stratified rays per pixel; default 1"},
    {"--light-size", "S", RB_OPTION_NUMBER, SETTING(light_size), 0, 1e6,
     "edge of the square lights in world units, for soft shadows; default 0"},
    {"--light-scale", "auto|X", RB_OPTION_LIGHT_SCALE, SETTING(light_scale), 1e-6, 1e6,
     "multiplies every light; auto = 1/sqrt(number of lights)"},
    {"--ambient", "A", RB_OPTION_NUMBER, SETTING(ambient), 0, 1e6,
     "adds A x Kd x colour to every hit; default 0"},
    {"--specular", "blinn|phong", RB_OPTION_SPECULAR, SETTING(phong), 0, 0,
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
    {"--variant", "VARIANT", RB_OPTION_TEXT, offsetof(struct rb_arguments, variant), 0, 0,
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

const struct rb_option *rb_options_at(const struct rb_command *command, int index)
{
    for (const struct rb_option *const *group = command->groups; *group; group++)
        for (const struct rb_option *option = *group; option->name; option++)
            if (index-- == 0)
                return option;
    return index == 0 ? &help_option : NULL;
}

// The option called by the `length` bytes of `name`, or NULL; then `suggestion` may have one that
// is called nearly so. Keys of files are names without their two dashes; --help is none.
static const struct rb_option *find(const struct rb_command *command, bool key, const char *name,
                                    size_t length, struct rb_suggestion *suggestion)
{
    const struct rb_option *option;
    *suggestion = (struct rb_suggestion){.typed = name, .length = length};
    for (int i = 0; (option = rb_options_at(command, i)); i++) {
        if (key && (strncmp(option->name, "--", 2) != 0 || option == &help_option))
            continue;
        const char *candidate = option->name + (key ? 2 : 0);
        if (strlen(candidate) == length && memcmp(candidate, name, length) == 0)
            return option;
        rb_suggestion_offer(suggestion, candidate);
    }
    return NULL;
}

// Takes the option at words[0], and its value if that is a word of its own: *used words of `count`.
static enum rb_status parse_option(const struct rb_command *command, int count, char **words,
                                   int *used, struct rb_arguments *arguments,
                                   struct rb_error *error)
{
    const char *word = strcmp(words[0], "-h") == 0 ? help_option.name : words[0];
    const char *equals = strncmp(word, "--", 2) == 0 ? strchr(word, '=') : NULL;
    size_t length = equals ? (size_t)(equals - word) : strlen(word);
    struct rb_suggestion suggestion;
    char hint[RB_SUGGESTION_TEXT];
    const struct rb_option *option = find(command, false, word, length, &suggestion);
    if (!option)
        return rb_error_set(error, RB_INVALID, "unknown option %.200s%s", word,
                            rb_suggestion_text(&suggestion, hint));
    if (!option->value && equals)
        return rb_error_set(error, RB_INVALID, "%s takes no value", option->name);
    if (option->value && !equals && count == 1)
        return rb_error_set(error, RB_INVALID, "%s needs a value: %s", option->name, option->value);
    *used = option->value && !equals ? 2 : 1;
    const char *value = equals ? equals + 1 : option->value ? words[1] : "yes";
    if (arguments->given_count == RB_GIVEN_MAX)
        return rb_error_set(error, RB_INVALID, "more than %d options", RB_GIVEN_MAX);
    arguments->given[arguments->given_count].name = option->name;
    arguments->given[arguments->given_count++].value = value;
    return rb_value_assign(option, option->name, value, arguments, error);
}

enum rb_status rb_options_parse(const struct rb_command *command, int count, char **words,
                                struct rb_arguments *arguments, struct rb_error *error)
{
    bool options_end = false;
    for (int i = 0, used; i < count; i += used) {
        const char *word = words[i];
        used = 1;
        if (options_end || word[0] != '-' || strcmp(word, "-") == 0) {
            if (arguments->positional_count == command->positional_max)
                return rb_error_set(error, RB_INVALID, "unexpected argument '%s'", word);
            arguments->positional[arguments->positional_count++] = word;
        } else if (strcmp(word, "--") == 0) {
            options_end = true;
        } else if (parse_option(command, count - i, words + i, &used, arguments, error)) {
            return RB_INVALID;
        }
    }
    if (!arguments->help && arguments->positional_count < command->positional_min)
        return rb_error_set(error, RB_INVALID, "missing argument; usage: raybench %s %s",
                            command->name, command->synopsis);
    return RB_OK;
}

enum rb_status rb_options_assign(const struct rb_command *command, const char *name,
                                 const char *value, struct rb_arguments *arguments,
                                 struct rb_error *error)
{
    struct rb_suggestion suggestion;
    char hint[RB_SUGGESTION_TEXT];
    const struct rb_option *option = find(command, true, name, strlen(name), &suggestion);
    if (!option)
        return rb_error_set(error, RB_INVALID, "unknown key '%.200s'%s", name,
                            rb_suggestion_text(&suggestion, hint));
    return rb_value_assign(option, name, value, arguments, error);
}

enum { HELP_COLUMN = 26 };

static void help_line(const struct rb_option *option)
{
    int width = printf("  %s %s", option->name, option->value ? option->value : "");
    if (width > HELP_COLUMN) {
        printf("\n");
        width = 0;
    }
    printf("%*s %s\n", HELP_COLUMN - width, "", option->help);
}

void rb_options_help(const struct rb_command *command)
{
    const struct rb_option *option;
    printf("raybench %s - %s\n\nusage: raybench %s %s\n\n%s\n", command->name, command->summary,
           command->name, command->synopsis, command->text);
    printf("\nOptions:\n");
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        help_line(option);
}
