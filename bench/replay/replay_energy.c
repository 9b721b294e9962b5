// `raybench replay --energy`: the energy of kernels alone.
#include "bench/replay/replay_evidence.h"
#include "bench/run/energy_cell.h"
#include "cli/commands.h"

#include <math.h>
#include <stdio.h>

static enum rb_status measure_unit(const struct rb_replay_run *run,
                                   const struct rb_replay_unit *unit,
                                   const struct rb_arguments *arguments,
                                   struct rb_energy_span *span, struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    rb_replay_unit_words(run, unit, &words);
    rb_worker_word(&words, "--energy");
    rb_worker_word(&words, "--slice=%g", arguments->budget_s);
    rb_worker_word(&words, "--cpu=-1");
    rb_worker_word(&words, "--");
    rb_worker_word(&words, "%s", run->path);
    return rb_energy_run(&words, false, span, error);
}

static void put(double value, double scale)
{
    if (isfinite(value))
        printf(" %12.4g", scale * value);
    else
        printf(" %12s", "-");
}

static void print(const struct rb_replay_run *run, const struct rb_energy *energy,
                  const struct rb_energy_span *spans)
{
    printf("\n  %-10s %-12s %6s %9s %12s %12s %12s %12s\n", "class", "kernel", "bounce", "rays",
           "nJ/ray net", "nJ/ray gross", "ns/ray", "net nJ x ns");
    for (int i = 0; i < run->unit_count; i++) {
        const struct rb_replay_unit *unit = &run->units[i];
        struct rb_energy_figures f = rb_energy_figures(energy, &spans[i]);
        printf("  %-10s %-12s %6d %9.0f", rb_ray_class_names[unit->choice.ray_class],
               rb_stage_names[unit->choice.kernel], unit->choice.bounce, (double)unit->rays);
        put(f.net, 1e9);
        put(f.gross, 1e9);
        put(f.seconds, 1e9);
        put(f.net * f.seconds, 1e18);
        printf("\n");
    }
    printf(
        "\n  %s. net: without the power of the idle machine, %.3g W before and %.3g W after; -:\n"
        "  not above it. gross is all that the packages took, neighbours included.\n",
        energy->source, energy->idle_before_w, energy->idle_after_w);
}

static enum rb_status measure_all(const struct rb_replay_run *run,
                                  const struct rb_arguments *arguments, struct rb_meter *meter,
                                  struct rb_error *error)
{
    static struct rb_energy_span spans[RB_REPLAY_UNITS_MAX];
    struct rb_energy energy = {.frames = {.units = 0}};
    enum rb_status status =
        rb_energy_idle(meter, arguments->bench.idle_s, &energy.idle_before_w, error);
    for (int i = 0; i < run->unit_count && status == RB_OK && !rb_process_interrupted(); i++)
        status = measure_unit(run, &run->units[i], arguments, &spans[i], error);
    if (status == RB_OK)
        status = rb_energy_idle(meter, arguments->bench.idle_s, &energy.idle_after_w, error);
    rb_meter_describe(meter, energy.source);
    if (status == RB_OK && !rb_process_interrupted())
        print(run, &energy, spans);
    return status;
}

int rb_replay_energy(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    struct rb_meter meter;
    struct rb_error error = {0};
    enum rb_status status = rb_meter_open(&meter, rb_hardware_root(), &error);
    if (status && arguments->bench.energy_model) {
        printf("%s; modelled instead\n", error.text);
        return rb_replay_simulate(run, arguments);
    }
    if (status)
        return rb_report(status, &error);
    rb_process_catch_signals();
    status = measure_all(run, arguments, &meter, &error);
    rb_meter_close(&meter);
    fflush(stdout);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return error.text[0] ? rb_report(status, &error) : (int)status;
}
