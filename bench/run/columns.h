// Tables of results: one list of columns, each a name and a function, makes the header and the rows
// of a CSV file (RFC 4180) and the objects of a JSON file alike. What a column returns for a line
// is a value or nothing; what was not measured is nothing, never 0.
#ifndef RB_RUN_COLUMNS_H
#define RB_RUN_COLUMNS_H

#include "bench/data/json.h"
#include "bench/run/cell.h"

#include <stdio.h>

enum rb_value_kind {
    RB_VALUE_NONE,
    RB_VALUE_TEXT,
    RB_VALUE_INTEGER,
    RB_VALUE_NUMBER,
    RB_VALUE_HASH
};

struct rb_value {
    enum rb_value_kind kind;
    union {
        const char *text;
        int64_t integer;
        double number; // not finite: nothing
        uint64_t hash;
    };
};

// One line of any of the files. Each file uses what it needs.
struct rb_line {
    const struct rb_cell *cell;
    bool partial;    // the run is not finished
    double probe_ns; // what a probe costs
    // Of kernels.csv:
    const char *kernel;
    enum rb_stage stage;
    int bounce;                           // -1: none
    const struct rb_sample_stage *counts; // of a whole frame; NULL where there are none
    struct rb_figure per_ray;             // ns
    double ns;                            // of a whole frame
    double wall_ns;                       // share of the frame's wall time
    double share;                         // of the frame's thread time
    // Of samples.csv:
    const struct rb_sample *sample;
};

struct rb_column {
    const char *name;
    struct rb_value (*of)(const struct rb_line *line);
};

extern const struct rb_column rb_kernel_columns[]; // all ended by a NULL name
extern const struct rb_column rb_frame_columns[];
extern const struct rb_column rb_sample_columns[];

void rb_columns_csv_header(FILE *out, const struct rb_column *columns);
void rb_columns_csv_row(FILE *out, const struct rb_column *columns, const struct rb_line *line);
void rb_columns_json_row(struct rb_json *json, const struct rb_column *columns,
                         const struct rb_line *line);

// Values.
struct rb_value rb_text(const char *text); // "" and NULL: nothing
struct rb_value rb_integer(int64_t value);
struct rb_value rb_number(double value);
struct rb_value rb_hash(uint64_t value);
struct rb_value rb_none(void);

// The columns that say which cell a line is about; every table begins with them.
struct rb_value rb_cell_scene(const struct rb_line *line);
struct rb_value rb_cell_width(const struct rb_line *line);
struct rb_value rb_cell_height(const struct rb_line *line);
struct rb_value rb_cell_depth(const struct rb_line *line);
struct rb_value rb_cell_aa(const struct rb_line *line);
struct rb_value rb_cell_light_samples(const struct rb_line *line);
struct rb_value rb_cell_tile(const struct rb_line *line);
struct rb_value rb_cell_variant(const struct rb_line *line);
struct rb_value rb_cell_threads(const struct rb_line *line);
#define RB_KEY_COLUMNS                                                                             \
    {"scene", rb_cell_scene}, {"width", rb_cell_width}, {"height", rb_cell_height},                \
        {"depth", rb_cell_depth}, {"aa", rb_cell_aa}, {"light_samples", rb_cell_light_samples},    \
        {"tile", rb_cell_tile}, {"variant", rb_cell_variant},                                      \
    {                                                                                              \
        "threads", rb_cell_threads                                                                 \
    }

// Values of further columns that several tables have.
struct rb_value rb_cell_flag_words(const struct rb_line *line);
struct rb_value rb_cell_note_text(const struct rb_line *line);
struct rb_value rb_cell_overhead_pct(const struct rb_line *line);
struct rb_value rb_schema_version(const struct rb_line *line);

enum { RB_SCHEMA_VERSION = 2 };

#endif
