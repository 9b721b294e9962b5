#include "bench/versus/versus.h"

#include "bench/data/csv_write.h"
#include "bench/machine/peaks.h"
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
    double speed_up[2];        // over one thread
    double least_ns;           // per ray, with all threads
    struct rb_median ratio;    // ours over Embree's, in rays per second
    uint64_t compared, differ; // answers of Embree's
};

// ns per ray of each process of a side; NULL without memory.
static double *times_of(const struct rb_contest *contest, int side, size_t *count)
{
    const struct rb_cell *cell = &contest->side[side].cell;
    const struct rb_record_choice *rays = &contest->rays->rays;
    double *times = rb_alloc(cell->sample_count, sizeof *times);
    *count = times ? rb_cell_process_wall_p10(cell, rays->kernel, rays->bounce, times) : 0;
    return times;
}

// Pairs of processes; fewer where it was stopped.
static struct rb_median paired_ratio(double *const times[2], const size_t count[2])
{
    return rb_stats_paired_ratio(times[0], times[1], count[0] < count[1] ? count[0] : count[1],
                                 LEVEL);
}

// Of a side over itself with one thread, in rays per second.
static double speed_up(const struct rb_contest *contest, int side)
{
    size_t count[2] = {0, 0};
    double *times[2] = {times_of(contest, side, &count[0]), NULL};
    if (contest->single)
        times[1] = times_of(contest->single, side, &count[1]);
    double value = paired_ratio(times, count).value;
    rb_free(times[0]);
    rb_free(times[1]);
    return value;
}

