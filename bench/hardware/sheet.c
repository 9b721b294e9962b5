#define _POSIX_C_SOURCE 200809L
#include "bench/hardware/sheet.h"

#include "base/file.h"
#include "base/memory.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static char *skip_blanks(char *text)
{
    return text + strspn(text, " \t\r");
}

static void trim_end(char *text)
{
    size_t length = strlen(text);
    while (length && strchr(" \t\r", text[length - 1]))
        text[--length] = '\0';
}

static enum rb_status take_line(char *line, const struct rb_sheet_key *keys, void *user,
                                struct rb_error *error)
{
    line[strcspn(line, "#")] = '\0';
    trim_end(line);
    char *key = skip_blanks(line);
    if (!*key)
        return RB_OK;
    char *end = key + strcspn(key, " \t"), *rest = skip_blanks(end);
    error->column = (unsigned long)(key - line) + 1;
    *end = '\0';
    for (; keys->name; keys++)
        if (strcmp(keys->name, key) == 0) {
            error->column = (unsigned long)(rest - line) + 1;
            return keys->take(user, rest, error);
        }
    return rb_error_set(error, RB_INVALID, "there is no key %.64s", key);
}

enum rb_status rb_sheet_read(const char *path, const struct rb_sheet_key *keys, void *user,
                             struct rb_error *error)
{
    char *text;
    size_t size;
    enum rb_status status = rb_file_read(path, &text, &size, error);
    if (status)
        return status;
    char *line = text;
    unsigned long number = 1;
    if (strlen(text) != size)
        status = rb_error_set(error, RB_INVALID, "this is no text: it holds a NUL byte");
    while (status == RB_OK && *line) {
        char *end = line + strcspn(line, "\n");
        bool last = !*end;
        *end = '\0';
        error->line = number++;
        status = take_line(line, keys, user, error);
        line = last ? end : end + 1;
    }
    rb_free(text);
    if (status == RB_OK)
        *error = (struct rb_error){.line = 0};
    return status;
}

enum rb_status rb_sheet_text(char *to, size_t size, const char *text, struct rb_error *error)
{
    if (!*text)
        return rb_error_set(error, RB_INVALID, "there is nothing behind the key");
    snprintf(to, size, "%s", text);
    return RB_OK;
}

enum rb_status rb_sheet_append(char *to, size_t size, const char *text, struct rb_error *error)
{
    size_t length = strlen(to);
    if (length + strlen(text) + 2 > size)
        return rb_error_set(error, RB_INVALID, "more than %zu bytes", size - 1);
    snprintf(to + length, size - length, "%s%s", length ? " " : "", text);
    return RB_OK;
}

enum rb_status rb_sheet_value(struct rb_values *values, char *text, struct rb_error *error)
{
    char *formula;
    if (rb_sheet_cut(text, &formula, error) || rb_values_add(values, text, error))
        return RB_INVALID;
    error->column += (unsigned long)(formula - text);
    return rb_values_define(values, formula, error);
}

void rb_sheet_stem(const char *path, char stem[RB_SHEET_STEM_MAX])
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    snprintf(stem, RB_SHEET_STEM_MAX, "%.*s", (int)strcspn(name, "."), name);
}

enum rb_status rb_sheet_cut(char *text, char **rest, struct rb_error *error)
{
    char *sign = strchr(text, '=');
    if (!sign)
        return rb_error_set(error, RB_INVALID, "expected NAME = ...");
    *sign = '\0';
    *rest = skip_blanks(sign + 1);
    trim_end(text);
    return RB_OK;
}

const char *rb_sheet_folder(const char *folder, const char *installed, int index)
{
    static char path[1024];
    char program[512] = "";
    if (readlink("/proc/self/exe", program, sizeof program - 1) > 0 && strrchr(program, '/'))
        *strrchr(program, '/') = '\0';
    switch (index) {
    case 0:
        return folder;
    case 1:
        snprintf(path, sizeof path, "%s/../../%s", program, folder);
        return path;
    case 2:
        snprintf(path, sizeof path, "%s/../share/raybench/%s", program, installed);
        return path;
    default:
        return NULL;
    }
}
