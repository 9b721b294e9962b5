// Runs a worker process and takes its samples.
#ifndef RB_RUN_PROCESS_H
#define RB_RUN_PROCESS_H

#include "base/status.h"
#include "bench/run/sample.h"

#include <stdbool.h>
#include <stddef.h>

// True once SIGINT, SIGTERM or SIGHUP has come in; the handlers are set by rb_process_catch_signals
// and end the worker that runs. rb_process_raise_again gives the signal its usual effect.
bool rb_process_interrupted(void);
void rb_process_catch_signals(void);
void rb_process_raise_again(void);

// The path of the running program.
enum rb_status rb_process_self(char *path, size_t size, struct rb_error *error);

enum { RB_WORKER_WORDS_MAX = 48, RB_WORKER_WORD_MAX = 320 };

// Command line of a worker. Zero-initialise, then add words printf-like.
struct rb_worker_words {
    char text[RB_WORKER_WORDS_MAX][RB_WORKER_WORD_MAX];
    int count;
};
void rb_worker_word(struct rb_worker_words *words, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Takes one record, which begins with this sample; false if there is no memory for it.
typedef bool rb_take_fn(void *user, const struct rb_sample *sample);

// Starts the program with these words and calls `take` for every record that it sends, of
// `record_bytes` bytes, a struct rb_sample and what may come behind it. RB_OK if the worker ended
// well; RB_INVALID if a sample said mismatch (all of them were taken); RB_FAILED with a text if it
// cannot be started, crashed or is another version. Without `take`, the program is one that sends
// nothing. `bind`: OpenMP threads stay on their processors
// unless the user has said otherwise.
enum rb_status rb_process_run(const struct rb_worker_words *words, bool bind, size_t record_bytes,
                              rb_take_fn *take, void *user, struct rb_error *error);

#endif
