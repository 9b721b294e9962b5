// The JSON of hyperfine --export-json (1.x): one result for each cell, every frame a run. What it
// calls user and system time is null: the harness does not take it.
#include "bench/data/json.h"
#include "bench/export/export_load.h"

#include <stdlib.h>
#include <string.h>

static void put_parameters(struct rb_json *json, const struct rb_export_series *series)
{
    rb_json_object(json, "parameters");
    for (int i = 0; i < RB_KEY_CELL; i++)
        rb_json_string(json, rb_key_names[i], series->key[i]);
    rb_json_end_object(json);
}

// The frame times in seconds, those that have a wall time; their number is returned.
static size_t take_times(const struct rb_export_series *series, double *times)
{
    size_t count = 0;
    for (size_t i = 0; i < series->sample_count; i++)
        if (series->samples[i].wall_ns >= 0)
            times[count++] = 1e-9 * series->samples[i].wall_ns;
    return count;
}

static void put_times(struct rb_json *json, const double *times, size_t count)
{
    rb_json_array(json, "times");
    for (size_t i = 0; i < count; i++)
        rb_json_number(json, NULL, times[i]);
    rb_json_end_array(json);
    rb_json_array(json, "exit_codes"); // of frames that were finished
    for (size_t i = 0; i < count; i++)
        rb_json_integer(json, NULL, 0);
    rb_json_end_array(json);
}

static bool put_result(struct rb_json *json, const struct rb_export *result,
                       const struct rb_export_series *series)
{
    double *times = result->scratch;
    size_t count = take_times(series, times);
    if (count == 0)
        return true;
    char *name = rb_export_name(series->key, "");
    struct rb_export_summary s = rb_export_summarise(times, count, times + count);
    rb_json_object(json, NULL);
    rb_json_string(json, "command", name);
    rb_json_number(json, "mean", s.mean);
    rb_json_number(json, "stddev", s.stddev);
    rb_json_number(json, "median", s.median);
    rb_json_string(json, "user", NULL);
    rb_json_string(json, "system", NULL);
    rb_json_number(json, "min", s.min);
    rb_json_number(json, "max", s.max);
    put_times(json, times, count);
    put_parameters(json, series);
    rb_json_end_object(json);
    bool named = name != NULL;
    free(name);
    return named;
}

enum rb_status rb_export_hyperfine(const struct rb_export *result, FILE *out,
                                   struct rb_error *error)
{
    struct rb_json json = {.out = out};
    rb_json_object(&json, NULL);
    rb_json_array(&json, "results");
    const struct rb_export_series *series = result->series.data;
    for (size_t i = 0; i < result->series.count; i++)
        if (strcmp(series[i].key[RB_KEY_KERNEL], "frame") == 0 &&
            !put_result(&json, result, &series[i]))
            return rb_error_memory(error, "a name");
    rb_json_end_array(&json);
    rb_json_end_object(&json);
    return RB_OK;
}
