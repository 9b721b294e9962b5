// The JSON of Google Benchmark 1.7 (src/json_reporter.cc there), as its compare.py reads it: one
// "iteration" for each process, so that the U test has samples, and the usual aggregates of them.
//
// real_time is the time that passed, cpu_time that of all threads together, per ray or per frame;
// where the first was not measured, both are the second.
#include "bench/data/json.h"
#include "bench/data/json_read.h"
#include "bench/export/export.h"

#include <math.h>
#include <stdlib.h>

enum { TEXT_MAX = 1024 };

// A benchmark as they call it: all processes of a series.
struct family {
    struct rb_json *json;
    const struct rb_export_series *series;
    int64_t index;
    size_t count, at;          // processes, and those written
    double *real, *cpu, *room; // ns of each process, and room for as many
};

static void put_text(struct rb_json *json, const struct rb_export *result, const char *key,
                     const char *path)
{
    char text[TEXT_MAX];
    bool known = rb_json_get_text(rb_json_find(result->env, path), text, sizeof text);
    rb_json_string(json, key, known ? text : NULL);
}

static void put_number(struct rb_json *json, const struct rb_export *result, const char *key,
                       const char *path)
{
    rb_json_number(json, key, rb_json_get_number(rb_json_find(result->env, path)));
}

// Their keys, null where env.json does not say; then what else tells where the numbers are from.
static void put_context(struct rb_json *json, const struct rb_export *result)
{
    double load = rb_json_get_number(rb_json_find(result->env, "load.load_1m"));
    rb_json_object(json, "context");
    rb_json_string(json, "date", result->stamp[0] ? result->stamp : NULL);
    put_text(json, result, "host_name", "host.name");
    put_text(json, result, "executable", "binary.path");
    put_number(json, result, "num_cpus", "cpu.cpus");
    rb_json_string(json, "mhz_per_cpu", NULL);
    rb_json_string(json, "cpu_scaling_enabled", NULL);
    rb_json_array(json, "caches");
    rb_json_end_array(json);
    rb_json_array(json, "load_avg");
    if (isfinite(load))
        rb_json_number(json, NULL, load);
    rb_json_end_array(json);
    rb_json_string(json, "library_build_type", NULL);
    put_text(json, result, "cpu_model", "host.cpu_model");
    put_text(json, result, "session", "session");
    put_text(json, result, "command_line", "command_line");
    put_text(json, result, "git_commit", "git.commit");
    put_text(json, result, "git_dirty", "git.dirty");
    rb_json_end_object(json);
}

// The members that iterations and aggregates share, up to the repetitions. False if there is no
// memory.
static bool begin(const struct family *family, const char *run_type, const char *suffix)
{
    struct rb_json *json = family->json;
    char *name = rb_export_name(family->series->key, suffix);
    char *run_name = rb_export_name(family->series->key, "");
    bool whole = name && run_name;
    rb_json_object(json, NULL);
    rb_json_string(json, "name", name);
    rb_json_integer(json, "family_index", family->index);
    rb_json_integer(json, "per_family_instance_index", 0);
    rb_json_string(json, "run_name", run_name);
    rb_json_string(json, "run_type", run_type);
    rb_json_integer(json, "repetitions", (int64_t)family->count);
    free(name);
    free(run_name);
    return whole;
}

// The members behind the repetitions that both have.
static void put_times(const struct family *family, double iterations, double real, double cpu)
{
    struct rb_json *json = family->json;
    rb_json_integer(json, "threads", atoi(family->series->key[RB_KEY_THREADS]));
    rb_json_integer(json, "iterations", (int64_t)iterations);
    rb_json_number(json, "real_time", real);
    rb_json_number(json, "cpu_time", cpu);
    rb_json_string(json, "time_unit", "ns");
}

static bool put_run(struct family *family, const struct rb_export_run *run)
{
    struct rb_json *json = family->json;
    size_t i = family->at++;
    family->cpu[i] = run->work_ns;
    family->real[i] = isfinite(run->wall_ns) ? run->wall_ns : run->work_ns;
    if (!begin(family, "iteration", ""))
        return false;
    rb_json_integer(json, "repetition_index", run->process);
    put_times(family, run->iterations, family->real[i], family->cpu[i]);
    if (isfinite(run->rays))
        rb_json_number(json, "rays", run->rays);
    if (isfinite(run->mrays_per_s))
        rb_json_number(json, "Mrays/s", run->mrays_per_s);
    rb_json_end_object(json);
    return true;
}

static bool put_aggregates(const struct family *family)
{
    size_t n = family->count;
    struct rb_export_summary real = rb_export_summarise(family->real, n, family->room);
    struct rb_export_summary cpu = rb_export_summarise(family->cpu, n, family->room);
    const struct {
        const char *name, *suffix, *unit;
        double real, cpu;
    } rows[] = {
        {"mean", "_mean", "time", real.mean, cpu.mean},
        {"median", "_median", "time", real.median, cpu.median},
        {"stddev", "_stddev", "time", real.stddev, cpu.stddev},
        {"cv", "_cv", "percentage", real.stddev / real.mean, cpu.stddev / cpu.mean},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!begin(family, "aggregate", rows[i].suffix))
            return false;
        rb_json_string(family->json, "aggregate_name", rows[i].name);
        rb_json_string(family->json, "aggregate_unit", rows[i].unit);
        put_times(family, (double)n, rows[i].real, rows[i].cpu);
        rb_json_end_object(family->json);
    }
    return true;
}

static bool put_family(struct family *family, const struct rb_export *result)
{
    struct rb_export_run run;
    size_t most = family->series->sample_count;
    for (size_t at = 0; rb_export_next_run(result, family->series, &at, &run);)
        family->count++;
    double *room = rb_alloc(3 * most, sizeof *room);
    bool whole = room != NULL;
    family->real = room;
    family->cpu = room + most;
    family->room = room + 2 * most;
    for (size_t at = 0; whole && rb_export_next_run(result, family->series, &at, &run);)
        whole = put_run(family, &run);
    if (whole && family->count > 1)
        whole = put_aggregates(family);
    rb_free(room);
    return whole;
}

enum rb_status rb_export_google(const struct rb_export *result, FILE *out, struct rb_error *error)
{
    struct rb_json json = {.out = out};
    const struct rb_export_series *series = result->series.data;
    rb_json_object(&json, NULL);
    put_context(&json, result);
    rb_json_array(&json, "benchmarks");
    for (size_t i = 0; i < result->series.count; i++) {
        struct family family = {.json = &json, .series = &series[i], .index = (int64_t)i};
        if (!put_family(&family, result))
            return rb_error_memory(error, "a benchmark");
    }
    rb_json_end_array(&json);
    rb_json_end_object(&json);
    return RB_OK;
}
