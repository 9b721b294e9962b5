// The raw repetitions of a run, samples.csv, put in order: for each cell, kernel and bounce the
// times of every process, repetition by repetition.
#ifndef RB_COMPARE_TIMINGS_H
#define RB_COMPARE_TIMINGS_H

#include "bench/data/csv_read.h"
#include "bench/data/key.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { RB_CELLS_MAX = 4096, RB_TIMED_KERNELS = 8, RB_ALL_BOUNCES = -1 };

struct rb_timed_kernel {
    const char *name;
    bool has_bounces;
    bool usual; // the frame and the four kernels that a comparison is about unless told otherwise
};
extern const struct rb_timed_kernel rb_timed_kernels[RB_TIMED_KERNELS];

struct rb_timed_cell {
    const char *key[RB_KEY_CELL]; // texts, in the table of the samples
    const char *image_hash;       // "" where none was recorded
    bool images_differ;           // among its own repetitions
};

// One kernel of one repetition. The time of a frame is the wall time, that of everything else the
// time of all threads.
struct rb_timing {
    size_t row; // of the CSV
    uint64_t process, repetition;
    double ns;
    uint32_t cell;
    int16_t kernel, bounce; // index in rb_timed_kernels; RB_ALL_BOUNCES: sum over all of them
    uint32_t parts;         // lines of the CSV in it
};

struct rb_timings {
    struct rb_csv csv;
    bool unfinished; // read from samples.csv.part, the run has not ended
    struct rb_timed_cell *cells;
    size_t cell_count;
    struct rb_timing *list; // by cell, kernel, bounce, process, repetition
    size_t count;
};

// Samples of one cell, kernel and bounce: count of them from `first` on.
struct rb_timing_range {
    const struct rb_timing *first;
    size_t count;
};

// Loads FOLDER/samples.csv, or the samples.csv.part of a run that has not ended, whose last
// repetition is left out. A repetition that lacks bounces of a kernel has no sum. RB_INVALID with
// file, line and column if the file is malformed. `samples` is freed with rb_timings_free in any
// case.
enum rb_status rb_timings_load(const char *folder, struct rb_timings *samples,
                               struct rb_error *error);
void rb_timings_free(struct rb_timings *samples);

// The samples that belong together; none gives a count of 0.
struct rb_timing_range rb_timings_find(const struct rb_timings *samples, size_t cell, int kernel,
                                       int bounce);

// Orders keys: numbers by value, other texts by bytes. Bits in `skip`, 1 << RB_KEY_SCENE say, are
// columns that do not count.
int rb_cell_compare(const struct rb_timed_cell *a, const struct rb_timed_cell *b, unsigned skip);

#endif
