#include "bench/run/cell.h"

#include "base/memory.h"
#include "measure/affinity.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEVEL 0.95

// At most this share of the time may be the probes' own.
static const double OVERHEAD_MAX = 0.01;

// What happened to more than one repetition in so many is flagged.
enum { OFTEN = 10 };

bool rb_cell_add(struct rb_cell *cell, const struct rb_sample *sample)
{
    if (cell->sample_count == cell->sample_room) {
        size_t room = cell->sample_room ? 2 * cell->sample_room : 16;
        struct rb_sample *grown = rb_alloc(room, sizeof *grown);
        if (!grown)
            return false;
        if (cell->sample_count)
            memcpy(grown, cell->samples, cell->sample_count * sizeof *grown);
        rb_free(cell->samples);
        cell->samples = grown;
        cell->sample_room = room;
    }
    cell->samples[cell->sample_count++] = *sample;
    return true;
}

void rb_cell_release(struct rb_cell *cell)
{
    rb_free(cell->samples);
    rb_free(cell->counted);
    rb_free(cell->simulated);
    rb_free(cell->hardware);
    rb_free(cell->energy);
}

bool rb_cell_has_time(const struct rb_cell *cell)
{
    return cell->state == RB_CELL_OPEN && cell->sample_count > 0;
}

const char *rb_cell_note(const struct rb_cell *cell)
{
    static const char *const notes[] = {
        [RB_CELL_OPEN] = "",
        [RB_CELL_UNAVAILABLE] = "unavailable",
        [RB_CELL_INVALID] = "invalid: differs from the reference",
        [RB_CELL_CRASHED] = "crashed",
    };
    if (cell->state == RB_CELL_OPEN && cell->sample_count == 0)
        return "not measured";
    return rb_cell_has_time(cell) && cell->group_tiles ? "estimated from a sample of tiles"
                                                       : notes[cell->state];
}

// What a figure is about: a number per sample; NaN if it has none.
typedef double measure_fn(const struct rb_sample *sample, const void *what);

