// The file of a history: NDJSON, an object a line for each kernel of each cell of each run, in the
// order in which they were added. Lines are only ever appended.
//
// Members: schema_version (1), session, commit (or null), host, cpu_model; the key of the cell as
// in kernels.csv, all of them strings; kernel; ms, ms_lo, ms_hi: median over processes of the
// median of their repetitions, with its 95 % interval (null if there are too few); processes;
// image_hash.
#ifndef RB_HISTORY_LOG_H
#define RB_HISTORY_LOG_H

#include "base/memory.h"
#include "base/status.h"

enum { RB_LOG_TEXT_MAX = 768 };

// One line. What does not change along a course is its name: the cell, the kernel, the host.
struct rb_log_entry {
    char course[RB_LOG_TEXT_MAX];
    char scene[256], variant[64], kernel[24]; // to choose by
    char session[128], commit[16];
    double ms, low, high; // low, high: NaN if there is no interval
    size_t order;         // line of the file
};

// Reads the file into an array of struct rb_log_entry, by course and then in their order; no
// entries if it is not there. RB_INVALID with the line of what is not such an object.
enum rb_status rb_log_read(const char *path, struct rb_array *entries, struct rb_error *error);

// Appends the run in a result folder, unless a line of its session is there; `*added` says so.
enum rb_status rb_log_append(const char *path, const struct rb_array *entries, const char *folder,
                             bool *added, struct rb_error *error);

#endif
