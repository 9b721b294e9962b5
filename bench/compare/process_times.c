#include "bench/compare/process_times.h"

#include "base/memory.h"
#include "bench/data/stats.h"

// Samples of one process, in the order of its repetitions.
struct rb_process {
    uint64_t id;
    const struct rb_timing *first;
    size_t count;
};

bool rb_process_times_make(struct rb_process_times *work, size_t a_samples, size_t b_samples)
{
    const size_t counts[2] = {a_samples, b_samples};
    *work = (struct rb_process_times){0};
    work->scratch = rb_alloc(a_samples > b_samples ? a_samples : b_samples, sizeof(double));
    bool enough = work->scratch;
    for (int s = 0; s < 2; s++) {
        work->times[s] = rb_alloc(counts[s], sizeof(double));
        work->processes[s] = rb_alloc(counts[s], sizeof(struct rb_process));
        enough = enough && work->times[s] && work->processes[s];
    }
    return enough;
}

void rb_process_times_free(struct rb_process_times *work)
{
    for (int s = 0; s < 2; s++) {
        rb_free(work->processes[s]);
        rb_free(work->times[s]);
    }
    rb_free(work->scratch);
    *work = (struct rb_process_times){0};
}

static size_t split(struct rb_timing_range range, struct rb_process *processes)
{
    size_t count = 0;
    for (size_t i = 0; i < range.count; i++) {
        const struct rb_timing *sample = &range.first[i];
        if (count == 0 || processes[count - 1].id != sample->process)
            processes[count++] = (struct rb_process){sample->process, sample, 0};
        processes[count - 1].count++;
    }
    return count;
}

static double process_time(const struct rb_process *process, size_t repetitions, double quantile,
                           double *scratch)
{
    size_t count = process->count < repetitions ? process->count : repetitions;
    for (size_t i = 0; i < count; i++)
        scratch[i] = process->first[i].ns;
    return rb_stats_quantile_lower(scratch, count, quantile);
}

// Processes of one number.
static void fill_paired(struct rb_process_times *work, const size_t counts[2], double quantile)
{
    const struct rb_process *a = work->processes[0], *b = work->processes[1];
    size_t pairs = 0;
    for (size_t i = 0, j = 0; i < counts[0] && j < counts[1];) {
        bool step_a = a[i].id <= b[j].id, step_b = b[j].id <= a[i].id;
        if (step_a && step_b) {
            size_t common = a[i].count < b[j].count ? a[i].count : b[j].count;
            work->times[0][pairs] = process_time(&a[i], common, quantile, work->scratch);
            work->times[1][pairs] = process_time(&b[j], common, quantile, work->scratch);
            pairs += work->times[0][pairs] > 0 && work->times[1][pairs] > 0;
        }
        i += step_a;
        j += step_b;
    }
    work->counts[0] = work->counts[1] = pairs;
}

// What a typical process of one side repeats: a run that was stopped has shorter ones.
static size_t usual_repetitions(const struct rb_process *processes, size_t count, double *scratch)
{
    for (size_t i = 0; i < count; i++)
        scratch[i] = (double)processes[i].count;
    return count ? (size_t)rb_stats_quantile_lower(scratch, count, 0.5) : 0;
}

static void fill_independent(struct rb_process_times *work, const size_t counts[2], double quantile)
{
    size_t common = SIZE_MAX;
    for (int s = 0; s < 2; s++) {
        size_t usual = usual_repetitions(work->processes[s], counts[s], work->scratch);
        common = usual < common ? usual : common;
    }
    for (int s = 0; s < 2; s++) {
        size_t used = 0;
        for (size_t i = 0; i < counts[s]; i++) {
            work->times[s][used] =
                process_time(&work->processes[s][i], common, quantile, work->scratch);
            used += work->times[s][used] > 0;
        }
        work->counts[s] = used;
    }
}

void rb_process_times_fill(struct rb_process_times *work, struct rb_timing_range a,
                           struct rb_timing_range b, double quantile, bool paired)
{
    const size_t counts[2] = {split(a, work->processes[0]), split(b, work->processes[1])};
    if (paired)
        fill_paired(work, counts, quantile);
    else
        fill_independent(work, counts, quantile);
}
