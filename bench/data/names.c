#define _POSIX_C_SOURCE 200809L
#include "bench/data/names.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

bool rb_names_next(const char **list, char item[RB_NAME_MAX])
{
    *list += strspn(*list, ",");
    size_t length = strcspn(*list, ",");
    snprintf(item, RB_NAME_MAX, "%.*s", length < RB_NAME_MAX ? (int)length : RB_NAME_MAX, *list);
    *list += length;
    return length > 0;
}

bool rb_names_match(const char *list, const char *word)
{
    char item[RB_NAME_MAX];
    bool found = !list;
    while (!found && rb_names_next(&list, item))
        found = fnmatch(item, word, 0) == 0;
    return found;
}
