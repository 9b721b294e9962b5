// Noise floors: how far apart this host has put the program and itself, per cell, kernel and
// bounce. Learned from A/A comparisons, which are kept in floor.csv next to the result folders with
// the host they hold for; rows of other hosts count for nothing.
#ifndef RB_GATE_FLOOR_H
#define RB_GATE_FLOOR_H

#include "bench/compare/comparison.h"
#include "bench/data/csv_read.h"

struct rb_floor {
    char path[768];
    char host[256];    // its fingerprint: name, processor, how many
    struct rb_csv csv; // what the file holds; no rows if there is none
};

// The lowest floor there is: what a compiler's mood does to the layout of a program is about that.
#define RB_FLOOR_LEAST 1.02

// Loads FOLDER/floor.csv, if it is there. RB_INVALID if it is malformed. Release with
// rb_csv_free(&floor->csv).
enum rb_status rb_floor_load(const char *folder, struct rb_floor *floor, struct rb_error *error);

// The floor of a row as a ratio: from 1 / floor to floor is noise. NaN where nothing was learned.
// `*runs` is how many A/A comparisons it comes from.
double rb_floor_find(const struct rb_floor *floor, const struct rb_timed_cell *cell,
                     const struct rb_compare_row *row, size_t *runs);

// Adds the ratios of an A/A comparison to the file, and loads it again.
enum rb_status rb_floor_learn(struct rb_floor *floor, const struct rb_comparison *comparison,
                              struct rb_error *error);

#endif
