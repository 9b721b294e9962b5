#ifndef RB_BENCH_ENV_H
#define RB_BENCH_ENV_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
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
    double tsc_ns_per_tick;
    double tsc_error_ppm;
    double probe_ns;
    bool complete;
    const char *pinning;
};
static inline void rb_env_write(FILE *out, const struct rb_env_run *run)
{
    fprintf(out, "{\"session\": \"%s\"}\n", run->session);
}
#endif
