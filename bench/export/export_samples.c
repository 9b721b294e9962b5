// samples.csv: each line goes to the series of its key.
#include "bench/data/stats.h"
#include "bench/export/export_load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Columns behind the key.
enum { PROCESS, REPETITION, RAYS, NS, WALL_NS, COLUMN_COUNT };

struct taking {
    struct rb_export *result;
    struct rb_export_series *series;
    const struct rb_export_series **sorted; // by key
    int key[RB_KEY_COUNT], column[COLUMN_COUNT];
    int build_ns; // -1 if there is no such column
};

static int compare_keys(const char *const *a, const char *const *b)
{
    int order = 0;
    for (int i = 0; i < RB_KEY_COUNT && order == 0; i++)
        order = strcmp(a[i], b[i]);
    return order;
}

static int compare_series(const void *a, const void *b)
{
    const struct rb_export_series *const *x = a, *const *y = b;
    return compare_keys((*x)->key, (*y)->key);
}

static int compare_samples(const void *a, const void *b)
{
    const struct rb_export_sample *x = a, *y = b;
    if (x->series != y->series)
        return (x->series > y->series) - (x->series < y->series);
    if (x->process != y->process)
        return (x->process > y->process) - (x->process < y->process);
    return (x->repetition > y->repetition) - (x->repetition < y->repetition);
}

// Keeps a sample if it has a time and its line in kernels.csv has one.
static bool keep(struct taking *t, const struct rb_export_series *key,
                 struct rb_export_sample sample)
{
    const struct rb_export_series **found =
        bsearch(&key, t->sorted, t->result->series.count, sizeof *t->sorted, compare_series);
    bool per_ray = key->key[RB_KEY_BOUNCE][0] != '\0';
    if (!found || !(sample.work_ns >= 0) || (per_ray && !(sample.rays > 0)))
        return true;
    sample.series = (uint32_t)(*found - t->series);
    return rb_array_push(&t->result->pool, &sample, sizeof sample);
}

static enum rb_status take_row(struct taking *t, size_t row, struct rb_error *error)
{
    const struct rb_csv *csv = &t->result->samples;
    struct rb_export_series key;
    for (int i = 0; i < RB_KEY_COUNT; i++)
        key.key[i] = rb_csv_text(csv, row, t->key[i]);
    uint64_t index[2];
    for (int i = PROCESS; i <= REPETITION; i++) {
        if (rb_csv_word(csv, row, t->column[i], &index[i], 10) && index[i] < UINT32_MAX)
            continue;
        rb_csv_place(csv, row, t->column[i], error);
        return rb_error_set(error, RB_INVALID, "expected a whole number");
    }
    struct rb_export_sample sample = {
        .process = (uint32_t)index[PROCESS],
        .repetition = (uint32_t)index[REPETITION],
        .rays = rb_csv_number(csv, row, t->column[RAYS]),
        .work_ns = rb_csv_number(csv, row, t->column[NS]),
        .wall_ns = rb_csv_number(csv, row, t->column[WALL_NS]),
    };
    bool kept = keep(t, &key, sample);
    // The line of a frame says how long the process had built: once, before its first frame.
    if (kept && sample.repetition == 0 && strcmp(key.key[RB_KEY_KERNEL], "frame") == 0) {
        key.key[RB_KEY_KERNEL] = "build";
        sample.work_ns = sample.wall_ns = rb_csv_number(csv, row, t->build_ns);
        sample.rays = (double)NAN;
        kept = keep(t, &key, sample);
    }
    return kept ? RB_OK : rb_error_memory(error, "the samples");
}

// Every series gets its part of the sorted samples; those without are left out.
static bool deal(struct taking *t)
{
    const struct rb_export_sample *pool = t->result->pool.data;
    size_t count = t->result->pool.count, at = 0, kept = 0;
    if (count)
        qsort(t->result->pool.data, count, sizeof *pool, compare_samples);
    for (size_t i = 0; i < t->result->series.count; i++) {
        struct rb_export_series series = t->series[i];
        size_t first = at;
        while (at < count && pool[at].series == i)
            at++;
        series.samples = first < at ? pool + first : NULL;
        series.sample_count = at - first;
        if (series.sample_count)
            t->series[kept++] = series;
        else if (!rb_export_omit(t->result, &series, "no samples"))
            return false;
    }
    t->result->series.count = kept;
    return true;
}

