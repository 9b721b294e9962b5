// env.json: everything about a run that its timings depend on and do not show.
#ifndef RB_MACHINE_ENV_H
#define RB_MACHINE_ENV_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>

struct rb_env_scene {
    const char *name;
    uint64_t hash;
    uint32_t primitives;
};

struct rb_env_run {
    const char *command_line;
    const char *session;
    uint64_t seed;
    const struct rb_env_scene *scenes;
    int scene_count;
    double tsc_ns_per_tick; // NAN: unknown, as are the next two
    double tsc_error_ppm;
    double probe_ns;
    bool complete;
    const char *pinning; // what was done about it; NULL: unknown
    const char *program; // that was measured; NULL: this one
    time_t started;      // 0: when rb_env_write is called
};

// Writes one JSON object. Reads the machine, runs git in the current folder and asks tools for
// their versions, which takes about 0.1 s: do it outside of what is timed. What is unknown is null;
// "unreadable" says why for facts of the machine. Errors are the stream's.
void rb_env_write(FILE *out, const struct rb_env_run *run);

#endif
