#include "bench/versus/versus.h"

#include "bench/data/csv_write.h"
#include "embree/embree.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LEVEL = 0.95;

// The figures of a contest. NaN for what there is not.
struct line {
    const struct rb_contest *contest;
    double mrays[2];
    double build_ns[2], bytes[2]; // bytes per primitive
    struct rb_median ratio;       // ours over Embree's, in rays per second
    uint64_t compared, differ;    // answers of Embree's
};

// ns per ray of each process of a side; NULL without memory.
static double *times_of(const struct rb_contest *contest, int side, size_t *count)
{
    const struct rb_cell *cell = &contest->side[side].cell;
    const struct rb_record_choice *rays = &contest->rays->rays;
    double *times = rb_alloc(cell->sample_count, sizeof *times);
    *count = times ? rb_cell_process_p10(cell, rays->kernel, rays->bounce, times) : 0;
    return times;
}

static void fill_side(struct line *line, int side)
{
    const struct rb_contest *contest = line->contest;
    const struct rb_cell *cell = &contest->side[side].cell;
    line->mrays[side] = line->build_ns[side] = line->bytes[side] = (double)NAN;
    if (!rb_cell_has_time(cell))
        return;
    line->build_ns[side] = rb_cell_build_ns(cell).value;
    line->bytes[side] = (double)cell->samples[0].tree_bytes / contest->primitive_count;
    for (size_t i = 0; side == 1 && i < cell->sample_count; i++)
        if (cell->samples[i].repetition == 0) {
            line->compared += cell->samples[i].compared;
            line->differ += cell->samples[i].differ;
        }
}

static struct line make_line(const struct rb_contest *contest)
{
    struct line line = {.contest = contest};
    size_t count[2];
    double *times[2];
    for (int side = 0; side < 2; side++) {
        fill_side(&line, side);
        times[side] = times_of(contest, side, &count[side]);
    }
    size_t pairs = count[0] < count[1] ? count[0] : count[1]; // fewer where it was stopped
    line.ratio = rb_stats_paired_ratio(times[0], times[1], pairs, LEVEL);
    for (int side = 0; side < 2; side++) {
        if (count[side])
            line.mrays[side] = 1e3 / rb_stats_median_at(times[side], count[side], LEVEL).value;
        rb_free(times[side]);
    }
    return line;
}

const char *rb_versus_mode(const struct rb_contest *contest)
{
    const char *name = contest->side[1].row->name;
    return name + strlen("embree-");
}

static bool has_times(const struct rb_contest *contest)
{
    return rb_cell_has_time(&contest->side[0].cell) && rb_cell_has_time(&contest->side[1].cell);
}

// What there is not comes last.
static int by_ratio(const void *a, const void *b)
{
    const struct line *x = a, *y = b;
    if (isnan(x->ratio.value) || isnan(y->ratio.value))
        return isnan(x->ratio.value) - isnan(y->ratio.value);
    return (x->ratio.value > y->ratio.value) - (x->ratio.value < y->ratio.value);
}

static void print_line(const struct line *line)
{
    const struct rb_contest *contest = line->contest;
    char interval[32] = "-";
    if (isfinite(line->ratio.low))
        snprintf(interval, sizeof interval, "%.2f to %.2f", line->ratio.low, line->ratio.high);
    printf("  %-11s %-11s %7.2f  %-15s %8.2f %8.2f  %-14s %s\n", contest->scene, contest->rays_name,
           line->ratio.value, interval, line->mrays[0], line->mrays[1], contest->side[0].row->name,
           rb_versus_mode(contest));
}

// Trees, of our row for the first class and of Embree at medium quality, and wrong answers of all
// classes.
static void print_scene(const struct line *lines, size_t count)
{
    const struct line *first = &lines[0];
    uint64_t compared = 0, differ = 0;
    for (size_t i = 0; i < count; i++) {
        compared += lines[i].compared;
        differ += lines[i].differ;
    }
    double medium_ns = first->contest->medium_build_ns;
    double medium_bytes = (double)first->contest->medium_bytes / first->contest->primitive_count;
    printf("  %-11s %9.1f ms %9.1f ms %8.2f %9.1f %9.1f   %" PRIu64 " of %" PRIu64 " rays\n",
           first->contest->scene, first->build_ns[0] * 1e-6, medium_ns * 1e-6,
           medium_ns / first->build_ns[0], first->bytes[0], medium_bytes, differ, compared);
}

void rb_versus_print(const struct rb_contest *contests, size_t count)
{
    struct line *lines = rb_alloc(count, sizeof *lines);
    size_t made = 0;
    for (size_t i = 0; lines && i < count; i++)
        if (has_times(&contests[i]))
            lines[made++] = make_line(&contests[i]);
    if (made) {
        printf("\n  trees, built by one thread; Embree %s, medium quality\n", rb_embree_version());
        printf("  %-11s %12s %12s %8s %9s %9s   %s\n", "scene", "our build", "Embree's", "ratio",
               "bytes/pr.", "Embree's", "answers of Embree's that differ");
        for (size_t first = 0, end = 0; first < made; first = end) {
            while (end < made && lines[end].contest->scene == lines[first].contest->scene)
                end++;
            print_scene(&lines[first], end - first);
        }
        qsort(lines, made, sizeof *lines, by_ratio);
        printf("\n  %-11s %-11s %7s  %-15s %8s %8s  %-14s %s\n", "scene", "rays", "ratio",
               "95 % interval", "Mrays/s", "Embree", "our row", "Embree's mode");
        for (size_t i = 0; i < made; i++)
            print_line(&lines[i]);
    }
    rb_free(lines);
}

static void put_number(FILE *out, double value)
{
    if (isfinite(value))
        fprintf(out, ",%.6g", value);
    else
        fputc(',', out);
}

void rb_versus_write(FILE *out, const struct rb_contest *contests, size_t count)
{
    fputs("scene,rays,threads,row,embree_mode,mrays_ours,mrays_embree,ratio,ratio_lo,ratio_hi,"
          "build_ns_ours,build_ns_embree,bytes_per_primitive_ours,bytes_per_primitive_embree,"
          "rays_compared,rays_differ\n",
          out);
    for (size_t i = 0; i < count; i++) {
        if (!has_times(&contests[i]))
            continue;
        struct line line = make_line(&contests[i]);
        const double numbers[] = {line.mrays[0],    line.mrays[1],   line.ratio.value,
                                  line.ratio.low,   line.ratio.high, line.build_ns[0],
                                  line.build_ns[1], line.bytes[0],   line.bytes[1]};
        rb_csv_put_text(out, contests[i].scene);
        fprintf(out, ",%s,1,%s,%s", contests[i].rays_name, contests[i].side[0].row->name,
                rb_versus_mode(&contests[i]));
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
            put_number(out, numbers[n]);
        fprintf(out, ",%" PRIu64 ",%" PRIu64 "\n", line.compared, line.differ);
    }
}