static enum rb_status take(struct taking *t, struct rb_error *error)
{
    static const char *const names[] = {"process", "repetition", "rays", "ns", "wall_ns"};
    const struct rb_csv *csv = &t->result->samples;
    if (rb_export_columns(csv, rb_key_names, RB_KEY_COUNT, t->key, error) ||
        rb_export_columns(csv, names, COLUMN_COUNT, t->column, error))
        return RB_INVALID;
    t->build_ns = rb_csv_column(csv, "build_ns");
    for (size_t i = 0; i < t->result->series.count; i++)
        t->sorted[i] = &t->series[i];
    qsort(t->sorted, t->result->series.count, sizeof *t->sorted, compare_series);
    for (size_t row = 0; row < csv->row_count; row++) {
        enum rb_status status = take_row(t, row, error);
        if (status)
            return status;
    }
    t->result->scratch = rb_alloc(2 * t->result->pool.count, sizeof(double));
    return t->result->scratch && deal(t) ? RB_OK : rb_error_memory(error, "the samples");
}

enum rb_status rb_export_take_samples(struct rb_export *result, struct rb_error *error)
{
    struct taking t = {.result = result, .series = result->series.data};
    t.sorted = rb_alloc(result->series.count, sizeof *t.sorted);
    enum rb_status status = t.sorted ? take(&t, error) : rb_error_memory(error, "the samples");
    rb_free(t.sorted);
    return status;
}

// Millions of rays per second of elapsed time; without a wall time, one thread has its own.
static double ray_rate(const struct rb_export_series *series, const struct rb_export_run *run)
{
    bool serial = strcmp(series->key[RB_KEY_THREADS], "1") == 0;
    double elapsed = serial && isnan(run->wall_ns) ? run->work_ns : run->wall_ns;
    double rays = series->key[RB_KEY_BOUNCE][0] ? 1 : run->rays;
    double rate = 1e3 * rays / elapsed;
    return isfinite(rate) ? rate : (double)NAN;
}

bool rb_export_next_run(const struct rb_export *result, const struct rb_export_series *series,
                        size_t *at, struct rb_export_run *run)
{
    bool per_ray = series->key[RB_KEY_BOUNCE][0] != '\0';
    const struct rb_export_sample *samples = series->samples;
    size_t first = *at, i = first, wall_count = 0;
    double *work = result->scratch, *wall = result->scratch + series->sample_count;
    if (first == series->sample_count)
        return false;
    *run = (struct rb_export_run){.process = samples[first].process, .rays = samples[first].rays};
    for (; i < series->sample_count && samples[i].process == run->process; i++) {
        double unit = per_ray ? samples[i].rays : 1;
        run->iterations += unit;
        work[i - first] = samples[i].work_ns / unit;
        if (samples[i].wall_ns >= 0)
            wall[wall_count++] = samples[i].wall_ns / unit;
    }
    *at = i;
    run->repetitions = i - first;
    run->work_ns = rb_stats_median(work, run->repetitions).value;
    run->wall_ns =
        wall_count == run->repetitions ? rb_stats_median(wall, wall_count).value : (double)NAN;
    run->mrays_per_s = ray_rate(series, run);
    return true;
}

struct rb_export_summary rb_export_summarise(const double *values, size_t count, double *room)
{
    struct rb_export_summary s = {.min = values[0], .max = values[0]};
    double squares = 0;
    for (size_t i = 0; i < count; i++) {
        s.mean += values[i] / (double)count;
        s.min = fmin(s.min, values[i]);
        s.max = fmax(s.max, values[i]);
        room[i] = values[i];
    }
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - s.mean) * (values[i] - s.mean);
    s.stddev = count > 1 ? sqrt(squares / (double)(count - 1)) : (double)NAN;
    s.median = rb_stats_median(room, count).value;
    return s;
}
