#include "bench/times/render_select.h"

#include "base/memory.h"
#include "bench/data/names.h"

#include <math.h>
#include <string.h>

static bool usable(const struct rb_variant *variant)
{
    return variant->exact && !variant->best_of && rb_variant_available(variant);
}

void rb_render_available(char names[RB_AVAILABLE_ROOM])
{
    size_t length = 0;
    names[0] = '\0';
    for (const struct rb_variant *v = rb_variants; v->name && length < RB_AVAILABLE_ROOM; v++)
        if (usable(v))
            length += (size_t)snprintf(names + length, RB_AVAILABLE_ROOM - length, "%s%s",
                                       length ? " " : "", v->name);
}

static bool matches_scene(const char *item)
{
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++)
        if (rb_name_matches(item, preset->name))
            return true;
    return false;
}

static bool matches_variant(const char *item)
{
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++)
        if (usable(variant) && rb_name_matches(item, variant->name))
            return true;
    return false;
}

// Every item of the list must match something.
static enum rb_status check_list(const char *list, bool matches(const char *item), const char *what,
                                 struct rb_error *error)
{
    char item[RB_NAME_MAX];
    while (list && rb_names_next(&list, item)) {
        if (!matches(item))
            return rb_error_set(error, RB_INVALID, "'%s' matches no %s; see raybench list", item,
                                what);
    }
    return RB_OK;
}

enum rb_status rb_render_select(const struct rb_render_selection *selection,
                                struct rb_render_cell **cells, size_t *count,
                                struct rb_error *error)
{
    struct rb_array array = {0};
    if (check_list(selection->scenes, matches_scene, "scene of the 2019 report", error) ||
        check_list(selection->variants, matches_variant, "variant of this machine", error))
        return RB_INVALID;
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++) {
        if (!rb_names_match(selection->scenes, preset->name))
            continue;
        for (const struct rb_variant *variant = rb_variants; variant->name; variant++) {
            const struct rb_render_cell cell = {.scene = preset, .variant = variant};
            if (!usable(variant) || !rb_names_match(selection->variants, variant->name))
                continue;
            if (!rb_array_push(&array, &cell, sizeof cell)) {
                rb_array_release(&array);
                return rb_error_memory(error, "the rows of the table");
            }
        }
    }
    *cells = array.data;
    *count = array.count;
    return RB_OK;
}

static bool same_run(const struct rb_render_row *a, const struct rb_render_row *b)
{
    return strcmp(a->cpu_model, b->cpu_model) == 0 && strcmp(a->git_commit, b->git_commit) == 0 &&
           strcmp(a->utc, b->utc) == 0 && strcmp(a->available, b->available) == 0;
}

static enum rb_status check_cell(const struct rb_render_table *table, const char *scene,
                                 const char *variant, struct rb_error *error)
{
    const struct rb_render_row *row = rb_render_table_find(table, scene, variant);
    if (row && isfinite(row->median_s))
        return RB_OK;
    return rb_error_set(error, RB_INVALID, "%s %s on %s; run make table",
                        row ? "there is no time of" : "there is no row of", variant, scene);
}

// Takes the next of the words that rb_render_available has put together.
static bool next_word(const char **words, char word[RB_NAME_MAX])
{
    *words += strspn(*words, " ");
    size_t length = strcspn(*words, " ");
    snprintf(word, RB_NAME_MAX, "%.*s", length < RB_NAME_MAX ? (int)length : RB_NAME_MAX, *words);
    *words += length;
    return length > 0;
}

enum rb_status rb_render_complete(const struct rb_render_selection *selection,
                                  const struct rb_render_table *table, struct rb_error *error)
{
    for (size_t i = 1; i < table->count; i++)
        if (!same_run(&table->rows[i], &table->rows[0])) {
            error->line = rb_csv_line(&table->csv, i);
            error->column = 1;
            return rb_error_set(error, RB_INVALID, "this row is of another run than the first");
        }
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++) {
        char variant[RB_NAME_MAX];
        const char *rest = table->count ? table->rows[0].available : "naive";
        if (!rb_names_match(selection->scenes, preset->name))
            continue;
        while (next_word(&rest, variant)) {
            if (rb_names_match(selection->variants, variant) &&
                check_cell(table, preset->name, variant, error))
                return RB_INVALID;
        }
    }
    return RB_OK;
}
