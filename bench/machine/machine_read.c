#include "bench/machine/machine_read.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void make_printable(char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text < 0x20 || (unsigned char)*text >= 0x7f)
            *text = '?';
}

void rb_fact_unknown(struct rb_fact *fact, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(fact->text, sizeof fact->text, format, arguments);
    va_end(arguments);
    make_printable(fact->text);
    fact->kind = RB_FACT_IS_UNKNOWN;
    fact->number = 0;
}

void rb_fact_text(struct rb_fact *fact, const char *text)
{
    snprintf(fact->text, sizeof fact->text, "%s", text);
    make_printable(fact->text);
    fact->kind = RB_FACT_IS_TEXT;
    fact->number = 0;
}

void rb_fact_number(struct rb_fact *fact, double number)
{
    *fact = (struct rb_fact){.kind = RB_FACT_IS_NUMBER, .number = number};
}

void rb_fact_bool(struct rb_fact *fact, bool value, const char *reason)
{
    rb_fact_text(fact, reason);
    fact->kind = RB_FACT_IS_BOOL;
    fact->number = value;
}

static FILE *open_file(const char *root, const char *path)
{
    char whole[RB_MACHINE_PATH_MAX];
    int length = snprintf(whole, sizeof whole, "%s%s", root, path);
    return length < (int)sizeof whole ? fopen(whole, "re") : NULL;
}

static void trim(char *line)
{
    size_t length = strlen(line);
    while (length > 0 && strchr(" \t\r\n", line[length - 1]))
        line[--length] = '\0';
}

bool rb_machine_line(const char *root, const char *path, char *line, size_t size)
{
    line[0] = '\0';
    FILE *file = open_file(root, path);
    if (!file)
        return false;
    bool read = fgets(line, (int)size, file) || !ferror(file);
    fclose(file);
    trim(line);
    return read;
}

bool rb_machine_number(const char *root, const char *path, double *number)
{
    char line[128], *end;
    if (!rb_machine_line(root, path, line, sizeof line))
        return false;
    *number = strtod(line, &end);
    return end != line && isfinite(*number);
}

// Behind "key", blanks and at most one of ':' and '=', or NULL.
static const char *value_of(const char *line, const char *key)
{
    size_t length = strlen(key);
    if (strncmp(line, key, length) != 0 || !strchr(" \t:=", line[length]))
        return NULL;
    line += length;
    line += strspn(line, " \t");
    line += *line == ':' || *line == '=';
    return line + strspn(line, " \t");
}

bool rb_machine_value(const char *root, const char *path, const char *key, char *value, size_t size)
{
    char line[RB_MACHINE_LINE_MAX];
    const char *found = NULL;
    FILE *file = open_file(root, path);
    value[0] = '\0';
    if (!file)
        return false;
    while (!found && fgets(line, sizeof line, file)) {
        trim(line);
        found = value_of(line, key);
    }
    fclose(file);
    if (found)
        snprintf(value, size, "%s", found);
    return found;
}

bool rb_machine_next_range(const char **list, int *first, int *last)
{
    char *end;
    long low = strtol(*list, &end, 10), high = low;
    if (end == *list)
        return false;
    if (*end == '-') {
        const char *start = end + 1;
        high = strtol(start, &end, 10);
        if (end == start)
            return false;
    }
    enum { CPUS_MAX = 65536 }; // eight times what Linux can be built for
    if (low < 0 || high < low || high >= CPUS_MAX || (*end && *end != ','))
        return false;
    *list = end + (*end == ',');
    *first = (int)low;
    *last = (int)high;
    return true;
}

int rb_machine_list_count(const char *list)
{
    int count = 0, first, last;
    while (rb_machine_next_range(&list, &first, &last) && count < 1000000)
        count += last - first + 1;
    return *list ? 0 : count;
}
