// The reader of samples and the comparison against small files written here, whole, mistaken and
// mutated.
#define _POSIX_C_SOURCE 200809L
#include "base/hash.h"
#include "base/memory.h"
#include "bench/compare/comparison.h"
#include "bench/compare/process_times.h"
#include "bench/data/names.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HEADER                                                                                     \
    "scene,width,height,depth,aa,light_samples,tile,variant,threads,process,repetition,kernel,"    \
    "bounce,rays,ns,wall_ns,image_hash\n"
#define CELL "balls,8,8,2,1,1,64,bvh,1,"

static char folder[] = "/tmp/rb_samples_XXXXXX";

static void write_file(const char *name, const char *text, size_t size)
{
    char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file || fwrite(text, 1, size, file) != size || fclose(file) != 0)
        exit(1);
}

static void remove_file(const char *name)
{
    char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    remove(path);
}

static enum rb_status load(const char *text, struct rb_timings *samples)
{
    struct rb_error error = {0};
    write_file("samples.csv", text, strlen(text));
    enum rb_status status = rb_timings_load(folder, samples, &error);
    if (status)
        note("%s:%lu:%lu: %s", error.file, error.line, error.column, error.text);
    return status;
}

static const char two_processes[] = HEADER
    // Out of order, one time not measured, one process without its second bounce.
    CELL "1,0,trace,0,64,50,,\n" CELL "0,1,trace,1,10,4,,\n" CELL "0,1,trace,0,64,40,,\n" CELL
         "0,0,trace,0,64,30,,\n" CELL "0,0,trace,1,0,,,\n" CELL "0,2,trace,0,64,,,\n" CELL
         "0,2,trace,1,10,5,,\n" CELL "0,0,frame,,74,900,1000,ff\n" CELL
         "0,1,frame,,74,900,1100,ff\n";

static void sums_over_bounces(void)
{
    struct rb_timings s;
    ok(load(two_processes, &s) == RB_OK && s.cell_count == 1 && !s.unfinished, "a run is read");
    struct rb_timing_range all = rb_timings_find(&s, 0, 2, RB_ALL_BOUNCES);
    ok(all.count == 2 && all.first[0].ns == 30 && all.first[1].ns == 44,
       "sums are of whole repetitions, and no rays take no time");
    struct rb_timing_range first = rb_timings_find(&s, 0, 2, 0);
    ok(first.count == 3 && first.first[2].process == 1 && first.first[2].ns == 50,
       "a bounce has what was measured of it");
    struct rb_timing_range frame = rb_timings_find(&s, 0, 0, RB_ALL_BOUNCES);
    ok(frame.count == 2 && frame.first[1].ns == 1100, "a frame has its wall time");
    ok(rb_timings_find(&s, 0, 3, RB_ALL_BOUNCES).count == 0 &&
           rb_timings_find(&s, 1, 0, 0).count == 0,
       "there is nothing else");
    ok(strcmp(s.cells[0].image_hash, "ff") == 0 && !s.cells[0].images_differ, "the image is known");
    rb_timings_free(&s);
    ok(load(HEADER CELL "0,0,frame,,9,1,1,ff\n" CELL "0,1,frame,,9,1,1,fe\n", &s) == RB_OK &&
           s.cells[0].images_differ,
       "an image that changes is noticed");
    rb_timings_free(&s);
}

static void unfinished(void)
{
    struct rb_timings s;
    struct rb_error error = {0};
    const char *cut = strstr(two_processes, "900,1100");
    remove_file("samples.csv");
    write_file("samples.csv.part", two_processes, (size_t)(cut - two_processes));
    ok(rb_timings_load(folder, &s, &error) == RB_OK && s.unfinished, "an unfinished run is read");
    // The last whole line is the frame of process 0, repetition 0.
    struct rb_timing_range all = rb_timings_find(&s, 0, 2, RB_ALL_BOUNCES);
    ok(all.count == 1 && all.first[0].repetition == 1 && rb_timings_find(&s, 0, 0, -1).count == 0,
       "but for its last repetition");
    rb_timings_free(&s);
    remove_file("samples.csv.part");
    ok(rb_timings_load(folder, &s, &error) == RB_INVALID, "no samples, no run");
    rb_timings_free(&s);
}