static struct line make_line(const struct rb_contest *contest, double cycles_per_ns)
{
    struct line line = {.contest = contest};
    double cycles = rb_versus_least_cycles(&contest->tests);
    line.least_ns = cycles / cycles_per_ns / contest->threads;
    const struct rb_cell *embree = &contest->side[1].cell;
    size_t count[2];
    double *times[2];
    for (int side = 0; side < 2; side++)
        times[side] = times_of(contest, side, &count[side]);
    line.ratio = paired_ratio(times, count);
    for (int side = 0; side < 2; side++) {
        line.mrays[side] = 1e3 / rb_stats_median_at(times[side], count[side], LEVEL).value;
        line.speed_up[side] = speed_up(contest, side);
        rb_free(times[side]);
    }
    for (size_t i = 0; i < embree->sample_count; i++)
        if (embree->samples[i].repetition == 0) {
            line.compared += embree->samples[i].compared;
            line.differ += embree->samples[i].differ;
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

static const char *format_interval(const struct rb_median *ratio, char text[32])
{
    snprintf(text, 32, isfinite(ratio->low) ? "%.2f to %.2f" : "-", ratio->low, ratio->high);
    return text;
}

static void print_line(const struct line *line)
{
    const struct rb_contest *contest = line->contest;
    char interval[32], speed_ups[32] = "-";
    if (contest->single)
        snprintf(speed_ups, sizeof speed_ups, "%.2f %.2f", line->speed_up[0], line->speed_up[1]);
    printf("  %-11s %-11s %7d %7.2f  %-15s %8.2f %8.2f  %-11s %-14s %s\n", contest->scene,
           contest->rays_name, contest->threads, line->ratio.value,
           format_interval(&line->ratio, interval), line->mrays[0], line->mrays[1], speed_ups,
           contest->side[0].row->name, rb_versus_mode(contest));
}

// The trees, and wrong answers to all classes of rays.
static void print_trees(const struct line *lines, size_t count)
{
    const struct rb_contest *first = lines[0].contest;
    const struct rb_versus_trees *trees = first->trees;
    uint64_t compared = 0, differ = 0;
    char interval[32];
    for (size_t i = 0; i < count; i++) {
        compared += lines[i].compared;
        differ += lines[i].differ;
    }
    printf("  %-11s %7d %9.1f ms %9.1f ms %7.2f  %-15s %9.1f %8.1f %4.0f %% %4.0f %%   %" PRIu64
           " of %" PRIu64 " rays\n",
           first->scene, trees->threads, trees->build_ns[0] * 1e-6, trees->build_ns[1] * 1e-6,
           trees->ratio.value, format_interval(&trees->ratio, interval),
           (double)trees->bytes[0] / first->primitive_count,
           (double)trees->bytes[1] / first->primitive_count, trees->huge_pct[0], trees->huge_pct[1],
           differ, compared);
}

// What is left to gain, where one thread works.
static void print_bound(const struct line *line)
{
    const struct rb_contest *contest = line->contest;
    const struct rb_versus_tests *tests = &contest->tests;
    if (contest->single)
        return;
    printf("  %-11s %-11s %8.2f %8.2f %8.2f %8.2f %9.2f %9.2f %8.1f %8.1f\n", contest->scene,
           contest->rays_name, tests->nodes, tests->spheres, tests->triangles, tests->planes,
           line->least_ns, 1e3 / line->mrays[0], 1e3 / line->mrays[0] / line->least_ns,
           1e3 / line->mrays[1] / line->least_ns);
}

void rb_versus_print(const struct rb_contest *contests, size_t count)
{
    struct line *lines = rb_alloc(count, sizeof *lines);
    size_t made = 0;
    double cycles_per_ns = rb_peak_cycles_per_ns();
    for (size_t i = 0; lines && i < count; i++)
        if (has_times(&contests[i]))
            lines[made++] = make_line(&contests[i], cycles_per_ns);
    if (made) {
        printf("\n  trees: ours of 8 children, and of Embree %s, medium quality\n",
               rb_embree_version());
        printf("  %-11s %7s %12s %12s %7s  %-15s %9s %8s %-13s   %s\n", "scene", "threads",
               "our build", "Embree's", "ratio", "95 % interval", "bytes/pr.", "Embree's",
               "huge pages", "answers of Embree's that differ");
        for (size_t first = 0, end = 0; first < made; first = end) {
            while (end < made && lines[end].contest->trees == lines[first].contest->trees)
                end++;
            print_trees(&lines[first], end - first);
        }
        printf("\n  the bound: tests a ray needs, one at a time, in a tree of 8 children, and the "
               "least they take at %.2f GHz\n",
               cycles_per_ns);
        printf("  %-11s %-11s %8s %8s %8s %8s %9s %9s %8s %8s\n", "scene", "rays", "nodes",
               "spheres", "triang.", "planes", "least ns", "our ns", "x least", "Embree's");
        for (size_t i = 0; i < made; i++)
            print_bound(&lines[i]);
        qsort(lines, made, sizeof *lines, by_ratio);
        printf("\n  %-11s %-11s %7s %7s  %-15s %8s %8s  %-11s %-14s %s\n", "scene", "rays",
               "threads", "ratio", "95 % interval", "Mrays/s", "Embree", "x 1 thread", "our row",
               "Embree's mode");
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
          "rays_compared,rays_differ,speed_up_ours,speed_up_embree,huge_pct_ours,"
          "huge_pct_embree,nodes_per_ray,sphere_blocks_per_ray,triangle_blocks_per_ray,"
          "planes_per_ray,least_ns_per_ray\n",
          out);
    double cycles_per_ns = rb_peak_cycles_per_ns();
    for (size_t i = 0; i < count; i++) {
        const struct rb_contest *contest = &contests[i];
        const struct rb_versus_trees *trees = contest->trees;
        if (!has_times(contest))
            continue;
        struct line line = make_line(contest, cycles_per_ns);
        const double numbers[] = {line.mrays[0],
                                  line.mrays[1],
                                  line.ratio.value,
                                  line.ratio.low,
                                  line.ratio.high,
                                  trees->build_ns[0],
                                  trees->build_ns[1],
                                  (double)trees->bytes[0] / contest->primitive_count,
                                  (double)trees->bytes[1] / contest->primitive_count,
                                  (double)line.compared,
                                  (double)line.differ,
                                  line.speed_up[0],
                                  line.speed_up[1],
                                  trees->huge_pct[0],
                                  trees->huge_pct[1],
                                  contest->tests.nodes,
                                  contest->tests.spheres,
                                  contest->tests.triangles,
                                  contest->tests.planes,
                                  line.least_ns};
        rb_csv_put_text(out, contest->scene);
        fprintf(out, ",%s,%d,%s,%s", contest->rays_name, contest->threads,
                contest->side[0].row->name, rb_versus_mode(contest));
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
            put_number(out, numbers[n]);
        fputc('\n', out);
    }
}
