#include "scene/nff_lex.h"

#include <errno.h>
#include <string.h>

// What a byte does. The 0 behind the buffer's last byte looks like any other 0; `at == end` tells.
enum byte_kind { INSIDE, BLANK, LINE_END, COMMENT, ZERO };

static const unsigned char kind_of[256] = {
    ['\0'] = ZERO,  [' '] = BLANK,     ['\t'] = BLANK,    ['\v'] = BLANK,
    ['\f'] = BLANK, ['\n'] = LINE_END, ['\r'] = LINE_END, ['#'] = COMMENT,
};

static enum byte_kind kind_at(const struct rb_nff_lexer *lexer, size_t at)
{
    return (enum byte_kind)kind_of[(unsigned char)lexer->buffer[at]];
}

// Reads more behind the bytes not looked at yet, which move to the front. False if there is no
// more.
static bool refill(struct rb_nff_lexer *lexer)
{
    size_t kept = lexer->end - lexer->at;
    memmove(lexer->buffer, lexer->buffer + lexer->at, kept);
    lexer->buffer_start += lexer->at;
    lexer->at = 0;
    errno = 0;
    size_t got = fread(lexer->buffer + kept, 1, RB_NFF_BUFFER - kept, lexer->stream);
    if (got == 0 && ferror(lexer->stream))
        lexer->read_errno = errno ? errno : EIO;
    lexer->end = kept + got;
    lexer->buffer[lexer->end] = '\0';
    return got > 0;
}

// Steps over a line end. The LF of CR LF ends no line of its own.
static void end_line(struct rb_nff_lexer *lexer)
{
    bool cr = lexer->buffer[lexer->at++] == '\r';
    if (cr || !lexer->after_cr)
        lexer->line_now++;
    lexer->line_start = lexer->buffer_start + lexer->at;
    lexer->after_cr = cr;
}

// Steps over blanks, line ends and comments; over the rest of one line if `one_line`. False at the
// end of the file.
static bool skip(struct rb_nff_lexer *lexer, bool one_line)
{
    bool in_comment = one_line;
    for (;;) {
        enum byte_kind kind = kind_at(lexer, lexer->at);
        if (kind == ZERO && lexer->at == lexer->end) {
            if (!refill(lexer))
                return false;
            continue;
        }
        if (kind == LINE_END) {
            end_line(lexer);
            in_comment = false;
            continue;
        }
        if (kind == COMMENT)
            in_comment = true;
        else if (kind != BLANK && !in_comment)
            return true;
        lexer->at++;
        lexer->after_cr = false;
    }
}

// Length of the word at `at`, whose bytes are then all in the buffer. What is longer than
// RB_NFF_WORD_MAX, and so an error anyway, is cut.
static size_t word_end(struct rb_nff_lexer *lexer)
{
    size_t length = 0;
    for (;;) {
        enum byte_kind kind = kind_at(lexer, lexer->at + length);
        if (kind == ZERO && lexer->at + length == lexer->end) {
            if (!refill(lexer))
                return length;
            continue;
        }
        if (kind != INSIDE && kind != ZERO)
            return length;
        if (++length > RB_NFF_WORD_MAX)
            return length;
    }
}

static void scan(struct rb_nff_lexer *lexer, bool found)
{
    lexer->line = lexer->line_now;
    lexer->column = (unsigned long)(lexer->buffer_start + lexer->at - lexer->line_start) + 1;
    if (!found) {
        lexer->token = RB_NFF_END;
        lexer->text = "";
        lexer->length = 0;
        return;
    }
    lexer->length = word_end(lexer);
    lexer->text = lexer->buffer + lexer->at;
    lexer->at += lexer->length;
    lexer->after_cr = false;
    char first = lexer->text[0];
    bool numeric = (first >= '0' && first <= '9') || first == '-' || first == '+' || first == '.';
    lexer->token = numeric ? RB_NFF_NUMBER : RB_NFF_WORD;
}

void rb_nff_lex_start(struct rb_nff_lexer *lexer, FILE *stream)
{
    memset(lexer, 0, offsetof(struct rb_nff_lexer, buffer));
    lexer->buffer[0] = '\0';
    lexer->stream = stream;
    lexer->line_now = 1;
    refill(lexer);
    if (lexer->end >= 3 && memcmp(lexer->buffer, "\xef\xbb\xbf", 3) == 0) { // byte order mark
        lexer->at = 3;
        lexer->line_start = 3;
    }
    scan(lexer, skip(lexer, false));
}

void rb_nff_lex_next(struct rb_nff_lexer *lexer)
{
    scan(lexer, skip(lexer, false));
}

void rb_nff_lex_next_line(struct rb_nff_lexer *lexer)
{
    scan(lexer, skip(lexer, true));
}

bool rb_nff_lex_is(const struct rb_nff_lexer *lexer, const char *word)
{
    return strlen(word) == lexer->length && memcmp(word, lexer->text, lexer->length) == 0;
}

const char *rb_nff_lex_quote(const struct rb_nff_lexer *lexer, char out[RB_NFF_QUOTE])
{
    enum { SHOWN = 24 };
    char *to = out;
    *to++ = '\'';
    for (size_t i = 0; i < lexer->length && i < SHOWN; i++) {
        unsigned char byte = (unsigned char)lexer->text[i];
        bool plain = byte >= ' ' && byte < 127;
        to += snprintf(to, 5, plain ? "%c" : "\\x%02x", byte);
    }
    snprintf(to, 5, "%s", lexer->length > SHOWN ? "...'" : "'");
    return out;
}
