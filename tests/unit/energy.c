// The meter on made-up machines: trees of powercap files, and a made-up kernel for the PMU power;
// figures of energy, and the models.
#define _GNU_SOURCE
#include "bench/energy/energy.h"
#include "bench/energy/model.h"
#include "measure/perf_event.h"
#include "tests/support/tree.h"
#include "tests/unit/tap.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CAP "/sys/class/powercap/"

static char root[] = "/tmp/raybench-energy-XXXXXX";
static struct rb_meter meter;

static void put_zone(const char *zone, const char *name, const char *energy_uj, const char *range)
{
    char path[128];
    snprintf(path, sizeof path, CAP "%s/name", zone);
    tree_put(root, path, name);
    snprintf(path, sizeof path, CAP "%s/max_energy_range_uj", zone);
    tree_put(root, path, range);
    snprintf(path, sizeof path, CAP "%s/energy_uj", zone);
    if (energy_uj)
        tree_put(root, path, energy_uj);
}

static void set_energy(const char *zone, const char *energy_uj)
{
    char path[128];
    snprintf(path, sizeof path, CAP "%s/energy_uj", zone);
    tree_put(root, path, energy_uj);
}

static double joules(void)
{
    double value;
    struct rb_error error = {0};
    return rb_meter_read(&meter, &value, &error) == RB_OK ? value : (double)NAN;
}

static void refuses(const char *what, const char *word)
{
    struct rb_error error = {0};
    if (!ok(rb_meter_open(&meter, root, &error) == RB_FAILED && strstr(error.text, word), "%s: %s",
            what, word))
        note("%s", error.text);
}

static void powercap(void)
{
    struct rb_error error = {0};
    char text[64];
    refuses("an empty machine", "no zone in");
    put_zone("intel-rapl:0", "package-0\n", "1000000\n", "262143999938\n");
    put_zone("intel-rapl:0:0", "core\n", "500000\n", "262143999938\n");
    ok(rb_meter_open(&meter, root, &error) == RB_OK, "one package");
    set_energy("intel-rapl:0", "3500000\n");
    set_energy("intel-rapl:0:0", "900000\n");
    ok(fabs(joules() - 2.5) < 1e-9, "2.5 J, and its cores are a part of it");
    rb_meter_describe(&meter, text);
    ok(strcmp(text, "rapl:powercap package") == 0, "%s", text);
    set_energy("intel-rapl:0", "262143999000\n");
    joules();
    set_energy("intel-rapl:0", "999062\n"); // 938 to the end, and on from 0
    ok(fabs(joules() - (262143.999000 - 1 + 0.000938 + 0.999062)) < 1e-6, "across a wrap");
    set_energy("intel-rapl:0", "what\n");
    ok(isnan(joules()), "a counter that is none any more");

    put_zone("intel-rapl:0", "package-0\n", "0\n", "1000\n");
    put_zone("intel-rapl:0:1", "dram\n", "0\n", "1000\n");
    put_zone("intel-rapl:1", "package-1\n", "0\n", "1000\n");
    put_zone("intel-rapl:2", "psys\n", "0\n", "1000\n");
    ok(rb_meter_open(&meter, root, &error) == RB_OK, "two sockets");
    set_energy("intel-rapl:0", "100\n");
    set_energy("intel-rapl:0:1", "20\n");
    set_energy("intel-rapl:1", "3\n");
    set_energy("intel-rapl:2", "777\n");
    ok(fabs(joules() - 123e-6) < 1e-12, "both packages and the memory, not the whole system");
    rb_meter_describe(&meter, text);
    ok(strcmp(text, "rapl:powercap package+dram") == 0, "%s", text);

    tree_remove(root);
    put_zone("intel-rapl:0", "package-0\n", NULL, "1000\n");
    refuses("a missing counter", "chmod a+r");
    tree_put(root, CAP "intel-rapl:0/energy_uj/", ""); // root may read any file, but no folder
    refuses("a counter that cannot be read", "not readable");
    tree_remove(root);
    put_zone("intel-rapl:0:0", "dram\n", "1\n", "1000\n");
    refuses("memory without a package", "no energy");

    tree_remove(root);
    put_zone("intel-rapl:0", "package-0\n", "5\n", "1000\n");
    double watts;
    ok(rb_meter_open(&meter, root, &error) == RB_OK &&
           rb_energy_idle(&meter, 0.01, &watts, &error) == RB_FAILED &&
           strstr(error.text, "stand still"),
       "a counter that stands still: %s", error.text);
    tree_remove(root);
}

