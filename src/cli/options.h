// Command-line options: one table per command parses, checks and documents them.
#ifndef RB_CLI_OPTIONS_H
#define RB_CLI_OPTIONS_H

#include "base/status.h"
#include "render/settings.h"
#include "render/variants.h"
#include "scene/generate.h"

#include <stdbool.h>
#include <stddef.h>

enum { RB_GIVEN_MAX = 64 };

// What only the harness can be told.
struct rb_bench_arguments {
    const char *scenes, *variants, *threads, *tiles, *depths, *light_samples; // lists, as given
    const char *against;                                                      // a program
    const char *expect;                                                       // hashes
    double slice_s;
    int processes, process, cpu, group_tiles;
    bool resume, dry_run, full_reference;
    int runs; // of the render-time table, as the next ones
    const char *readme;
    bool check, rewrite;
    const char *kernels; // of a comparison, as the next ones
    double level, threshold_pct;
    bool bounces, gate;
    const char *format;  // of an export
    const char *classes; // of rays, to record
    int bounce;          // to replay
    bool list;
    const char *mode;    // time, count, simulate
    const char *measure; // what: a list
    bool count;
    const char *heatmap, *picture; // of it
    const char *l1, *ll;           // of a simulation, as the next one
    int simulate_tiles, simulate_sample;
    const char *baseline, *markdown, *json_file; // of a gate, as the next one
    bool update;
    const char *events;       // to count: a file or its name
    const char *perf_control; // a pipe to perf
    bool energy;
    double idle_s;            // how long to measure the idle machine
    const char *energy_model; // a file or its name
};

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
    double budget_s; // of a benchmark
    struct rb_bench_arguments bench;
    struct {
        const char *name, *value; // "--depth", "3"; "" for a flag
    } given[RB_GIVEN_MAX];        // the options, in order
    int given_count;
    const char *command_line; // as the user wrote it, about
    const char *root;         // folder with a copy of another machine's proc and sys
};

enum rb_option_kind {
    RB_OPTION_FLAG,        // bool; as a key of rb_options_assign "yes" or "no"
    RB_OPTION_TEXT,        // const char *
    RB_OPTION_INT,         // int within [low, high]
    RB_OPTION_NUMBER,      // double within [low, high]
    RB_OPTION_TIME,        // double, seconds within [low, high]: "90", "90s", "1.5m", "500ms", "2h"
    RB_OPTION_SEED,        // uint64_t
    RB_OPTION_SIZE,        // settings.width and height, "WxH"
    RB_OPTION_SPECULAR,    // settings.phong, "blinn" or "phong"
    RB_OPTION_LIGHT_SCALE, // settings.light_scale, "auto" or a number within [low, high]
    RB_OPTION_DIALECT,     // dialect, "p3d" or "spd"
    RB_OPTION_COUNT,       // int >= 0, remembers that it was given (size)
};

// What values and arguments are called says what completes them: FILE, DIR, SCENE, VARIANT and the
// other names of bench/shell/complete.c, words in small letters as themselves, alternatives between
// bars
// ("p3d|spd"). A list with commas ends in ",..." ("VARIANT,...").
struct rb_option {
    const char *name;  // "--depth"; ends a table if NULL
    const char *value; // what to call the value in the help, see below; NULL for a flag
    enum rb_option_kind kind;
    size_t offset;    // of the target in rb_arguments
    double low, high; // inclusive, where the kind has a range
    const char *help;
};

struct rb_command {
    const char *name;
    const char *summary;  // one line
    const char *synopsis; // after the name, arguments in order: "SCENE [RESULT...] [options]"
    const char *text;     // paragraphs for --help
    int positional_min, positional_max;
    const struct rb_option *const *groups;            // option tables, NULL-ended
    int (*run)(const struct rb_arguments *arguments); // returns the exit code
    bool hidden;                                      // works, but no list shows it
};

// Tables that several commands share.
extern const struct rb_option rb_options_settings[]; // how to render, but for the next table
extern const struct rb_option rb_options_levels[];   // --depth, --light-samples
extern const struct rb_option rb_options_variant[];  // --variant
extern const struct rb_option rb_options_threads[];  // --threads, --tile
extern const struct rb_option rb_options_strict[];   // reading scenes

// Parses the arguments behind the command's name. On RB_INVALID `error` says what is wrong.
enum rb_status rb_options_parse(const struct rb_command *command, int count, char **words,
                                struct rb_arguments *arguments, struct rb_error *error);

// Assigns one option by its long name without the dashes ("depth"), for files of `key = value`.
// `value` must outlive `arguments`. RB_INVALID where no option has this name or the value is wrong.
enum rb_status rb_options_assign(const struct rb_command *command, const char *name,
                                 const char *value, struct rb_arguments *arguments,
                                 struct rb_error *error);

// The options of a command by index, --help last; NULL beyond. For those who list them.
const struct rb_option *rb_options_at(const struct rb_command *command, int index);

// The full help page of a command, on standard output.
void rb_options_help(const struct rb_command *command);

#endif
