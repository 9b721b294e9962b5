// From the lists of a plan to its references and cells.
#include "base/memory.h"
#include "bench/data/names.h"
#include "bench/run/plan.h"
#include "cli/commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIST_MAX = 64 };

// The items of a list that are different from each other.
struct list {
    char items[LIST_MAX][RB_NAME_MAX];
    int count;
};

static enum rb_status add_item(struct list *list, const char *item, struct rb_error *error)
{
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->items[i], item) == 0)
            return RB_OK;
    if (list->count == LIST_MAX)
        return rb_error_set(error, RB_INVALID, "the list is too long at '%.64s'", item);
    snprintf(list->items[list->count++], RB_NAME_MAX, "%s", item);
    return RB_OK;
}

typedef enum rb_status add_fn(struct list *list, const char *item, struct rb_error *error);

// Calls `add` for each item; an empty text has the items of `fallback`.
static enum rb_status parse_list(const char *text, const char *fallback, struct list *list,
                                 add_fn *add, struct rb_error *error)
{
    char item[RB_NAME_MAX];
    enum rb_status status = RB_OK;
    list->count = 0;
    text = text && *text ? text : fallback;
    while (status == RB_OK && rb_names_next(&text, item))
        status = add(list, item, error);
    return status;
}

static enum rb_status add_scene(struct list *list, const char *item, struct rb_error *error)
{
    int count = list->count;
    if (strcmp(item, "-") == 0)
        return rb_error_set(error, RB_INVALID,
                            "several processes read the scene: give a file, not standard input");
    if (!strpbrk(item, "*?["))
        return add_item(list, item, error);
    enum rb_status status = RB_OK;
    for (const struct rb_preset *p = rb_presets; p->name && status == RB_OK; p++)
        if (rb_name_matches(item, p->name))
            status = add_item(list, p->name, error);
    if (status == RB_OK && list->count == count)
        return rb_error_set(error, RB_INVALID, "no scene matches '%s'; see raybench list scenes",
                            item);
    return status;
}

// Adds a row; rows that stand for others are measured under the name of what they stand for.
static enum rb_status add_row(struct list *list, const struct rb_variant *variant,
                              struct rb_error *error)
{
    const struct rb_variant *row = rb_variant_resolve(variant);
    return add_item(list, row ? row->name : variant->name, error);
}

static enum rb_status add_variant(struct list *list, const char *item, struct rb_error *error)
{
    if (strcmp(item, "fastest") == 0)
        return add_row(list, rb_variant_fastest(), error);
    if (rb_variant_find(item))
        return add_row(list, rb_variant_find(item), error);
    enum rb_status status = RB_OK;
    bool found = false;
    for (const struct rb_variant *v = rb_variants; v->name && status == RB_OK; v++)
        if (!v->best_of && rb_name_matches(item, v->name)) {
            found = true;
            status = add_row(list, v, error);
        }
    if (status == RB_OK && !found)
        return rb_error_set(error, RB_INVALID,
                            "no variant matches '%s'; see raybench list variants", item);
    return status;
}

// A whole number, or `max` where there is one.
static enum rb_status parse_count(const char *what, const char *text, int max, int *value,
                                  struct rb_error *error)
{
    char *end;
    long number = strtol(text, &end, 10);
    if (max && strcmp(text, "max") == 0)
        number = max;
    else if (end == text || *end || number < 1 || number > 65536)
        return rb_error_set(error, RB_INVALID, "%s '%s': expected whole numbers%s", what, text,
                            max ? " or max" : "");
    *value = (int)number;
    return RB_OK;
}

// Thread counts; `powers` are 1, 2, 4 and so on, and all.
static enum rb_status add_threads(struct list *list, const char *item, struct rb_error *error)
{
    char number[16];
    if (strcmp(item, "powers") != 0)
        return add_item(list, item, error);
    enum rb_status status = RB_OK;
    for (int threads = 1; threads < rb_threads_default() && status == RB_OK; threads *= 2) {
        snprintf(number, sizeof number, "%d", threads);
        status = add_item(list, number, error);
    }
    return status == RB_OK ? add_item(list, "max", error) : status;
}

struct lists {
    struct list scenes, variants, threads, tiles, depths, light_samples;
};

static enum rb_status parse_lists(const struct rb_bench_arguments *bench, struct lists *lists,
                                  struct rb_error *error)
{
    enum rb_status status = parse_list(bench->scenes, "*", &lists->scenes, add_scene, error);
    if (status == RB_OK)
        status = parse_list(bench->variants, "*", &lists->variants, add_variant, error);
    if (status == RB_OK)
        status = parse_list(bench->threads, "max", &lists->threads, add_threads, error);
    if (status == RB_OK)
        status = parse_list(bench->tiles, "64", &lists->tiles, add_item, error);
    if (status == RB_OK)
        status = parse_list(bench->depths, "5", &lists->depths, add_item, error);
    if (status == RB_OK)
        status = parse_list(bench->light_samples, "1", &lists->light_samples, add_item, error);
    return status;
}

