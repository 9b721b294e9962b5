// Output files that are either whole or absent: written under a temporary name in the same folder
// and renamed when complete. A file that is replaced keeps its mode; a link keeps pointing at it. A
// path that is not a regular file ("-", /dev/stdout, a pipe) is written in place.
//
// Outputs are not thread-safe: one at a time. A file that is open when a signal handler calls
// rb_output_discard_on_signal is removed.
#ifndef RB_BASE_FILE_H
#define RB_BASE_FILE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

enum { RB_OUTPUT_PATH_MAX = 4096 };

struct rb_output {
    FILE *stream; // write here
    bool in_place;
    char path[RB_OUTPUT_PATH_MAX];
    char temporary[RB_OUTPUT_PATH_MAX];
};

// Opens PATH for writing; "-" is standard output. Every outcome is reported through `error`, with
// error->file set.
enum rb_status rb_output_open(struct rb_output *output, const char *path, struct rb_error *error);

// Flushes, closes and renames. On failure (a full disk, say) nothing is left under the final name
// that was not there before.
enum rb_status rb_output_commit(struct rb_output *output, struct rb_error *error);

// Closes and removes what was written so far. Harmless after a failed open or a commit.
void rb_output_discard(struct rb_output *output);

// Async-signal-safe: removes the temporary file of the output now open, if any.
void rb_output_discard_on_signal(void);

// Reads a whole file, or a pipe up to its end. `*text` gets the bytes and a terminating NUL, to be
// released with rb_free; `*size` does not count the NUL. RB_FAILED: it cannot be read, or there is
// no memory; `*text` is then NULL. Sets error->file in any case. Thread-safe.
enum rb_status rb_file_read(const char *path, char **text, size_t *size, struct rb_error *error);

#endif
