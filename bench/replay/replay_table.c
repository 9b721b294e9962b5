#include "bench/replay/replay.h"

#include "bench/run/process.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double LEVEL = 0.95;

// Why a kernel alone and in place differ. Measured on a Zen 4 with 1 MiB of second-level cache per
// core, p10 of 6 processes: trace of 262144 camera rays of balls_high by packet-avx512 1.00 to 1.03
// x in place; generate there 0.7 x, shade 0.97 x; trace of bounce 1 of mount_low by bvh 0.80 x at
// 2128 rays, 0.94 x at 8510, 1.02 x at 33998, 0.98 x at 135986.
static const char notes[] =
    "\n"
    "  in place: p10 of the same kernel in whole frames, in turn with these processes; x in "
    "place:\n"
    "  the p10 of each process over that of the frames of its round. Below 1 where a kernel alone\n"
    "  keeps in the cache what in place other kernels push out of it (the queues that generate "
    "and\n"
    "  shade write), and where so few rays come again and again that the branch predictor learns\n"
    "  them (some thousands: small images, late bounces). That the rays come from memory and not\n"
    "  from a warm queue costs little: they are read in order.\n";

// Four digits, but no exponent; - for what there is not.
static const char *format(double value, char text[24])
{
    if (isfinite(value))
        snprintf(text, 24, value >= 1000 ? "%.0f" : "%.4g", value);
    else
        snprintf(text, 24, "-");
    return text;
}

static const char *format_interval(double low, double high, char text[64])
{
    char from[24], to[24];
    if (isfinite(low))
        snprintf(text, 64, "%s to %s", format(low, from), format(high, to));
    else
        snprintf(text, 64, "-");
    return text;
}

// Replay over frames, process by process: the low quantiles of neighbours in time.
static struct rb_median ratio_of(const struct rb_replay_unit *unit, const struct rb_cell *frames)
{
    struct rb_median ratio = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};
    size_t here = unit->cell.sample_count, there = frames->sample_count;
    double *alone = rb_alloc(here + there, sizeof *alone);
    if (!alone)
        return ratio;
    double *in_place = alone + here;
    enum rb_stage kernel = unit->choice.kernel;
    int bounce = unit->choice.bounce;
    size_t count = rb_cell_process_p10(&unit->cell, kernel, bounce, alone);
    size_t frame_count = rb_cell_process_p10(frames, kernel, bounce, in_place);
    count = count < frame_count ? count : frame_count; // fewer where it was stopped
    if (count && unit->choice.ray_class == RB_CLASS_IMAGE)
        ratio = rb_stats_paired_ratio(in_place, alone, count, LEVEL);
    rb_free(alone);
    return ratio;
}

static void print_unit(const struct rb_replay_run *run, const struct rb_replay_unit *unit)
{
    char value[24], min[24], p10[24], rate[24], interval[64], frame[24], times[24], spread[64];
    char flags[128];
    enum rb_stage kernel = unit->choice.kernel;
    int bounce = unit->choice.bounce;
    printf("  %-10s %-12s %6d %9" PRIu64, rb_ray_class_names[unit->choice.ray_class],
           rb_stage_names[kernel], bounce, unit->rays);
    if (!rb_cell_has_time(&unit->cell)) {
        printf(" %9s  %s\n", "-",
               unit->cell.state == RB_CELL_INVALID ? "invalid: differs from the record"
                                                   : rb_cell_note(&unit->cell));
        return;
    }
    struct rb_figure figure = rb_cell_ns_per_ray(&unit->cell, kernel, bounce);
    struct rb_median ratio = ratio_of(unit, &run->in_place);
    double in_place = unit->choice.ray_class == RB_CLASS_IMAGE
                          ? rb_cell_ns_per_ray(&run->in_place, kernel, bounce).p10
                          : (double)NAN;
    rb_cell_flags(&unit->cell, rb_process_interrupted(), run->probe_ns, flags);
    bool sampled = unit->cell.samples[0].stage[kernel][bounce].rays < unit->rays;
    printf(" %9s  %-18s %7s %7s %8s %2zu  %8s  %6s %-16s %s%s%s", format(figure.value, value),
           format_interval(figure.low, figure.high, interval), format(figure.min, min),
           format(figure.p10, p10), format(1e3 / figure.value, rate), figure.n,
           format(in_place, frame), format(ratio.value, times),
           format_interval(ratio.low, ratio.high, spread), sampled ? "estimated" : "",
           sampled && flags[0] ? ";" : "", flags);
    const struct rb_sample *first = &unit->cell.samples[0];
    if (first->compared)
        printf(" %" PRIu64 " of %" PRIu64 " rays differ from the record", first->differ,
               first->compared);
    printf("\n");
}

void rb_replay_print_head(const struct rb_replay_run *run)
{
    const struct rb_record_header *header = &run->record.header;
    printf("%s: %d x %d, depth %d, %" PRIu32 " primitives; recorded by %s, replayed by %s\n",
           header->scene, header->settings.width, header->settings.height, header->settings.depth,
           run->reference.primitive_count, header->row, run->in_place.variant->name);
    fflush(stdout);
}

void rb_replay_print(const struct rb_replay_run *run)
{
    printf("\n  %-10s %-12s %6s %9s %9s  %-18s %7s %7s %8s %2s  %8s  %-23s %s\n", "class", "kernel",
           "bounce", "rays", "ns/ray", "95 % interval", "min", "p10", "Mrays/s", "n", "in place",
           "x in place", "flags");
    for (int i = 0; i < run->unit_count; i++)
        print_unit(run, &run->units[i]);
    if (run->frames_wanted)
        fputs(notes, stdout);
}
