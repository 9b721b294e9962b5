// From counters to columns: frames with a made-up kernel behind perf_event_open, whose every
// reading of a group is known; and the columns of cells that were counted by it.
#define _POSIX_C_SOURCE 200809L
#include "bench/run/columns.h"
#include "measure/perf_event.h"
#include "render/renderer.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { STEP = 1000 };

// Every thread has counters of its own: a reading is STEP more than the last one, of every event.
static _Thread_local uint64_t now, events_open;
static atomic_ulong readings, opened, closed;

static int fake_open(struct perf_event_attr *attributes, int pid, int cpu, int group)
{
    (void)attributes, (void)pid, (void)cpu, (void)group;
    atomic_fetch_add(&opened, 1);
    return 100 + (int)events_open++;
}

static int fake_enable(int fd)
{
    return fd == 100 ? 0 : -1;
}

static long fake_read(int fd, void *to, size_t bytes)
{
    uint64_t *words = to;
    (void)fd;
    now += STEP;
    atomic_fetch_add(&readings, 1);
    words[0] = events_open;
    words[1] = words[2] = now;
    for (size_t i = 3; i < bytes / 8; i++)
        words[i] = now;
    return (long)bytes;
}

static const void *fake_map(int fd)
{
    (void)fd;
    return NULL;
}

static void fake_unmap(const void *page)
{
    (void)page;
}

static uint64_t fake_counter(uint32_t counter)
{
    return counter;
}

static void fake_close(int fd)
{
    (void)fd;
    events_open = 0;
    atomic_fetch_add(&closed, 1);
}

static const struct rb_perf_system fake = {fake_open,  fake_enable,  fake_read, fake_map,
                                           fake_unmap, fake_counter, fake_close};

static struct rb_event_table table; // too large for the stack, as others here

// Each lap of a frame reads the group once, so the counts of all stages are STEP times the laps.
static void frames(const char *row, const struct rb_scene *scene)
{
    struct rb_settings settings = {.width = 64, .height = 64, .tile = 16, .threads = 2};
    struct rb_event_group group = {.count = 2};
    struct rb_renderer *renderer;
    struct rb_run_result with, without;
    struct rb_error error = {0};
    const struct rb_variant *variant = rb_variant_find(row);
    if (!rb_variant_available(variant)) {
        ok(true, "%s # SKIP not available", row);
        return;
    }
    if (rb_renderer_create(scene, variant, &settings, &renderer, &error)) {
        ok(false, "%s: %s", row, error.text);
        return;
    }
    rb_renderer_run(renderer, NULL, &without);
    memset(&table, 0, sizeof table);
    const struct rb_run_options how = {.events = &table, .event_group = &group};
    atomic_store(&opened, 0);
    atomic_store(&closed, 0);
    rb_renderer_run(renderer, &how, &with);
    rb_renderer_free(renderer);
    uint64_t count = 0, laps = 0, calls = 0;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            count += table.count[stage][bounce][1];
            laps += table.laps[stage][bounce];
            calls += with.recorder.tally[stage][bounce].calls;
        }
    ok(with.image_hash == without.image_hash, "%s: the image is the same", row);
    ok(laps > 0 && laps == calls && count == STEP * laps, "%s: nothing is lost between %d laps",
       row, (int)laps);
    ok(table.state[0] == RB_EVENT_COUNTED && table.empty[1] == STEP,
       "%s: and an empty lap counts what a reading does", row);
    ok(atomic_load(&opened) == 2 * (unsigned long)with.thread_count &&
           atomic_load(&closed) == atomic_load(&opened),
       "%s: a group for each of %d threads, opened and closed by it", row, with.thread_count);
}

static struct rb_hardware hardware;
static struct rb_simulated simulated;
static struct rb_energy energy;
static struct rb_reference reference = {.scene_name = "s", .frame = {.threads = 1}};

// The column as a file would have it.
static const char *field(const struct rb_column *columns, const struct rb_line *line,
                         const char *name)
{
    static char text[512];
    char *csv = NULL;
    size_t size;
    struct rb_column one[2] = {{.name = NULL}, {.name = NULL}};
    for (const struct rb_column *c = columns; c->name; c++)
        if (strcmp(c->name, name) == 0)
            one[0] = *c;
    FILE *out = open_memstream(&csv, &size);
    rb_columns_csv_row(out, one, line);
    fclose(out);
    snprintf(text, sizeof text, "%.*s", (int)strcspn(csv, "\r"), csv);
    free(csv);
    return text;
}

static double number(const struct rb_line *line, const char *name)
{
    const char *text = field(rb_kernel_columns, line, name);
    return *text ? strtod(text, NULL) : (double)NAN;
}

