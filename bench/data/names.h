// Lists of names as options take them: separated by commas, blanks around them dropped, each a name
// or a glob ("balls*").
#ifndef RB_DATA_NAMES_H
#define RB_DATA_NAMES_H

#include <stdbool.h>

enum { RB_NAME_MAX = 256 };

// Does the pattern, a name or a glob, match the word?
bool rb_name_matches(const char *pattern, const char *word);

// Takes the next item off `*list`, cut to RB_NAME_MAX bytes with the terminator; false at the end.
bool rb_names_next(const char **list, char item[RB_NAME_MAX]);

// Is `word` in the list? In NULL, which is no list, everything is.
bool rb_names_match(const char *list, const char *word);

#endif
