#define _XOPEN_SOURCE 700
#include "bench/machine/env.h"

#include "base/cpu.h"
#include "base/hash.h"
#include "bench/data/json.h"
#include "bench/machine/doctor.h"
#include "bench/machine/env_build.h"
#include "bench/machine/machine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SCHEMA_VERSION = 1, LINE_MAX_BYTES = 512 };

extern char **environ;

// First line of what a command prints, without the newline. False if it fails. The rest is read as
// well, so that the command does not die of a closed pipe.
static bool first_line(const char *command, char line[LINE_MAX_BYTES])
{
    char rest[LINE_MAX_BYTES];
    line[0] = '\0';
    FILE *pipe = popen(command, "r");
    if (!pipe)
        return false;
    bool read = fgets(line, LINE_MAX_BYTES, pipe) || !ferror(pipe);
    while (fread(rest, 1, sizeof rest, pipe) == sizeof rest)
        ;
    line[strcspn(line, "\r\n")] = '\0';
    return pclose(pipe) == 0 && read;
}

static void write_time(struct rb_json *json, const char *key, time_t when)
{
    char text[32] = "";
    struct tm utc;
    bool known = gmtime_r(&when, &utc) && strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    rb_json_string(json, key, known ? text : NULL);
}

static void write_fact(struct rb_json *json, const char *key, const struct rb_fact *fact)
{
    switch (fact->kind) {
    case RB_FACT_IS_UNKNOWN:
        rb_json_string(json, key, NULL);
        break;
    case RB_FACT_IS_TEXT:
        rb_json_string(json, key, fact->text);
        break;
    case RB_FACT_IS_NUMBER:
        if (fabs(fact->number) < 1e15 && fact->number == floor(fact->number))
            rb_json_integer(json, key, (int64_t)fact->number);
        else
            rb_json_number(json, key, fact->number);
        break;
    case RB_FACT_IS_BOOL:
        rb_json_bool(json, key, fact->number > 0);
        break;
    }
}

static void write_caches(struct rb_json *json, const struct rb_machine *machine)
{
    rb_json_array(json, "caches");
    for (int i = 0; i < machine->cache_count; i++) {
        const struct rb_cache *cache = &machine->caches[i];
        rb_json_object(json, NULL);
        rb_json_integer(json, "level", cache->level);
        rb_json_string(json, "type", cache->type[0] ? cache->type : NULL);
        rb_json_number(json, "bytes", cache->bytes);
        rb_json_number(json, "line_bytes", cache->line_bytes);
        rb_json_number(json, "ways", cache->ways);
        rb_json_number(json, "shared_by_cpus", cache->shared_by ? cache->shared_by : (double)NAN);
        rb_json_end_object(json);
    }
    rb_json_end_array(json);
}

// Those that kernels are chosen by, RAYBENCH_CPU_DISABLE applied.
static void write_features(struct rb_json *json)
{
    const char *name;
    rb_json_array(json, "features");
    for (int i = 0; (name = rb_cpu_feature(i)); i++)
        if (rb_cpu_has(name, (int)strlen(name)))
            rb_json_string(json, NULL, name);
    rb_json_end_array(json);
}

// What belongs to a group of facts and is none.
static void write_extras(struct rb_json *json, const char *group, const struct rb_machine *machine,
                         const struct rb_env_run *run)
{
    if (strcmp(group, "cpu") == 0) {
        write_features(json);
        write_caches(json, machine);
    } else if (strcmp(group, "clock") == 0) {
        rb_json_number(json, "tsc_ns_per_tick", run->tsc_ns_per_tick);
        rb_json_number(json, "tsc_error_ppm", run->tsc_error_ppm);
        rb_json_number(json, "probe_ns", run->probe_ns);
    }
}

// An object per group of facts; the facts of a group stand together in the table.
static void write_machine(struct rb_json *json, const struct rb_machine *machine,
                          const struct rb_env_run *run)
{
    for (int id = 0; id < RB_FACT_COUNT;) {
        const char *group = rb_machine_fact_name((enum rb_fact_id)id).group;
        rb_json_object(json, group);
        for (; id < RB_FACT_COUNT; id++) {
            struct rb_fact_name name = rb_machine_fact_name((enum rb_fact_id)id);
            if (strcmp(name.group, group) != 0)
                break;
            write_fact(json, name.key, &machine->facts[id]);
        }
        write_extras(json, group, machine, run);
        rb_json_end_object(json);
    }
}

static void write_unreadable(struct rb_json *json, const struct rb_machine *machine)
{
    rb_json_object(json, "unreadable");
    for (int id = 0; id < RB_FACT_COUNT; id++) {
        struct rb_fact_name name = rb_machine_fact_name((enum rb_fact_id)id);
        const struct rb_fact *fact = &machine->facts[id];
        char key[64];
        snprintf(key, sizeof key, "%s.%s", name.group, name.key);
        if (fact->kind == RB_FACT_IS_UNKNOWN || (fact->kind == RB_FACT_IS_BOOL && fact->text[0]))
            rb_json_string(json, key, fact->text);
    }
    rb_json_end_object(json);
}

