#define _POSIX_C_SOURCE 200809L
#include "bench/data/names.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

bool rb_name_matches(const char *pattern, const char *word)
{
    return fnmatch(pattern, word, 0) == 0;
}

bool rb_names_next(const char **list, char item[RB_NAME_MAX])
{
    *list += strspn(*list, ", \t");
    size_t end = strcspn(*list, ","), length = end;
    while (length > 0 && strchr(" \t", (*list)[length - 1]))
        length--;
    snprintf(item, RB_NAME_MAX, "%.*s", length < RB_NAME_MAX ? (int)length : RB_NAME_MAX, *list);
    *list += end;
    return length > 0;
}

bool rb_names_match(const char *list, const char *word)
{
    char item[RB_NAME_MAX];
    bool found = !list;
    while (!found && rb_names_next(&list, item))
        found = rb_name_matches(item, word);
    return found;
}
