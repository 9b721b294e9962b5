#define _GNU_SOURCE
#include "bench/run/plan.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool rb_plan_find(const char *name, char path[RB_PLAN_PATH_MAX])
{
    static const char *const folders[] = {"bench/plans", "%s/../../bench/plans",
                                          "%s/../share/raybench/plans"};
    size_t length = strlen(name);
    char program[RB_PLAN_PATH_MAX / 2] = "";
    if (length > 5 && strcmp(name + length - 5, ".plan") == 0) {
        snprintf(path, RB_PLAN_PATH_MAX, "%s", name);
        return true;
    }
    if (readlink("/proc/self/exe", program, sizeof program - 1) > 0 && strrchr(program, '/'))
        *strrchr(program, '/') = '\0';
    for (size_t i = 0; i < sizeof folders / sizeof *folders && !strchr(name, '/'); i++) {
        char folder[RB_PLAN_PATH_MAX - 256];
        snprintf(folder, sizeof folder, i ? folders[i] : "%.0sbench/plans", program);
        snprintf(path, RB_PLAN_PATH_MAX, "%s/%.200s.plan", folder, name);
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
    static const char *const keys[] = {"--out",   "--resume",  "--dry-run",
                                       "--quiet", "--heatmap", "-o"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (strcmp(key, keys[i]) == 0)
            return true;
    return false;
}

static enum rb_status put_lines(const struct rb_arguments *given, bool plan_named, FILE *text,
                                struct rb_error *error)
{
    for (int i = 0; i < given->positional_count && !plan_named; i++) {
        if (strpbrk(given->positional[i], ",#\n"))
            return rb_error_set(error, RB_INVALID, "%.200s: a comma or # in the name of a scene",
                                given->positional[i]);
        fprintf(text, "%s%s", i ? "," : "scenes = ", given->positional[i]);
    }
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

enum rb_status rb_plan_compose(const struct rb_arguments *given, const char *defaults,
                               struct rb_plan *plan, struct rb_error *error)
{
    char path[RB_PLAN_PATH_MAX] = "";
    size_t length;
    bool plan_named = given->positional_count == 1 && rb_plan_find(given->positional[0], path);
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

void rb_plan_free(struct rb_plan *plan)
{
    for (int i = 0; i < plan->cell_count; i++)
        rb_cell_release(&plan->cells[i]);
    rb_free(plan->cells);
    rb_free(plan->references);
    free(plan->text);
    free(plan->words);
    *plan = (struct rb_plan){0};
}
