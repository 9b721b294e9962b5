// `raybench export`: a result folder in the formats that other tools read. Each format is one file
// bench/export/export_NAME.c and one row in the table of bench/export/export.c.
#ifndef RB_EXPORT_EXPORT_H
#define RB_EXPORT_EXPORT_H

#include "base/memory.h"
#include "bench/data/csv_read.h"
#include "bench/data/key.h"
#include "cli/options.h"

#include <stdio.h>

extern const struct rb_command rb_command_export;

// One frame, or its part in a kernel and bounce.
struct rb_export_sample {
    uint32_t series, process, repetition;
    double rays;    // in the frame; NaN if unknown
    double work_ns; // time of all threads together
    double wall_ns; // time that passed; NaN where it was not measured
};

// A line of kernels.csv with a time and all its samples, in the order of processes and repetitions;
// or a line of frame.csv, without samples.
struct rb_export_series {
    size_t row;                    // of the table
    const char *key[RB_KEY_COUNT]; // with a bounce, times are per ray; without, per frame
    const struct rb_export_sample *samples;
    size_t sample_count;
};

// Lines of one cell that are not among the series.
struct rb_export_omission {
    const char *key[RB_KEY_COUNT]; // of the first of them
    const char *why;
    size_t count;
};

// What a process measured of a series.
struct rb_export_run {
    uint32_t process;
    size_t repetitions;
    double iterations;  // rays or frames in all
    double rays;        // of a frame; NaN if unknown
    double work_ns;     // per ray or frame, time of all threads; median over the repetitions
    double wall_ns;     // the same of the time that passed; NaN where it was not measured
    double mrays_per_s; // by the time that passed; of one thread, its work. NaN if unknown
};

// A result folder.
struct rb_export {
    char *env;       // env.json, checked; NULL if there is none
    char stamp[32];  // when it was measured, RFC 3339 in UTC, by the folder's name; "" if not there
    bool unfinished; // samples.csv.part was read
    struct rb_csv kernels;  // kernels.csv
    struct rb_csv frames;   // frame.csv, unless samples are wanted
    struct rb_csv samples;  // samples.csv, if samples are wanted
    struct rb_array series; // struct rb_export_series: of kernels.csv if samples are wanted, else
                            // of frame.csv; what is invalid or has no time is not among them
    struct rb_array omissions; // struct rb_export_omission
    struct rb_array pool;      // struct rb_export_sample, of all series
    double *scratch;           // twice the number of samples
};

struct rb_export_format {
    const char *name;
    bool wants_samples;
    enum rb_status (*write)(const struct rb_export *result, FILE *out, struct rb_error *error);
};

enum rb_status rb_export_google(const struct rb_export *result, FILE *out, struct rb_error *error);
enum rb_status rb_export_benchfmt(const struct rb_export *result, FILE *out,
                                  struct rb_error *error);
enum rb_status rb_export_hyperfine(const struct rb_export *result, FILE *out,
                                   struct rb_error *error);
enum rb_status rb_export_markdown(const struct rb_export *result, FILE *out,
                                  struct rb_error *error);
enum rb_status rb_export_scaling(const struct rb_export *result, FILE *out, struct rb_error *error);

// Loads a result folder. RB_INVALID: it is none, or damaged. On failure there is nothing to free.
enum rb_status rb_export_load(const char *folder, bool wants_samples, struct rb_export *result,
                              struct rb_error *error);
void rb_export_free(struct rb_export *result);

// Where the named columns of a table are; RB_INVALID if one is missing.
enum rb_status rb_export_columns(const struct rb_csv *csv, const char *const *names, size_t count,
                                 int *columns, struct rb_error *error);

// Whether the words of `flags`, separated by ';', have `word` among them.
bool rb_export_has_flag(const char *flags, const char *word);

// Sums up the next process of a series from sample `*at` on and steps over it; false at the end.
// Uses the scratch of `result`.
bool rb_export_next_run(const struct rb_export *result, const struct rb_export_series *series,
                        size_t *at, struct rb_export_run *run);

// Moments of measured values; stddev is that of a sample, NaN for one value.
struct rb_export_summary {
    double mean, median, stddev, min, max;
};

// `room` holds as many values as `values`, of which there is at least one.
struct rb_export_summary rb_export_summarise(const double *values, size_t count, double *room);

// Writes "/scene:balls_high/variant:bvh/threads:1/bounce:0", with `colon` between key and value.
// Settings are named where they are not what they usually are: 512 x 512, depth 5, aa 1, 1 light
// sample, tile 64. What is no letter, digit or one of "+-._" is written as %XX.
void rb_export_put_name(FILE *out, const char *const key[RB_KEY_COUNT], char colon);

// "trace/scene:balls_high/..." and the suffix, to be released with free(); NULL if there is no
// memory.
char *rb_export_name(const char *const key[RB_KEY_COUNT], const char *suffix);

#endif
