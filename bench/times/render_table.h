// The render-time table: whole-process seconds of every variant on the six scenes of the 2019
// report, as report/table1.csv keeps them.
#ifndef RB_TIMES_RENDER_TABLE_H
#define RB_TIMES_RENDER_TABLE_H

#include "bench/data/csv_read.h"

#include <stdio.h>

// One line of the CSV. Times are seconds of one run; NaN (empty in the file) if not measured.
struct rb_render_row {
    const char *scene, *variant;
    double paper_s; // from Table 1 of the report: another machine
    int threads;
    double median_s, mean_s, min_s, max_s;
    int runs;                                      // in full; 0 if the median is extrapolated
    const char *source;                            // "hyperfine 1.15.0" or "raybench"
    double speedup_over_naive, speedup_over_paper; // of the median
    const char *note;                              // how it was measured, if not as usual
    const char *cpu_model, *git_commit, *utc;      // where, of what and when; same in all rows
    const char *available;                         // all variants of that machine, by blanks
    double user_s, system_s;                       // mean over the runs
    double frame_j; // net energy of a run; NaN: not measured, and without any there is no column
};

struct rb_render_table {
    struct rb_render_row *rows; // by scene, in the order of the report; naive first
    size_t count;
    struct rb_csv csv; // holds the text of a table that was loaded
};

// Room for `count` rows, the caller's to fill; texts are not copied. RB_FAILED without memory.
enum rb_status rb_render_table_create(struct rb_render_table *table, size_t count,
                                      struct rb_error *error);
void rb_render_table_free(struct rb_render_table *table); // harmless on a zeroed table

// Rounds the medians to the digits of the CSV and computes the speed-ups from these, NaN where
// there are none: whoever has the CSV gets the same.
void rb_render_table_derive(struct rb_render_table *table);

// Loads table1.csv. RB_FAILED: it cannot be read; RB_INVALID: it is no such table, has a scene that
// is none of the report's or the same row twice; nothing to free then. Speed-ups and the paper's
// seconds are computed anew, whatever the file says.
enum rb_status rb_render_table_load(const char *path, struct rb_render_table *table,
                                    struct rb_error *error);

// RFC 4180. What was loaded from a file that was written here gives the same bytes.
void rb_render_table_write(FILE *out, const struct rb_render_table *table);

// NULL if there is no such row.
const struct rb_render_row *rb_render_table_find(const struct rb_render_table *table,
                                                 const char *scene, const char *variant);

// Was the energy of any row measured?
bool rb_render_table_has_energy(const struct rb_render_table *table);

// Is the median scaled up from smaller images?
bool rb_render_row_estimated(const struct rb_render_row *row);

#endif
