// A progress bar with the time left, on standard error, and only where that is a terminal.
#ifndef RB_CLI_PROGRESS_H
#define RB_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct rb_progress {
    bool shown; // standard error is a terminal and the user did not say --quiet
    uint64_t start_ns, last_ns;
};

void rb_progress_start(struct rb_progress *progress, bool quiet);

// A rb_run_options.progress callback; `user` is the struct rb_progress.
void rb_progress_update(void *user, uint32_t done, uint32_t total);

// Wipes the bar.
void rb_progress_end(struct rb_progress *progress);

#endif