// 100 rays; per ray 1000 cycles of Zen 4 and what tests/unit/event_file.c works out by hand.
static void columns(void)
{
    static struct rb_event_file file;
    static const struct {
        const char *name;
        uint64_t per_ray;
    } counts[] = {{"cycles", 1000},      {"dispatched", 3300}, {"retired", 3000},
                  {"no_frontend", 1200}, {"no_backend", 1200}, {"no_smt", 300},
                  {"wait_load", 300},    {"wait_any", 400},    {"instructions", 2500}};
    struct rb_error error = {0};
    struct rb_sample_stage stage = {.ns = 30000, .rays = 100, .calls = 1};
    struct rb_cell cell = {.variant = rb_variant_find("bvh"), .reference = &reference};
    struct rb_line line = {.cell = &cell, .stage = RB_STAGE_TRACE, .bounce = 2, .counts = &stage};
    line.per_ray.value = 300;
    struct rb_hardware_place *place = &hardware.place[RB_STAGE_TRACE][2];
    ok(rb_event_file_choose("", "amd-zen4", &file, &error) == RB_OK, "events of Zen 4");
    cell.hardware = &hardware;
    cell.simulated = &simulated;
    hardware.file = &file;
    simulated.place[RB_STAGE_TRACE][2] =
        (struct rb_simulated_place){.rays = 10, .laps = 1, .events = {[RB_SIM_IR] = 700}};
    for (int g = 0; g < 2; g++) {
        place->rays[g] = 100;
        place->laps[g] = 1;
        place->ns[g] = 30000;
    }
    for (int i = 0; i < file.event_count; i++)
        hardware.state[i] = RB_EVENT_COUNTED;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        place->count[rb_values_find(&file.values, counts[i].name)] = 100 * counts[i].per_ray;
    ok(number(&line, "cycles_per_ray") == 1000 && number(&line, "instructions_per_ray") == 2500 &&
           strcmp(field(rb_kernel_columns, &line, "counter_source"), "pmu") == 0,
       "counters go before what was simulated");
    double shares[] = {number(&line, "compute_pct"), number(&line, "compute_stall_pct"),
                       number(&line, "memory_stall_pct"), number(&line, "other_pct")};
    ok(shares[0] == 50 && shares[1] == 5 && shares[2] == 15 && shares[3] == 30 &&
           number(&line, "category_sum_pct") == 100,
       "the four categories");
    double ns = (shares[0] + shares[1] + shares[2] + shares[3]) / 100 * 300;
    ok(fabs(ns / 300 - 1) < 0.01, "they add up to the time of the kernel within 1 %%");
    ok(strcmp(field(rb_kernel_columns, &line, "category_source"), "pmu:amd-zen4 (unverified)") == 0,
       "whose file nobody has verified");
    hardware.lap_ns[0] = 400;
    ok(number(&line, "instructions_per_ray") == 70 && isnan(number(&line, "cycles_per_ray")) &&
           strcmp(field(rb_kernel_columns, &line, "counter_source"), "sim") == 0 &&
           strcmp(field(rb_kernel_columns, &line, "category_source"), "model:callgrind") == 0 &&
           strstr(field(rb_kernel_columns, &line, "hardware_note"), "1.33 %"),
       "where reading them costs too much, the simulator has its say: %s",
       field(rb_kernel_columns, &line, "hardware_note"));

    static struct rb_energy_model model;
    ok(rb_energy_model_read("horowitz14-45nm", &model, &error) == RB_OK, "a model of energy");
    cell.energy_model = &model;
    ok(fabs(number(&line, "nj_per_ray") - 4.9) < 1e-6 && // 70 instructions of 70 pJ
           isnan(number(&line, "gross_nj_per_ray")) &&
           strcmp(field(rb_kernel_columns, &line, "energy_source"), "model:horowitz14-45nm") == 0,
       "modelled energy says so");
    cell.energy = &energy;
    snprintf(energy.source, sizeof energy.source, "rapl:perf package");
    energy.idle_before_w = energy.idle_after_w = 10;
    energy.place[RB_STAGE_TRACE][2] = (struct rb_energy_span){30, 2, 1e9};
    energy.frames = (struct rb_energy_span){50, 2, 10};
    ok(fabs(number(&line, "nj_per_ray") - 10) < 1e-9 &&
           fabs(number(&line, "gross_nj_per_ray") - 30) < 1e-9 &&
           strcmp(field(rb_kernel_columns, &line, "energy_source"), "rapl:perf package") == 0,
       "and what was measured goes before it");
    ok(strcmp(field(rb_frame_columns, &line, "frame_j"), "3") == 0 &&
           strcmp(field(rb_frame_columns, &line, "edp_js"), "0.6") == 0,
       "joules a frame, and times its seconds");
}

int main(void)
{
    struct rb_scene scene;
    struct rb_error error = {0};
    const struct rb_nff_options options = {0};
    rb_perf = &fake;
    if (rb_scene_load("balls_low", &options, &scene, &error))
        return 1;
    frames("bvh", &scene);
    frames("bvh+omp", &scene);
    rb_scene_free(&scene);
    columns();
    return done();
}