static int compare_text(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

// The variables of OpenMP and our own, sorted.
static void write_environment(struct rb_json *json)
{
    enum { SHOWN_MAX = 64 };
    char *shown[SHOWN_MAX], name[64];
    size_t count = 0;
    for (char **variable = environ; variable && *variable && count < SHOWN_MAX; variable++)
        if (strncmp(*variable, "OMP_", 4) == 0 || strncmp(*variable, "GOMP_", 5) == 0 ||
            strncmp(*variable, "KMP_", 4) == 0 || strncmp(*variable, "RAYBENCH_", 9) == 0)
            shown[count++] = *variable;
    qsort(shown, count, sizeof *shown, compare_text);
    rb_json_object(json, "environment");
    for (size_t i = 0; i < count; i++) {
        size_t length = strcspn(shown[i], "=");
        snprintf(name, sizeof name, "%.*s", (int)(length < 63 ? length : 63), shown[i]);
        rb_json_string(json, name, shown[i] + length + (shown[i][length] == '='));
    }
    rb_json_end_object(json);
}

static void write_build(struct rb_json *json)
{
    rb_json_object(json, "build");
    rb_json_string(json, "compiler", rb_env_compiler);
    rb_json_string(json, "flags", rb_env_flags);
    rb_json_end_object(json);
}

// Of the folder we stand in, which need not be where the program was built: the hash of the binary
// tells builds apart. Files that git does not know count as changes, since the Makefile would
// compile them. Without locks, since others may be at work there.
static void write_git(struct rb_json *json)
{
    char commit[LINE_MAX_BYTES], change[LINE_MAX_BYTES];
    bool known = first_line("git rev-parse HEAD 2>/dev/null", commit) &&
                 first_line("git --no-optional-locks status --porcelain 2>/dev/null", change);
    if (!known) {
        rb_json_string(json, "git", NULL);
        return;
    }
    rb_json_object(json, "git");
    rb_json_string(json, "commit", commit);
    rb_json_bool(json, "dirty", change[0] != '\0');
    rb_json_end_object(json);
}

// Hash and size of a file's bytes: words of eight in memory order, the last one filled with zeros,
// and the size.
static bool hash_file(const char *path, uint64_t *hash, uint64_t *size)
{
    uint64_t words[1024];
    size_t count;
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    *hash = *size = 0;
    while (memset(words, 0, sizeof words), (count = fread(words, 1, sizeof words, file)) > 0) {
        *size += count;
        for (size_t i = 0; i < (count + 7) / 8; i++)
            *hash = rb_hash_word(*hash, words[i]);
    }
    *hash = rb_hash_word(*hash, *size);
    bool whole = !ferror(file);
    fclose(file);
    return whole;
}

static void write_binary(struct rb_json *json, const char *program)
{
    uint64_t hash, size;
    char *path = realpath(program ? program : "/proc/self/exe", NULL);
    if (path && hash_file(path, &hash, &size)) {
        rb_json_object(json, "binary");
        rb_json_string(json, "path", path);
        rb_json_hash(json, "hash", hash);
        rb_json_unsigned(json, "size", size);
        rb_json_end_object(json);
    } else {
        rb_json_string(json, "binary", NULL);
    }
    free(path);
}

static void write_scenes(struct rb_json *json, const struct rb_env_run *run)
{
    rb_json_array(json, "scenes");
    for (int i = 0; i < run->scene_count; i++) {
        rb_json_object(json, NULL);
        rb_json_string(json, "name", run->scenes[i].name);
        rb_json_hash(json, "hash", run->scenes[i].hash);
        rb_json_integer(json, "primitives", run->scenes[i].primitives);
        rb_json_end_object(json);
    }
    rb_json_end_array(json);
}

static void write_tools(struct rb_json *json)
{
    static const char *const tools[] = {"hyperfine", "perf", "valgrind", "gcc", "clang", "git"};
    char command[64], line[LINE_MAX_BYTES];
    rb_json_object(json, "tools");
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++) {
        snprintf(command, sizeof command, "%s --version 2>/dev/null", tools[i]);
        rb_json_string(json, tools[i], first_line(command, line) && line[0] ? line : NULL);
    }
    rb_json_end_object(json);
}

static void write_doctor(struct rb_json *json, const struct rb_machine *machine)
{
    struct rb_doctor doctor;
    rb_doctor_examine(&doctor, machine);
    rb_doctor_json(json, "doctor", &doctor);
}

void rb_env_write(FILE *out, const struct rb_env_run *run)
{
    struct rb_json json = {.out = out};
    struct rb_machine machine;
    time_t now = time(NULL);
    rb_machine_read(&machine, "");

    rb_json_object(&json, NULL);
    rb_json_integer(&json, "schema_version", SCHEMA_VERSION);
    rb_json_string(&json, "session", run->session);
    write_time(&json, "started", run->started ? run->started : now);
    write_time(&json, "written", now);
    rb_json_bool(&json, "complete", run->complete);
    rb_json_string(&json, "command_line", run->command_line);
    rb_json_unsigned(&json, "seed", run->seed);
    rb_json_string(&json, "pinning", run->pinning);
    write_scenes(&json, run);
    if (run->program) { // how another program came about, we do not know
        rb_json_string(&json, "git", NULL);
        rb_json_string(&json, "build", NULL);
    } else {
        write_git(&json);
        write_build(&json);
    }
    write_binary(&json, run->program);
    write_machine(&json, &machine, run);
    write_environment(&json);
    write_tools(&json);
    write_doctor(&json, &machine);
    write_unreadable(&json, &machine);
    rb_json_end_object(&json);
}
