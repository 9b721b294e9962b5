#include "bench/shell/complete.h"

#include "kernels/count.h"

#include <string.h>

// Words go out with blanks between.
struct words {
    FILE *out;
    bool begun;
};

static void put_word(struct words *words, const char *word, size_t length)
{
    fprintf(words->out, "%s%.*s", words->begun ? " " : "", (int)length, word);
    words->begun = true;
}

static void put_presets(struct words *words)
{
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++)
        put_word(words, preset->name, strlen(preset->name));
}

static void put_generators(struct words *words)
{
    for (const struct rb_generator *generator = rb_generators; generator->name; generator++)
        put_word(words, generator->name, strlen(generator->name));
    put_presets(words);
}

static void put_scenes(struct words *words)
{
    put_presets(words);
    for (const struct rb_generator *generator = rb_generators; generator->name; generator++)
        for (int size = generator->size_min; size <= generator->size_max; size++) {
            put_word(words, generator->name, strlen(generator->name));
            fprintf(words->out, "%d", size);
        }
}

static void put_variants(struct words *words)
{
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++)
        put_word(words, variant->name, strlen(variant->name));
}

// Those of `raybench count --heatmap`.
static void put_counters(struct words *words)
{
    for (enum rb_counter c = 0; c < RB_COUNTER_COUNT; c++)
        if (rb_counter_is_of_rays(c))
            put_word(words, rb_counter_names[c], strlen(rb_counter_names[c]));
}

// What values are called whose nature is known.
static const struct class
{
    const char *name;
    unsigned takes;
    void (*put)(struct words *words);
} classes[] = {
    {"FILE", RB_TAKES_FILES, NULL},
    {"PLAN", RB_TAKES_FILES, NULL},
    {"PROGRAM", RB_TAKES_FILES, NULL},
    {"DIR", RB_TAKES_FOLDERS, NULL},
    {"RESULT", RB_TAKES_FOLDERS, NULL},
    {"SCENE", RB_TAKES_FILES | RB_TAKES_WORDS, put_scenes},
    {"GENERATOR", RB_TAKES_WORDS, put_generators},
    {"VARIANT", RB_TAKES_WORDS, put_variants},
    {"COUNTER", RB_TAKES_WORDS, put_counters},
};

static const struct class *find_class(const char *name, size_t length)
{
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++)
        if (strlen(classes[i].name) == length && memcmp(classes[i].name, name, length) == 0)
            return &classes[i];
    return NULL;
}

static bool is_word(const char *text, size_t length)
{
    return length && text[0] >= 'a' && text[0] <= 'z' &&
           strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789-_+.") >= length;
}

// Walks over the alternatives of a value; writes their words unless `words` is NULL.
static unsigned walk(const char *value, struct words *words)
{
    unsigned takes = strchr(value, ',') ? RB_TAKES_LIST : 0;
    for (const char *end; *value; value = *end == '|' ? end + 1 : end + strlen(end)) {
        size_t length = strcspn(value, "|,");
        const struct class *class = find_class(value, length);
        end = value + length;
        if (class)
            takes |= class->takes;
        if (class && class->put && words)
            class->put(words);
        if (!is_word(value, length))
            continue;
        takes |= RB_TAKES_WORDS;
        if (words)
            put_word(words, value, length);
    }
    return takes;
}

unsigned rb_complete_takes(const char *value)
{
    return walk(value, NULL);
}

void rb_complete_words(FILE *out, const char *value)
{
    walk(value, &(struct words){.out = out});
}

// Does the option called by the `length` bytes of `name` have its value in a word of its own?
static bool takes_word(const struct rb_command *command, const char *name, size_t length)
{
    const struct rb_option *option;
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        if (strlen(option->name) == length && memcmp(option->name, name, length) == 0)
            return option->value != NULL;
    return false;
}

// Reads "[SCENE...|PLAN]" without its brackets and dots.
static struct rb_position read_position(const char *word, size_t length)
{
    struct rb_position position = {.optional = word[0] == '['};
    size_t used = 0;
    for (size_t i = 0; i < length && used < sizeof position.value - 1; i++) {
        position.repeated |= word[i] == '.';
        if (!strchr("[].", word[i]))
            position.value[used++] = word[i];
    }
    return position;
}

int rb_complete_positions(const struct rb_command *command,
                          struct rb_position positions[RB_POSITIONS_MAX])
{
    int count = 0;
    const char *word = command->synopsis;
    for (size_t length; *word && count < RB_POSITIONS_MAX; word += length) {
        word += strspn(word, " ");
        length = strcspn(word, " ");
        size_t brackets = strspn(word, "[");
        size_t name_length = strcspn(word + brackets, " ]");
        if (word[brackets] != '-') {
            if (length && strncmp(word, "[options]", length) != 0)
                positions[count++] = read_position(word, length);
        } else if (takes_word(command, word + brackets, name_length)) {
            length += strspn(word + length, " ");
            length += strcspn(word + length, " ");
        }
    }
    return count;
}

const struct rb_command *const *rb_complete_shown(const struct rb_command *const *commands)
{
    while (*commands && (*commands)->hidden)
        commands++;
    return commands;
}

void rb_put_escaped_part(FILE *out, const char *text, size_t length,
                         const struct rb_escape *escapes)
{
    for (const char *end = text + length; text < end; text++) {
        const struct rb_escape *escape = escapes;
        while (escape->character && escape->character != *text)
            escape++;
        if (escape->character)
            fputs(escape->text, out);
        else
            fputc(*text, out);
    }
}

void rb_put_escaped(FILE *out, const char *text, const struct rb_escape *escapes)
{
    rb_put_escaped_part(out, text, strlen(text), escapes);
}
