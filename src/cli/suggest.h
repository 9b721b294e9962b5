// "did you mean --depth?": the one word nearest to what was typed, by edit distance.
#ifndef RB_CLI_SUGGEST_H
#define RB_CLI_SUGGEST_H

#include <stdbool.h>
#include <stddef.h>

struct rb_suggestion {
    const char *typed; // to be filled by the caller, with its length; the rest begins as zero
    size_t length;     // in bytes
    const char *word;  // the nearest so far; NULL if none is near
    size_t distance;   // of it
    bool ambiguous;    // another one is as near
};

// Considers a candidate. Near are at most two letters inserted, deleted or replaced, and fewer than
// half of those typed.
void rb_suggestion_offer(struct rb_suggestion *suggestion, const char *candidate);

enum { RB_SUGGESTION_TEXT = 80 };

// Writes "; did you mean WORD?", or nothing unless one candidate is the nearest. Returns `text`.
const char *rb_suggestion_text(const struct rb_suggestion *suggestion,
                               char text[RB_SUGGESTION_TEXT]);

#endif
