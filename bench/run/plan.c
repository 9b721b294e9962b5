#define _GNU_SOURCE
#include "bench/run/plan.h"

#include "base/memory.h"
#include "cli/commands.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char defaults[] = "# what is measured when nothing is said\n"
                               "scenes = *\n"
                               "variants = naive,bvh,bvh+omp,packet,packet+omp,fastest\n";

enum { PATH_MAX_LENGTH = 1024, LIST_MAX = 64, ITEM_MAX = 256 };

// Finds plan NAME: a path that ends in .plan, or one of those that come with the program, in the
// checkout we stand in, the one the program was built in, or where it was installed.
static bool find_plan(const char *name, char path[PATH_MAX_LENGTH])
{
    static const char *const folders[] = {"bench/plans", "%s/../../bench/plans",
                                          "%s/../share/raybench/plans"};
    size_t length = strlen(name);
    char program[PATH_MAX_LENGTH / 2] = "";
    if (length > 5 && strcmp(name + length - 5, ".plan") == 0) {
        snprintf(path, PATH_MAX_LENGTH, "%s", name);
        return true;
    }
    if (readlink("/proc/self/exe", program, sizeof program - 1) > 0 && strrchr(program, '/'))
        *strrchr(program, '/') = '\0';
    for (size_t i = 0; i < sizeof folders / sizeof *folders && !strchr(name, '/'); i++) {
        char folder[PATH_MAX_LENGTH - 256];
        snprintf(folder, sizeof folder, i ? folders[i] : "%.0sbench/plans", program);
        snprintf(path, PATH_MAX_LENGTH, "%s/%.200s.plan", folder, name);
        if (access(path, R_OK) == 0)
            return true;
    }
    return false;
}

static enum rb_status copy_file(const char *path, FILE *text, struct rb_error *error)
{
    FILE *file = fopen(path, "r");
    snprintf(error->file, sizeof error->file, "%.255s", path);
    if (!file)
        return rb_error_set(error, RB_INVALID, "cannot read the plan");
    for (int c = getc(file); c != EOF; c = getc(file))
        fputc(c, text);
    bool failed = ferror(file);
    fclose(file);
    if (failed)
        return rb_error_set(error, RB_FAILED, "cannot read the plan");
    error->file[0] = '\0';
    return RB_OK;
}

// What concerns this call of the program and not what is measured.
static bool is_private(const char *key)
{
    static const char *const keys[] = {"--out", "--resume", "--dry-run", "--quiet", "--help"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (strcmp(key, keys[i]) == 0)
            return true;
    return false;
}

static enum rb_status put_lines(const struct rb_arguments *given, bool plan_named, FILE *text,
                                struct rb_error *error)
{
    for (int i = 0; i < given->positional_count && !plan_named; i++)
        fprintf(text, "%s%s", i ? "," : "scenes = ", given->positional[i]);
    fputs("\n", text);
    for (int i = 0; i < given->given_count; i++) {
        const char *key = given->given[i].name, *value = given->given[i].value;
        if (strchr(value, '\n'))
            return rb_error_set(error, RB_INVALID, "%s: a line feed in the value", key);
        if (!is_private(key))
            fprintf(text, "%s = %s\n", key + 2, *value ? value : "yes");
    }
    return RB_OK;
}

enum rb_status rb_plan_compose(const struct rb_arguments *given, struct rb_plan *plan,
                               struct rb_error *error)
{
    char path[PATH_MAX_LENGTH] = "";
    size_t length;
    bool plan_named = given->positional_count == 1 && find_plan(given->positional[0], path);
    FILE *text = open_memstream(&plan->text, &length);
    if (!text)
        return rb_error_memory(error, "the plan");
    enum rb_status status = RB_OK;
    if (plan_named)
        status = copy_file(path, text, error);
    else
        fputs(defaults, text);
    snprintf(plan->file, sizeof plan->file, "%.255s", plan_named ? path : "");
    if (status == RB_OK)
        status = put_lines(given, plan_named, text, error);
    if (fclose(text) != 0 && status == RB_OK)
        status = rb_error_memory(error, "the plan");
    return status;
}

// The text without the blanks around it, cut out of its line.
static char *trim(char *from, char *end)
{
    while (end > from && strchr(" \t\r", end[-1]))
        end--;
    *end = '\0';
    return from + strspn(from, " \t");
}

static enum rb_status parse_line(const struct rb_command *command, char *line,
                                 struct rb_arguments *arguments, struct rb_error *error)
{
    line[strcspn(line, "#")] = '\0';
    char *equals = strchr(line, '='), *key = line + strspn(line, " \t\r");
    if (!*key)
        return RB_OK;
    error->column = (unsigned long)(key - line) + 1;
    if (!equals)
        return rb_error_set(error, RB_INVALID,
                            "expected `key = value`, such as scenes = balls_low");
    key = trim(key, equals);
    char *value = trim(equals + 1, equals + 1 + strlen(equals + 1));
    return rb_options_assign(command, key, value, arguments, error);
}

enum rb_status rb_plan_parse(const struct rb_command *command, struct rb_plan *plan,
                             struct rb_error *error)
{
    plan->words = strdup(plan->text);
    if (!plan->words)
        return rb_error_memory(error, "the plan");
    snprintf(error->file, sizeof error->file, "%.255s", plan->file);
    for (char *line = plan->words, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        error->line++;
        enum rb_status status = parse_line(command, line, &plan->arguments, error);
        if (status)
            return status;
    }
    *error = (struct rb_error){0};
    return RB_OK;
}

// Comma-separated items, blanks around them dropped.
struct list {
    char items[LIST_MAX][ITEM_MAX];
    int count;
};

static enum rb_status add_item(struct list *list, const char *item, size_t length,
                               struct rb_error *error)
{
    if (list->count == LIST_MAX || length >= ITEM_MAX)
        return rb_error_set(error, RB_INVALID, "the list is too long at '%.*s'",
                            (int)(length < 64 ? length : 64), item);
    snprintf(list->items[list->count], ITEM_MAX, "%.*s", (int)length, item);
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->items[i], list->items[list->count]) == 0)
            return RB_OK;
    list->count++;
    return RB_OK;
}