static const struct rb_figure nothing = {
    (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, 0, 0,
};

// `values` are those of all samples in their order; medians of each process go to `medians`.
static size_t process_medians(const struct rb_cell *cell, const double *values, double *medians,
                              double *scratch)
{
    size_t count = 0;
    for (size_t first = 0; first < cell->sample_count;) {
        size_t end = first;
        while (end < cell->sample_count &&
               cell->samples[end].process == cell->samples[first].process)
            end++;
        memcpy(scratch, values + first, (end - first) * sizeof *scratch);
        medians[count++] = rb_stats_median_at(scratch, end - first, LEVEL).value;
        first = end;
    }
    return count;
}

// Of groups of tiles only min, p10 and the counts are filled.
static struct rb_figure figure_of(const struct rb_cell *cell, measure_fn *measure, const void *what)
{
    struct rb_figure figure = nothing;
    size_t count = cell->sample_count;
    double *values = rb_cell_has_time(cell) ? malloc(3 * count * sizeof *values) : NULL;
    if (!values)
        return figure;
    double *medians = values + count, *scratch = medians + count;
    for (size_t i = 0; i < count; i++)
        values[i] = measure(&cell->samples[i], what);
    if (count && !isnan(values[0])) { // all samples have a number, or none has
        size_t n = process_medians(cell, values, medians, scratch);
        if (!cell->group_tiles) {
            struct rb_median median = rb_stats_median_at(medians, n, LEVEL);
            figure.value = median.value, figure.level = median.level;
            figure.low = median.low, figure.high = median.high;
            figure.mdape_pct = rb_stats_mdape_pct(values, count, figure.value);
        }
        figure.min = rb_stats_quantile(values, count, 0.0);
        figure.p10 = rb_stats_quantile(values, count, 0.1);
        figure.n = n;
        figure.repetitions = count;
    }
    free(values);
    return figure;
}

// From groups of tiles: the ratio of what `top` and `bottom` measure, times `scale`.
static void estimate_ratio(const struct rb_cell *cell, measure_fn *top, measure_fn *bottom,
                           const void *what, double scale, struct rb_figure *figure)
{
    size_t count = cell->sample_count;
    double *x = malloc(2 * count * sizeof *x), *y = x ? x + count : NULL;
    if (!x)
        return;
    for (size_t i = 0; i < count; i++) {
        x[i] = bottom(&cell->samples[i], what);
        y[i] = top(&cell->samples[i], what);
    }
    struct rb_estimate ratio = rb_stats_ratio(x, y, count, cell->group_population);
    figure->value = ratio.value * scale;
    figure->low = ratio.low * scale;
    figure->high = ratio.high * scale;
    figure->level = isfinite(ratio.low) ? LEVEL : (double)NAN;
    free(x);
}

struct place {
    enum rb_stage stage;
    int bounce;
};

static double place_ns(const struct rb_sample *sample, const void *what)
{
    const struct place *place = what;
    return (double)sample->stage[place->stage][place->bounce].ns;
}

static double place_rays(const struct rb_sample *sample, const void *what)
{
    const struct place *place = what;
    return (double)sample->stage[place->stage][place->bounce].rays;
}

static double place_ns_per_ray(const struct rb_sample *sample, const void *what)
{
    double rays = place_rays(sample, what);
    return rb_sample_has_stages(sample) && rays > 0 ? place_ns(sample, what) / rays : (double)NAN;
}

static double wall_ns(const struct rb_sample *sample, const void *what)
{
    (void)what;
    return (double)sample->wall_ns;
}

static double wall_ns_per_ray(const struct rb_sample *sample, const void *what)
{
    return wall_ns(sample, NULL) / place_rays(sample, what);
}

static size_t process_p10(const struct rb_cell *cell, measure_fn *measure, const void *what,
                          double *times)
{
    const struct rb_sample *samples = cell->samples;
    size_t n = 0;
    if (!rb_cell_has_time(cell))
        return 0;
    for (size_t first = 0, end = 0; first < cell->sample_count; first = end) {
        double values[RB_REPETITIONS_MAX];
        size_t count = 0;
        for (; end < cell->sample_count && samples[end].process == samples[first].process; end++)
            if (count < RB_REPETITIONS_MAX)
                values[count++] = measure(&samples[end], what);
        if (isnan(values[0])) // a group of tiles without such rays
            return 0;
        times[n++] = rb_stats_quantile_lower(values, count, 0.1);
    }
    return n;
}

size_t rb_cell_process_p10(const struct rb_cell *cell, enum rb_stage stage, int bounce,
                           double *times)
{
    return process_p10(cell, place_ns_per_ray, &(struct place){stage, bounce}, times);
}

size_t rb_cell_process_wall_p10(const struct rb_cell *cell, enum rb_stage stage, int bounce,
                                double *times)
{
    return process_p10(cell, wall_ns_per_ray, &(struct place){stage, bounce}, times);
}

static double busy_ns(const struct rb_sample *sample, const void *what)
{
    (void)what;
    return rb_sample_has_stages(sample) ? (double)rb_sample_busy_ns(sample) : (double)NAN;
}

// The time of a group with perfectly shared work: its few tiles do not fill the threads evenly.
static double shared_ns(const struct rb_sample *sample, const void *what)
{
    return busy_ns(sample, what) / sample->threads;
}

static double build_ns(const struct rb_sample *sample, const void *what)
{
    (void)what;
    return sample->tree_bytes ? (double)sample->build_ns : (double)NAN;
}

static double all_rays(const struct rb_sample *sample, const void *what)
{
    (void)what;
    return (double)rb_sample_rays(sample);
}

static double imbalance(const struct rb_sample *sample, const void *what)
{
    double mean = busy_ns(sample, what) / sample->threads;
    return sample->busy_max_ns ? 1.0 - mean / (double)sample->busy_max_ns : (double)NAN;
}

static struct rb_figure whole_frame(const struct rb_cell *cell, measure_fn *measure,
                                    const void *what)
{
    struct rb_figure figure = figure_of(cell, measure, what);
    if (figure.n && cell->group_tiles) {
        estimate_ratio(cell, measure, all_rays, what, cell->reference->rays, &figure);
        figure.min = figure.p10 = (double)NAN; // of groups that are not the same
    }
    return figure;
}

struct rb_figure rb_cell_ns_per_ray(const struct rb_cell *cell, enum rb_stage stage, int bounce)
{
    const struct place place = {stage, bounce};
    struct rb_figure figure = figure_of(cell, place_ns_per_ray, &place);
    if (rb_cell_has_time(cell) && cell->group_tiles)
        estimate_ratio(cell, place_ns, place_rays, &place, 1.0, &figure);
    return figure;
}

struct rb_figure rb_cell_frame_ns(const struct rb_cell *cell)
{
    return whole_frame(cell, cell->group_tiles ? shared_ns : wall_ns, NULL);
}

struct rb_figure rb_cell_build_ns(const struct rb_cell *cell)
{
    return figure_of(cell, build_ns, NULL);
}

double rb_cell_busy_ns(const struct rb_cell *cell)
{
    return whole_frame(cell, busy_ns, NULL).value;
}

double rb_cell_share(const struct rb_cell *cell, enum rb_stage stage, int bounce)
{
    double part = 0, all = 0;
    for (size_t i = 0; i < cell->sample_count; i++) {
        const struct rb_sample *sample = &cell->samples[i];
        part += (double)(bounce < 0 ? rb_sample_stage_ns(sample, stage)
                                    : sample->stage[stage][bounce].ns);
        all += (double)rb_sample_busy_ns(sample);
    }
    return rb_cell_has_time(cell) && all > 0 ? part / all : (double)NAN;
}

double rb_cell_imbalance(const struct rb_cell *cell)
{
    return cell->group_tiles ? (double)NAN : figure_of(cell, imbalance, NULL).value;
}

double rb_cell_overhead(const struct rb_cell *cell, double probe_ns)
{
    double probes = 0, ns = 0;
    for (size_t i = 0; i < cell->sample_count; i++) {
        probes += (double)rb_sample_probes(&cell->samples[i]);
        ns += (double)rb_sample_busy_ns(&cell->samples[i]);
    }
    return rb_cell_has_time(cell) && ns > 0 ? probes * probe_ns / ns : (double)NAN;
}

static int processors(void)
{
    static int cpus[1024], count;
    count = count ? count : rb_affinity_list(cpus, 1024);
    return count ? count : INT_MAX;
}

static void add_flag(char text[128], const char *word, bool set)
{
    size_t length = strlen(text);
    if (set)
        snprintf(text + length, 128 - length, "%s%s", length ? ";" : "", word);
}

void rb_cell_flags(const struct rb_cell *cell, bool partial, double probe_ns, char text[128])
{
    size_t preempted = 0, stolen = 0, migrated = 0, unsteady = 0;
    size_t often = cell->sample_count / OFTEN; // more than this many repetitions
    bool time = rb_cell_has_time(cell);
    for (size_t i = 0; time && i < cell->sample_count; i++) {
        const struct rb_sample *sample = &cell->samples[i];
        preempted += sample->context_switches > 0;
        migrated += sample->migrations > 0;
        stolen += sample->steal_ms > 0;
        unsteady += sample->steady == 0;
    }
    text[0] = '\0';
    add_flag(text, "invalid", cell->state == RB_CELL_INVALID);
    add_flag(text, "crashed", cell->state == RB_CELL_CRASHED);
    add_flag(text, "partial", partial);
    add_flag(text, "inexact", time && !cell->variant->exact);
    add_flag(text, "estimated", time && cell->group_tiles);
    add_flag(text, "few", time && !isfinite(rb_cell_frame_ns(cell).low));
    add_flag(text, "unsteady", unsteady > often);
    add_flag(text, "preempted", preempted > often);
    add_flag(text, "migrated", migrated > often);
    add_flag(text, "stolen", stolen > often);
    add_flag(text, "oversubscribed", time && cell->settings.threads > processors());
    add_flag(text, "overhead", rb_cell_overhead(cell, probe_ns) > OVERHEAD_MAX);
}