static void keys_in_order(void)
{
    const struct rb_timed_cell a = {.key = {"balls", "9", "8", "2", "1", "1", "64", "bvh", "1"}};
    struct rb_timed_cell b = a;
    ok(rb_cell_compare(&a, &b, 0) == 0, "a key is itself");
    b.key[RB_KEY_WIDTH] = "10";
    ok(rb_cell_compare(&a, &b, 0) < 0 && rb_cell_compare(&b, &a, 0) > 0, "9 comes before 10");
    ok(rb_cell_compare(&a, &b, 1u << RB_KEY_WIDTH) == 0, "but for a column that does not count");
    b.key[RB_KEY_WIDTH] = "1x";
    ok(rb_cell_compare(&a, &b, 0) < 0, "numbers come before words");
    ok(rb_names_match("a*,bvh", "bvh") && rb_names_match("a*", "abc") &&
           rb_names_match(NULL, "x") && !rb_names_match("a,b", "ab") && !rb_names_match("", "x"),
       "lists of names");
}

enum { ROOM = 1 << 16 };

// Appends `processes` processes of `repetitions` frames; the time is base + 10 process +
// (repetitions - 1 - repetition), so the last repetition is the fastest.
static void add_frames(char *text, const char *cell, int processes, int repetitions, int base)
{
    size_t used = strlen(text);
    for (int p = 0; p < processes; p++)
        for (int r = 0; r < repetitions && used < ROOM; r++)
            used += (size_t)snprintf(text + used, ROOM - used, "%s%d,%d,frame,,9,0,%d,\n", cell, p,
                                     r, base + 10 * p + repetitions - 1 - r);
}

static void times_of_processes(void)
{
    static char text[ROOM];
    struct rb_timings a, b;
    strcpy(text, HEADER);
    add_frames(text, CELL, 3, 20, 100);
    load(text, &a);
    strcpy(text, HEADER);
    add_frames(text, CELL, 5, 4, 100);
    load(text, &b);
    struct rb_process_times times;
    rb_process_times_make(&times, a.count, b.count);
    struct rb_timing_range ra = rb_timings_find(&a, 0, 0, -1), rb = rb_timings_find(&b, 0, 0, -1);
    // A's first four of twenty are 119 to 116, B's 103 to 100.
    rb_process_times_fill(&times, ra, rb, RB_TIME_QUANTILE, true);
    ok(times.counts[0] == 3 && times.counts[1] == 3 && times.times[0][2] == 136 &&
           times.times[1][2] == 120,
       "pairs of as many repetitions");
    rb_process_times_fill(&times, ra, rb, RB_TIME_QUANTILE, false);
    ok(times.counts[0] == 3 && times.counts[1] == 5 && times.times[0][0] == 116 &&
           times.times[1][4] == 140,
       "all processes, of as many repetitions");
    // Of twenty the second fastest: 101, 111, 121.
    rb_process_times_fill(&times, ra, ra, RB_TIME_QUANTILE, false);
    ok(times.counts[0] == 3 && times.times[0][1] == 111, "the tenth percentile");
    rb_process_times_free(&times);
    rb_timings_free(&a);
    rb_timings_free(&b);
}

// The same, and twice, and in pairs only if asked: verdicts by hand.
static void verdicts(void)
{
    static char text[ROOM];
    struct rb_timings a, b;
    strcpy(text, HEADER);
    add_frames(text, CELL, 8, 1, 1000);
    add_frames(text, "mount,8,8,2,1,1,64,bvh,1,", 8, 1, 1000);
    add_frames(text, "alone,8,8,2,1,1,64,bvh,1,", 8, 1, 1000);
    load(text, &a);
    strcpy(text, HEADER);
    add_frames(text, CELL, 8, 1, 500);
    add_frames(text, "mount,8,8,2,1,1,64,bvh,1,", 7, 1, 2000);
    load(text, &b);
    const struct rb_compare_side sides[2] = {{&a, NULL}, {&b, NULL}};
    struct rb_compare_options options = {.level = 0.98, .paired = true};
    struct rb_comparison c;
    struct rb_error error;
    ok(rb_comparison_make(sides, &options, &c, &error) == RB_OK && c.cell_count == 2 &&
           c.row_count == 2 && c.only_count[0] == 1 && c.only_count[1] == 0,
       "two runs are compared");
    ok(fabs(c.kernels.level - sqrt(0.98)) < 1e-15 && c.kernels.needed == 8 && c.bounces.rows == 0,
       "at the level of two rows");
    // b / a from 500 / 1000 to 570 / 1070.
    ok(c.rows[0].verdict == RB_VERDICT_FASTER && c.rows[0].ratio.low == 0.5 &&
           fabs(c.rows[0].ratio.high - 57.0 / 107) < 1e-15 && c.rows[0].a_ns == 1035,
       "one is faster");
    ok(c.rows[1].verdict == RB_VERDICT_TOO_FEW && c.rows[1].a_count == 7 &&
           fabs(c.rows[1].ratio.value - 2030.0 / 1030) < 1e-12,
       "the other lacks a process");
    size_t first = 0;
    struct rb_compare_mean mean;
    double expected = sqrt(c.rows[0].ratio.value * c.rows[1].ratio.value);
    ok(rb_comparison_next_mean(&c, &first, &mean) && mean.scenes == 2 &&
           fabs(mean.ratio - expected) < 1e-12 && !rb_comparison_next_mean(&c, &first, &mean),
       "their mean is geometric");
    rb_comparison_free(&c);
    options.level = 0.9;
    ok(rb_comparison_make(sides, &options, &c, &error) == RB_OK &&
           c.rows[1].verdict == RB_VERDICT_SLOWER,
       "at a lower level it is slower");
    rb_comparison_free(&c);
    const struct rb_compare_side alike[2] = {{&a, NULL}, {&a, NULL}};
    rb_comparison_make(alike, &options, &c, &error);
    ok(c.row_count == 3 && c.rows[0].verdict == RB_VERDICT_UNRESOLVED, "a run is like itself");
    rb_comparison_free(&c);
    rb_timings_free(&a);
    rb_timings_free(&b);
}

