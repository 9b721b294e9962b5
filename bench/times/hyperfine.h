// hyperfine (https://github.com/sharkdp/hyperfine) as a stop-watch for whole processes.
#ifndef RB_TIMES_HYPERFINE_H
#define RB_TIMES_HYPERFINE_H

#include "base/memory.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { RB_HYPERFINE_VERSION_ROOM = 32, RB_HYPERFINE_COMMAND_ROOM = 16384 };

// What several runs of one command took.
struct rb_run_times {
    struct rb_array wall_s;  // of double, one per run
    double user_s, system_s; // means over the runs
};

void rb_run_times_free(struct rb_run_times *times);

// "hyperfine 1.15.0" if it is on PATH and can run a command without a shell (1.13 and later).
bool rb_hyperfine_find(char version[RB_HYPERFINE_VERSION_ROOM]);

// The command as one line that hyperfine splits into the same words: each in single quotes. False
// if there is no room for it.
bool rb_hyperfine_quote(char *const argv[], char *line, size_t size);

// Times `runs` runs of the command after `warmups` that do not count. `json` and `log` are names of
// files it may write. On RB_OK release `times`.
enum rb_status rb_hyperfine_run(char *const argv[], int warmups, int runs, const char *json,
                                const char *log, struct rb_run_times *times,
                                struct rb_error *error);

// Reads what --export-json wrote for one command; `text` has a NUL after its `length` bytes, of
// which any may be there. Anything but RFC 8259 JSON with the members we need, of the right kinds,
// is RB_INVALID with its line and column. On RB_OK release `times`.
enum rb_status rb_hyperfine_parse(const char *text, size_t length, struct rb_run_times *times,
                                  struct rb_error *error);

#endif
