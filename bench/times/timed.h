// Runs a program as a process of its own and times all of it, from before it exists until it is
// reaped.
//
// The process gets a group of its own, so that a signal that ends us ends it and its children, too:
// SIGINT, SIGTERM, SIGHUP and SIGQUIT are passed on while it runs. Not thread-safe.
#ifndef RB_TIMES_TIMED_H
#define RB_TIMES_TIMED_H

#include "base/status.h"

struct rb_timed_result {
    double wall_s;           // CLOCK_MONOTONIC around it
    double user_s, system_s; // of the process and what it waited for, all threads
};

// Runs argv[0], looked up on PATH if it has no slash, with `environment` or, if that is NULL, with
// ours. Its standard input and output are /dev/null,
// its standard error goes to the file `log`, whose last line explains a failure. RB_FAILED if it
// cannot be started, exits with another code than 0, or a signal ends it or us.
enum rb_status rb_timed_run(char *const argv[], char *const environment[], const char *log,
                            struct rb_timed_result *time, struct rb_error *error);

// The signal that arrived during the last run and asks us to end, 0 if none did. The caller tidies
// up and raises it again.
int rb_timed_interrupted(void);

#endif
