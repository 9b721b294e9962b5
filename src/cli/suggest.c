#include "cli/suggest.h"

#include <stdio.h>
#include <string.h>

enum { WORD_MAX = 48, DISTANCE_MAX = 2 };

static size_t smallest(size_t a, size_t b, size_t c)
{
    size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

// Levenshtein's distance of two words of at most WORD_MAX bytes, row by row.
static size_t edit_distance(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t row[WORD_MAX + 1];
    for (size_t j = 0; j <= b_length; j++)
        row[j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            row[j] = smallest(row[j] + 1, row[j - 1] + 1, replaced);
        }
    }
    return row[b_length];
}

void rb_suggestion_offer(struct rb_suggestion *suggestion, const char *candidate)
{
    size_t length = strlen(candidate);
    if (suggestion->length > WORD_MAX || length > WORD_MAX)
        return;
    size_t distance = edit_distance(suggestion->typed, suggestion->length, candidate, length);
    if (distance > DISTANCE_MAX || 2 * distance >= suggestion->length)
        return;
    if (suggestion->word && distance > suggestion->distance)
        return;
    suggestion->ambiguous = suggestion->word && distance == suggestion->distance;
    suggestion->word = candidate;
    suggestion->distance = distance;
}

const char *rb_suggestion_text(const struct rb_suggestion *suggestion,
                               char text[RB_SUGGESTION_TEXT])
{
    text[0] = '\0';
    if (suggestion->word && !suggestion->ambiguous)
        snprintf(text, RB_SUGGESTION_TEXT, "; did you mean %s?", suggestion->word);
    return text;
}
