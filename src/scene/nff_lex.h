// Splits NFF text into words and numbers, keeping line and column. Words are separated by white
// space; a '#' starts a comment that runs to the end of the line. Lines end in LF, CR LF or CR.
//
// One word is always read ahead. A lexer holds the buffer and nothing that needs releasing.
#ifndef RB_SCENE_NFF_LEX_H
#define RB_SCENE_NFF_LEX_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum {
    RB_NFF_BUFFER = 1 << 16,
    RB_NFF_WORD_MAX = 1023, // longer words are cut here; no number and no keyword is that long
    RB_NFF_QUOTE = 104,     // room for a quoted word: 24 bytes of 4 characters each, and some
};

enum rb_nff_token {
    RB_NFF_END,    // end of the file, or of what could be read of it
    RB_NFF_NUMBER, // starts like a number: digit, sign or point
    RB_NFF_WORD,
};

struct rb_nff_lexer {
    enum rb_nff_token token; // what comes next
    const char *text;        // the word, `length` bytes, until the next call
    size_t length;
    unsigned long line, column; // where it starts; at the end of the file, where that is

    FILE *stream;
    int read_errno;                 // why reading stopped before the end of the file, or 0
    bool after_cr;                  // the last byte was a CR
    unsigned long line_now;         // of the next byte
    uint64_t line_start;            // offset in the file of the first byte of that line
    uint64_t buffer_start;          // offset in the file of the first byte of the buffer
    size_t at, end;                 // the bytes of the buffer not looked at yet
    char buffer[RB_NFF_BUFFER + 1]; // ends with a 0 that no loop runs over
};

// Starts on `stream` and reads the first word ahead.
void rb_nff_lex_start(struct rb_nff_lexer *lexer, FILE *stream);

// Steps over the word that comes next.
void rb_nff_lex_next(struct rb_nff_lexer *lexer);

// Steps over the word that comes next and over the rest of the line it is on.
void rb_nff_lex_next_line(struct rb_nff_lexer *lexer);

// Whether the word that comes next is `word`.
bool rb_nff_lex_is(const struct rb_nff_lexer *lexer, const char *word);

// The value of the word that comes next, correctly rounded. NULL if it is a decimal number that
// fits double precision, else what is wrong with it, to be put behind the quoted word.
const char *rb_nff_lex_number(const struct rb_nff_lexer *lexer, double *value);

// The word that comes next, in quotes, printable and not too long: for messages.
const char *rb_nff_lex_quote(const struct rb_nff_lexer *lexer, char out[RB_NFF_QUOTE]);

#endif
