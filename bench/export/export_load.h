// What the two halves of loading a result folder share.
#ifndef RB_EXPORT_EXPORT_LOAD_H
#define RB_EXPORT_EXPORT_LOAD_H

#include "bench/export/export.h"

// Where the columns of a table are.
struct rb_export_table {
    int key[RB_KEY_COUNT], time[2];
    int remark[2]; // flags, note
    size_t key_count, time_count;
};

// RB_INVALID with the place if a field of the key (its first `count`) is not what it should be.
enum rb_status rb_export_check_key(const struct rb_csv *csv, size_t row, const int *columns,
                                   size_t count, struct rb_error *error);

// Gives the lines of samples.csv to the series; those that get none become omissions.
enum rb_status rb_export_take_samples(struct rb_export *result, struct rb_error *error);

// Counts a line that has no time; those of one cell that follow one another are one omission.
// False if there is no memory.
bool rb_export_omit(struct rb_export *result, const struct rb_export_series *series,
                    const char *why);

#endif