// A made-up kernel for the PMU power. On this machine there is none, so that its files are missing:
// what perf_event_open says cannot be asked; but a copy of a machine must not ask at all.
static int asked;

static int fake_open(struct perf_event_attr *attributes, int pid, int cpu, int group)
{
    (void)attributes, (void)pid, (void)cpu, (void)group;
    asked++;
    errno = EACCES;
    return -1;
}

static void perf(void)
{
    struct rb_perf_system fake = rb_perf_kernel;
    struct rb_error error = {0};
    fake.open = fake_open;
    rb_perf = &fake;
    put_zone("intel-rapl:0", "package-0\n", "5\n", "1000\n");
    ok(rb_meter_open(&meter, root, &error) == RB_OK && asked == 0 && !meter.perf,
       "no system call for a copy of a machine");
    tree_remove(root);
    bool power = access("/sys/bus/event_source/devices/power/events/energy-pkg", F_OK) == 0;
    enum rb_status status = rb_meter_open(&meter, "", &error);
    ok(status == RB_OK || strstr(error.text, power ? "forbidden" : "no energy-pkg"),
       "this machine, where perf is forbidden: %s", status ? error.text : "powercap");
    rb_meter_close(&meter);
    rb_perf = &rb_perf_kernel;
}

// 30 J in 2 s on 1e6 rays, and an idle machine of 9 and 11 W: 10 J net.
static void figures(void)
{
    const struct rb_energy energy = {.idle_before_w = 9, .idle_after_w = 11};
    struct rb_energy_span span = {.joules = 30, .seconds = 2, .units = 1e6};
    struct rb_energy_figures f = rb_energy_figures(&energy, &span);
    ok(fabs(f.gross - 30e-6) < 1e-12 && fabs(f.net - 10e-6) < 1e-12 &&
           fabs(f.seconds - 2e-6) < 1e-12,
       "gross and net");
    span.joules = 20;
    f = rb_energy_figures(&energy, &span);
    ok(fabs(f.gross - 20e-6) < 1e-12 && isnan(f.net), "not above the idle machine: never 0 J");
    span.joules = 0;
    ok(isnan(rb_energy_figures(&energy, &span).gross), "0 J was not measured");
}

static void models(void)
{
    struct rb_simulated_place place = {.rays = 2, .laps = 1};
    struct rb_energy_model model;
    struct rb_error error = {0};
    char path[64], text[640];
    place.events[RB_SIM_IR] = 200;
    place.events[RB_SIM_DR] = 30;
    place.events[RB_SIM_DW] = 10;
    place.events[RB_SIM_D1MR] = 4;
    place.events[RB_SIM_DLMR] = 1;
    place.events[RB_SIM_ILMR] = 1;
    // A ray: 100 instructions, 20 accesses, 2 misses of L1, 1 of the last level.
    ok(rb_energy_model_read("horowitz14-45nm", &model, &error) == RB_OK &&
           fabs(rb_energy_model_joules(&model, &place) - 1e-12 * (7000 + 400 + 1600 + 15600)) <
               1e-18,
       "45 nm, worked out by hand");
    rb_energy_model_describe(&model, text);
    ok(strstr(text, "model:horowitz14-45nm") && strstr(text, "ratios only"), "%s", text);
    ok(rb_energy_model_read("jouppi21-7nm", &model, &error) == RB_OK &&
           fabs(rb_energy_model_joules(&model, &place) - 1e-12 * (3000 + 170 + 224 + 10400)) <
               1e-18,
       "7 nm");
    place.rays = 0;
    ok(isnan(rb_energy_model_joules(&model, &place)), "nothing of nothing");
    ok(rb_energy_model_read("none", &model, &error) == RB_INVALID && strstr(error.text, "jouppi"),
       "no such model");
    tree_put(root, "/m.energy", "name A\nnode 1 nm\nsource B\nvalue pj = 2 * cycles\n");
    snprintf(path, sizeof path, "%s/m.energy", root);
    ok(rb_energy_model_read(path, &model, &error) == RB_INVALID && error.line == 4 &&
           error.column == 16,
       "a value that no simulator gives");
    tree_put(root, "/m.energy", "name A\nsource B\nvalue pj = 1\n");
    error = (struct rb_error){.line = 0};
    ok(rb_energy_model_read(path, &model, &error) == RB_INVALID && strstr(error.text, "node"),
       "a model without its process node");
}

int main(void)
{
    if (!mkdtemp(root))
        return 1;
    powercap();
    perf();
    figures();
    models();
    tree_remove(root);
    return done();
}
