// Command-line options: one table per command parses, checks and documents them.
#ifndef RB_CLI_OPTIONS_H
#define RB_CLI_OPTIONS_H

#include "base/status.h"
#include "render/settings.h"
#include "render/variants.h"
#include "scene/generate.h"

#include <stdbool.h>
#include <stddef.h>

// Everything any command can be told. Zero or NULL means not given.
struct rb_arguments {
    const char *positional[16];
    int positional_count;
    struct rb_settings settings;
    const char *output; // file, or folder of a benchmark
    const char *variant;
    bool hash, quiet, strict, json, help;
    int size; // of a generated scene
    bool size_given;
    enum rb_dialect dialect;
    double budget_s;    // of a benchmark
    const char *format; // of an export
};

enum rb_option_kind {
    RB_OPTION_FLAG,        // bool
    RB_OPTION_TEXT,        // const char *
    RB_OPTION_INT,         // int within [low, high]
    RB_OPTION_NUMBER,      // double within [low, high]
    RB_OPTION_SEED,        // uint64_t
    RB_OPTION_SIZE,        // settings.width and height, "WxH"
    RB_OPTION_SPECULAR,    // settings.phong, "blinn" or "phong"
    RB_OPTION_LIGHT_SCALE, // settings.light_scale, "auto" or a number
    RB_OPTION_DIALECT,     // dialect, "p3d" or "spd"
    RB_OPTION_COUNT,       // int >= 0, remembers that it was given (size)
};

struct rb_option {
    const char *name;  // "--depth"; ends a table if NULL
    const char *value; // what to call the value in the help; NULL for a flag
    enum rb_option_kind kind;
    size_t offset;    // of the target in rb_arguments
    double low, high; // inclusive, for INT and NUMBER
    const char *help;
};

struct rb_command {
    const char *name;
    const char *summary;  // one line
    const char *synopsis; // positional arguments and options, after the name
    const char *text;     // paragraphs for --help
    int positional_min, positional_max;
    const struct rb_option *const *groups;            // option tables, NULL-ended
    int (*run)(const struct rb_arguments *arguments); // returns the exit code
};

// Tables that several commands share.
extern const struct rb_option rb_options_settings[]; // how to render
extern const struct rb_option rb_options_variant[];  // --variant
extern const struct rb_option rb_options_threads[];  // --threads, --tile
extern const struct rb_option rb_options_strict[];   // reading scenes

// Parses the arguments behind the command's name. On RB_INVALID `error` says what is wrong.
enum rb_status rb_options_parse(const struct rb_command *command, int count, char **words,
                                struct rb_arguments *arguments, struct rb_error *error);

// The full help page of a command, on standard output.
void rb_options_help(const struct rb_command *command);

#endif