// A cell for each tile and thread count of a row; serial rows have one thread.
static enum rb_status add_cells(struct rb_plan *plan, const struct lists *lists,
                                struct rb_reference *reference, const struct rb_scene *scene,
                                const char *row, struct rb_error *error)
{
    const struct rb_variant *variant = rb_variant_find(row);
    int thread_counts = rb_variant_parallel(variant) ? lists->threads.count : 1;
    for (int t = 0; t < thread_counts; t++) {
        for (int i = 0; i < lists->tiles.count; i++) {
            struct rb_cell *cell = &plan->cells[plan->cell_count];
            *cell = (struct rb_cell){.variant = variant, .reference = reference};
            cell->settings = reference->settings;
            enum rb_status status =
                parse_count("tile", lists->tiles.items[i], 0, &cell->settings.tile, error);
            if (status == RB_OK)
                status = parse_count("threads", lists->threads.items[t], rb_threads_default(),
                                     &cell->settings.threads, error);
            if (!rb_variant_parallel(variant))
                cell->settings.threads = 1;
            if (status == RB_OK)
                status = rb_settings_complete(&cell->settings, scene, error);
            if (status)
                return status;
            cell->state = rb_variant_available(variant) ? RB_CELL_OPEN : RB_CELL_UNAVAILABLE;
            plan->cell_count++;
        }
    }
    return RB_OK;
}

static enum rb_status expand_scene(struct rb_plan *plan, const struct lists *lists,
                                   const char *name, const struct rb_scene *scene,
                                   struct rb_error *error)
{
    for (int d = 0; d < lists->depths.count; d++) {
        for (int l = 0; l < lists->light_samples.count; l++) {
            struct rb_reference *reference = &plan->references[plan->reference_count++];
            reference->scene_name = name;
            reference->scene_hash = scene->hash;
            reference->primitive_count = scene->primitive_count;
            reference->settings = plan->arguments.settings;
            enum rb_status status =
                parse_count("depth", lists->depths.items[d], 0, &reference->settings.depth, error);
            if (status == RB_OK)
                status = parse_count("light-samples", lists->light_samples.items[l], 0,
                                     &reference->settings.light_samples, error);
            if (status == RB_OK)
                status = rb_settings_complete(&reference->settings, scene, error);
            for (int v = 0; v < lists->variants.count && status == RB_OK; v++)
                status = add_cells(plan, lists, reference, scene, lists->variants.items[v], error);
            if (status)
                return status;
        }
    }
    return RB_OK;
}

static enum rb_status make_room(struct rb_plan *plan, const struct lists *lists,
                                struct rb_error *error)
{
    size_t references =
        (size_t)(lists->scenes.count * lists->depths.count) * (size_t)lists->light_samples.count;
    size_t rows = (size_t)(lists->variants.count * lists->threads.count * lists->tiles.count);
    plan->references = rb_alloc(references, sizeof *plan->references);
    plan->cells = rb_alloc(2 * references * rows, sizeof *plan->cells); // of two programs
    return plan->references && plan->cells ? RB_OK : rb_error_memory(error, "the plan");
}

// The same cells again, for the second program.
static void double_cells(struct rb_plan *plan)
{
    memcpy(plan->cells + plan->cell_count, plan->cells,
           (size_t)plan->cell_count * sizeof *plan->cells);
    for (int i = 0; i < plan->cell_count; i++)
        plan->cells[plan->cell_count + i].side = 1;
    plan->cell_count *= 2;
}

int rb_plan_expand(struct rb_plan *plan)
{
    static struct lists lists; // kept: cells refer to the names of scenes
    struct rb_error error = {0};
    enum rb_status status = parse_lists(&plan->arguments.bench, &lists, &error);
    if (status == RB_OK)
        status = make_room(plan, &lists, &error);
    for (int s = 0; s < lists.scenes.count && status == RB_OK; s++) {
        struct rb_scene scene;
        int code = rb_open_scene(lists.scenes.items[s], &plan->arguments, &scene);
        if (code)
            return code;
        status = expand_scene(plan, &lists, lists.scenes.items[s], &scene, &error);
        rb_scene_free(&scene);
    }
    if (status == RB_OK && plan->arguments.bench.against)
        double_cells(plan);
    return status ? rb_report(status, &error) : 0;
}
