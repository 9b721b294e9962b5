// What can stand where on a command line, read off the tables that parse it, for the completions of
// the shells and the manual page.
#ifndef RB_SHELL_COMPLETE_H
#define RB_SHELL_COMPLETE_H

#include "cli/options.h"

#include <stdio.h>

// Bits of what can stand for a value.
enum {
    RB_TAKES_WORDS = 1, // those that rb_complete_words writes
    RB_TAKES_FILES = 2,
    RB_TAKES_FOLDERS = 4,
    RB_TAKES_LIST = 8, // of these, between commas
};

// The bits of a value as rb_option.value or a synopsis calls it: "SCENE", "blinn|phong". 0 if
// nothing is known, for a number say.
unsigned rb_complete_takes(const char *value);

// Its words, with blanks between.
void rb_complete_words(FILE *out, const char *value);

struct rb_position {
    char value[48]; // "SCENE"
    bool optional;
    bool repeated; // as often as one likes
};

enum { RB_POSITIONS_MAX = 8 };

// The positional arguments in the synopsis of a command. Returns how many.
int rb_complete_positions(const struct rb_command *command,
                          struct rb_position positions[RB_POSITIONS_MAX]);

// The first command from `commands` on that is not hidden; the NULL at the end if all are.
const struct rb_command *const *rb_complete_shown(const struct rb_command *const *commands);

// What stands for a character in a language; a table ends with a 0.
struct rb_escape {
    char character;
    const char *text;
};

void rb_put_escaped(FILE *out, const char *text, const struct rb_escape *escapes);
void rb_put_escaped_part(FILE *out, const char *text, size_t length,
                         const struct rb_escape *escapes);

// The completion scripts for commands ended by NULL. Errors are the stream's.
void rb_complete_bash(FILE *out, const struct rb_command *const *commands);
void rb_complete_zsh(FILE *out, const struct rb_command *const *commands);
void rb_complete_fish(FILE *out, const struct rb_command *const *commands);

#endif