// Calls `add` for each item; an empty text has the one item `fallback`.
static enum rb_status parse_list(const char *text, const char *fallback, struct list *list,
                                 enum rb_status add(struct list *, const char *, size_t,
                                                    struct rb_error *),
                                 struct rb_error *error)
{
    list->count = 0;
    enum rb_status status = RB_OK;
    for (text = text && *text ? text : fallback; *text && status == RB_OK;) {
        text += strspn(text, " \t,");
        size_t length = strcspn(text, ","), end = length;
        while (end > 0 && strchr(" \t", text[end - 1]))
            end--;
        if (end)
            status = add(list, text, end, error);
        text += length;
    }
    return status;
}

static enum rb_status add_scene(struct list *list, const char *item, size_t length,
                                struct rb_error *error)
{
    char pattern[ITEM_MAX];
    int count = list->count;
    snprintf(pattern, sizeof pattern, "%.*s", (int)length, item);
    if (strcmp(pattern, "-") == 0)
        return rb_error_set(error, RB_INVALID,
                            "several processes read the scene: give a file, not standard input");
    if (!strpbrk(pattern, "*?["))
        return add_item(list, item, length, error);
    enum rb_status status = RB_OK;
    for (const struct rb_preset *p = rb_presets; p->name && status == RB_OK; p++)
        if (fnmatch(pattern, p->name, 0) == 0)
            status = add_item(list, p->name, strlen(p->name), error);
    if (status == RB_OK && list->count == count)
        return rb_error_set(error, RB_INVALID, "no scene matches '%s'; see raybench list scenes",
                            pattern);
    return status;
}

// Adds a row; rows that stand for others are measured under the name of what they stand for.
static enum rb_status add_row(struct list *list, const struct rb_variant *variant,
                              struct rb_error *error)
{
    const struct rb_variant *row = rb_variant_resolve(variant);
    const char *name = row ? row->name : variant->name;
    return add_item(list, name, strlen(name), error);
}

static enum rb_status add_variant(struct list *list, const char *item, size_t length,
                                  struct rb_error *error)
{
    char pattern[ITEM_MAX];
    snprintf(pattern, sizeof pattern, "%.*s", (int)length, item);
    if (strcmp(pattern, "fastest") == 0)
        return add_row(list, rb_variant_fastest(), error);
    if (rb_variant_find(pattern))
        return add_row(list, rb_variant_find(pattern), error);
    enum rb_status status = RB_OK;
    bool found = false;
    for (const struct rb_variant *v = rb_variants; v->name && status == RB_OK; v++)
        if (!v->best_of && fnmatch(pattern, v->name, 0) == 0) {
            found = true;
            status = add_row(list, v, error);
        }
    if (status == RB_OK && !found)
        return rb_error_set(error, RB_INVALID,
                            "no variant matches '%s'; see raybench list variants", pattern);
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
static enum rb_status add_threads(struct list *list, const char *item, size_t length,
                                  struct rb_error *error)
{
    char number[16];
    if (length != 6 || memcmp(item, "powers", 6) != 0)
        return add_item(list, item, length, error);
    enum rb_status status = RB_OK;
    for (int threads = 1; threads < rb_threads_default() && status == RB_OK; threads *= 2) {
        snprintf(number, sizeof number, "%d", threads);
        status = add_item(list, number, strlen(number), error);
    }
    return status == RB_OK ? add_item(list, "max", 3, error) : status;
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

void rb_plan_free(struct rb_plan *plan)
{
    for (int i = 0; i < plan->cell_count; i++)
        rb_free(plan->cells[i].samples);
    rb_free(plan->cells);
    rb_free(plan->references);
    free(plan->text);
    free(plan->words);
}