// No memory at any point, nothing left behind.
static void without_memory(void)
{
    long before = rb_memory_live_count(), failures = 0;
    enum rb_status status = RB_FAILED;
    write_file("samples.csv", two_processes, strlen(two_processes));
    for (long n = 1; status == RB_FAILED && n < 1000; n++, failures++) {
        struct rb_timings s;
        struct rb_comparison c = {0};
        struct rb_error error = {0};
        const struct rb_compare_side sides[2] = {{&s, NULL}, {&s, NULL}};
        const struct rb_compare_options options = {.level = 0.9, .bounces = true, .paired = n % 2};
        rb_memory_fail_at(n);
        status = rb_timings_load(folder, &s, &error);
        if (!status)
            status = rb_comparison_make(sides, &options, &c, &error);
        rb_memory_fail_at(0);
        rb_comparison_free(&c);
        rb_timings_free(&s);
    }
    note("%ld points of failure", failures);
    ok(status == RB_OK && failures > 10 && rb_memory_live_count() == before,
       "without memory it fails and leaves nothing");
}

// Whatever the bytes, an answer: of a file, of a file cut short, and of both against another.
static void mutated(void)
{
    char text[sizeof two_processes];
    struct rb_timings good;
    uint64_t state = 4;
    long refused = 0;
    load(two_processes, &good);
    for (int i = 0; i < 4000; i++) {
        memcpy(text, two_processes, sizeof text);
        size_t size = sizeof text - 1;
        for (int changes = 0; changes < 1 + i % 4; changes++) {
            state = rb_hash_word(state, 1);
            char byte = "0123456789,\"\n\r-x\0e.\xff"[state >> 32 & 15];
            text[(i % 2 ? sizeof HEADER : 0) + (state & 0xffff) % (size - sizeof HEADER)] = byte;
        }
        const char *name = i % 3 ? "samples.csv" : "samples.csv.part";
        write_file(name, text, i % 3 ? size : state % size);
        struct rb_timings s;
        struct rb_comparison c = {0};
        struct rb_error error = {0};
        const struct rb_compare_side sides[2] = {{&good, NULL}, {&s, NULL}};
        const struct rb_compare_options options = {.level = 0.9, .bounces = true, .paired = i % 5};
        enum rb_status status = rb_timings_load(folder, &s, &error);
        if (!status)
            status = rb_comparison_make(sides, &options, &c, &error);
        refused += status == RB_INVALID && error.file[0] && error.line && error.text[0];
        if (status == RB_FAILED)
            ok(false, "mutation %d: %s", i, error.text);
        rb_comparison_free(&c);
        rb_timings_free(&s);
        remove_file(name);
    }
    rb_timings_free(&good);
    ok(refused > 500 && refused < 4000, "mutated files: %ld of 4000 refused", refused);
}

int main(void)
{
    if (!mkdtemp(folder))
        return 1;
    sums_over_bounces();
    unfinished();
    keys_in_order();
    times_of_processes();
    verdicts();
    without_memory();
    mutated();
    remove_file("samples.csv");
    rmdir(folder);
    return done();
}
