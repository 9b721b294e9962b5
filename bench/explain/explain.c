// `raybench explain`: why a kernel costs what it costs.
#include "bench/explain/explain.h"

#include "bench/explain/explain_table.h"
#include "bench/explain/simulate_table.h"
#include "bench/run/session.h"
#include "bench/run/simulate_cell.h"
#include "cli/commands.h"

#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_explain = {
    .name = "explain",
    .summary = "time, counts and simulated events per ray side by side, and what they mean",
    .synopsis = "SCENE... [options]",
    .text = RB_HELP_SCENE
    "\n\n"
    "  raybench explain balls_high\n"
    "  raybench explain mount_high --variants bvh,packet-avx2 --ll 8M,16\n\n"
    "Measures, counts and simulates serial rows, naive, bvh and auto unless told, and prints\n"
    "for each kernel at each bounce what a ray takes and does; what the columns mean; and for\n"
    "each row a paragraph on where most of its time goes and why. The simulator has no AVX-512:\n"
    "auto and packet mean the widest rows without it. Results are kept in a new folder of DIR.",
    .positional_min = 1,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){rb_options_cells, rb_options_timing,
                                                rb_options_simulation, rb_options_hardware,
                                                rb_options_keeping, rb_options_settings,
                                                rb_options_strict, NULL},
    .run = run,
};

static const struct rb_cell *baseline_of(const struct rb_run *run, const struct rb_cell *cell)
{
    for (int i = 0; i < run->unit_count; i++) {
        const struct rb_cell *other = &run->plan->cells[i];
        if (other->reference == cell->reference && other != cell &&
            strcmp(other->variant->name, cell->variant->baseline) == 0)
            return other;
    }
    return NULL;
}

static int print(const struct rb_run *run, bool partial)
{
    rb_simulate_print_caches(&run->caches);
    for (int i = 0; i < run->unit_count; i++)
        rb_explain_print_table(&run->plan->cells[i]);
    rb_explain_print_notes(run->plan->arguments.bench.energy_model ? &run->model : NULL);
    rb_explain_print_rates(run->plan);
    for (int i = 0; i < run->unit_count; i++)
        rb_explain_print_words(&run->plan->cells[i], baseline_of(run, &run->plan->cells[i]));
    printf("\n");
    rb_session_print_folder(run, partial);
    return RB_OK;
}

static int run(const struct rb_arguments *arguments)
{
    static struct rb_event_file events; // too large for the stack
    static const char plain[] = "measure = time,count,simulate\nvariants = "
                                "naive,bvh,auto\nenergy-model = horowitz14-45nm\n";
    static const char hardware[] = "measure = time,count,simulate,hardware\nvariants = "
                                   "naive,bvh,auto\nenergy-model = horowitz14-45nm\n";
    struct rb_error ignored = {0};
    bool pmu = rb_event_file_choose(rb_hardware_root(), NULL, &events, &ignored) == RB_OK &&
               strcmp(rb_event_file_source(&events), "pmu") == 0;
    const struct rb_session_kind kind = {.defaults = pmu ? hardware : plain, .print = print};
    rb_simulate_mask();
    return rb_session_run(&kind, arguments);
}
