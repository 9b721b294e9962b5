// The files that the render-time table becomes: table1.csv, table1.md and the block in a README.
#ifndef RB_TIMES_RENDER_FILES_H
#define RB_TIMES_RENDER_FILES_H

#include "bench/times/render_table.h"

enum { RB_RENDER_FILES_MAX = 3, RB_RENDER_FILE_PATH_MAX = 4096 };

struct rb_render_file {
    char path[RB_RENDER_FILE_PATH_MAX];
    char *text; // what the table makes of it
    size_t length;
};

struct rb_render_files {
    struct rb_render_file files[RB_RENDER_FILES_MAX]; // the CSV first
    int count;
};

// FOLDER/table1.csv into `path`. RB_INVALID if the name is too long.
enum rb_status rb_render_files_csv_path(const char *folder, char path[RB_RENDER_FILE_PATH_MAX],
                                        struct rb_error *error);

// Makes the texts of all files; `readme` is NULL or the README to put the block into, which must
// have its markers (RB_INVALID). On RB_OK release.
enum rb_status rb_render_files_make(struct rb_render_files *files,
                                    const struct rb_render_table *table, const char *folder,
                                    const char *readme, struct rb_error *error);
void rb_render_files_free(struct rb_render_files *files);

// Replaces the files, one after the other, each of them whole.
enum rb_status rb_render_files_save(const struct rb_render_files *files, struct rb_error *error);

// Could they be replaced? Nothing is changed.
enum rb_status rb_render_files_probe(const struct rb_render_files *files, struct rb_error *error);

// RB_INVALID with file and line if a file on disk differs from its text.
enum rb_status rb_render_files_check(const struct rb_render_files *files, struct rb_error *error);

#endif
