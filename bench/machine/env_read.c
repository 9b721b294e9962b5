// Finds one string in a JSON file, character by character: nothing is allocated, and no input can
// be too large or too deep. The whole file is checked, so that a cut one is never taken for good.
#include "bench/machine/env.h"

#include <stdlib.h>
#include <string.h>

enum { NESTING_MAX = 32 };

struct scanner {
    FILE *file;
    int c;            // next character, or EOF
    const char *rest; // of the key, for the objects on its path; NULL elsewhere
    bool found;
    char *value;
    size_t size;
};

// A string that is kept: `size` bytes at most with the final NUL. `fits` turns false beyond.
struct text {
    char *bytes;
    size_t size, length;
    bool fits;
};

static void advance(struct scanner *s)
{
    s->c = fgetc(s->file);
}

static void skip_blanks(struct scanner *s)
{
    while (s->c == ' ' || s->c == '\t' || s->c == '\n' || s->c == '\r')
        advance(s);
}

static bool accept(struct scanner *s, int c)
{
    if (s->c != c)
        return false;
    advance(s);
    return true;
}

static bool accept_word(struct scanner *s, const char *word)
{
    while (*word)
        if (!accept(s, *word++))
            return false;
    return true;
}

static void keep(struct text *text, int code)
{
    text->fits = text->fits && code > 0 && code <= 0xff && text->length + 1 < text->size;
    if (text->fits)
        text->bytes[text->length++] = (char)code;
}

// Four hexadecimal digits, or -1.
static int scan_hex(struct scanner *s)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    int code = 0;
    for (int i = 0; i < 4; i++, advance(s)) {
        const char *digit = s->c > 0 ? strchr(digits, s->c) : NULL;
        if (!digit)
            return -1;
        code = 16 * code + (int)(digit - digits) % 16;
    }
    return code;
}

static bool scan_escape(struct scanner *s, struct text *text)
{
    static const char letters[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
    if (accept(s, 'u')) {
        int code = scan_hex(s);
        keep(text, code);
        return code >= 0;
    }
    const char *letter = s->c > 0 ? strchr(letters, s->c) : NULL;
    if (!letter)
        return false;
    keep(text, meanings[letter - letters]);
    advance(s);
    return true;
}

static bool scan_string(struct scanner *s, struct text *text)
{
    text->length = 0;
    text->fits = text->size > 0;
    if (!accept(s, '"'))
        return false;
    while (!accept(s, '"')) {
        if (s->c < 0x20) // or the end of the file
            return false;
        if (accept(s, '\\')) {
            if (!scan_escape(s, text))
                return false;
        } else {
            keep(text, s->c);
            advance(s);
        }
    }
    if (text->size > 0)
        text->bytes[text->length] = '\0';
    return true;
}

static bool scan_digits(struct scanner *s)
{
    if (s->c < '0' || s->c > '9')
        return false;
    while (s->c >= '0' && s->c <= '9')
        advance(s);
    return true;
}

static bool scan_number(struct scanner *s)
{
    accept(s, '-');
    if (!accept(s, '0') && !scan_digits(s))
        return false;
    if (accept(s, '.') && !scan_digits(s))
        return false;
    if (!accept(s, 'e') && !accept(s, 'E'))
        return true;
    if (!accept(s, '-'))
        accept(s, '+');
    return scan_digits(s);
}

static bool scan_value(struct scanner *s, int nesting);

// What remains of the key below a member called `name`: "" if it is what we look for, NULL if it
// is not on the path.
static const char *descend(const char *rest, const struct text *name)
{
    if (!rest || !name->fits || strncmp(rest, name->bytes, name->length) != 0)
        return NULL;
    rest += name->length;
    return *rest == '.' ? rest + 1 : *rest ? NULL : rest;
}

// The first string at the end of the path is the answer; everything else is only checked.
static bool scan_member(struct scanner *s, const char *rest, int nesting)
{
    bool wanted = rest && !*rest && s->c == '"' && !s->found;
    if (!wanted) {
        s->rest = rest && *rest ? rest : NULL;
        return scan_value(s, nesting);
    }
    struct text text = {.bytes = s->value, .size = s->size};
    bool whole = scan_string(s, &text);
    s->found = true;
    return whole && text.fits;
}

static bool scan_object(struct scanner *s, int nesting)
{
    char bytes[64];
    struct text name = {.bytes = bytes, .size = sizeof bytes};
    const char *rest = s->rest;
    skip_blanks(s);
    if (accept(s, '}'))
        return true;
    do {
        skip_blanks(s);
        if (!scan_string(s, &name))
            return false;
        skip_blanks(s);
        if (!accept(s, ':'))
            return false;
        skip_blanks(s);
        if (!scan_member(s, descend(rest, &name), nesting))
            return false;
        skip_blanks(s);
    } while (accept(s, ','));
    return accept(s, '}');
}

static bool scan_array(struct scanner *s, int nesting)
{
    skip_blanks(s);
    if (accept(s, ']'))
        return true;
    do {
        s->rest = NULL;
        skip_blanks(s);
        if (!scan_value(s, nesting))
            return false;
        skip_blanks(s);
    } while (accept(s, ','));
    return accept(s, ']');
}

static bool scan_value(struct scanner *s, int nesting)
{
    struct text ignored = {.bytes = NULL, .size = 0};
    if (nesting == NESTING_MAX)
        return false;
    switch (s->c) {
    case '{':
        advance(s);
        return scan_object(s, nesting + 1);
    case '[':
        advance(s);
        return scan_array(s, nesting + 1);
    case '"':
        return scan_string(s, &ignored);
    case 't':
        return accept_word(s, "true");
    case 'f':
        return accept_word(s, "false");
    case 'n':
        return accept_word(s, "null");
    default:
        return scan_number(s);
    }
}

bool rb_env_json_text(const char *path, const char *key, char *value, size_t size)
{
    struct scanner s = {.file = fopen(path, "rb"), .rest = key, .value = value, .size = size};
    if (size > 0)
        value[0] = '\0';
    if (!s.file)
        return false;
    advance(&s);
    skip_blanks(&s);
    bool whole = s.c == '{' && scan_value(&s, 0);
    skip_blanks(&s);
    whole = whole && s.c == EOF && !ferror(s.file);
    fclose(s.file);
    if (size > 0 && !(whole && s.found))
        value[0] = '\0';
    return whole && s.found;
}
