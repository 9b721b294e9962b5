// `raybench bench`: what a plan may say, and the tables at the end.
#include "bench/run/bench.h"

#include "bench/compare/compare.h"
#include "bench/run/session.h"
#include "bench/run/table.h"
#include "cli/commands.h"

#include <stdio.h>

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--measure", "time|count|simulate|hardware,...", RB_OPTION_TEXT,
     offsetof(struct rb_arguments, bench.measure), 0, 0, "default time,count"},
    {.name = NULL},
};

const struct rb_command rb_command_bench = {
    .name = "bench",
    .summary = "measure time per ray, by kernel and bounce, of every variant",
    .synopsis = "[SCENE...|PLAN] [options]",
    .text = RB_HELP_SCENE
    " Default: the six scenes of the 2019\n"
    "report. PLAN is a file of lines `option = value`, named with its .plan, or one of those that\n"
    "come with the program: smoke, table, ladder, scaling, tiles, depth, soft, scaling-sim,\n"
    "gate, gate-sim, regress.\n\n"
    "  raybench bench balls_high\n"
    "  raybench bench --scenes 'mount_*' --variants 'packet-*' --budget 2m\n"
    "  raybench bench scaling --dry-run\n"
    "  raybench bench mount_high --against ../old/build/raybench\n\n"
    "A cell is a scene, a variant and settings. Each is measured in several processes, all cells\n"
    "in turn; a process renders again and again and must give the image and the hits of the\n"
    "reference, or the cell gets no time and the exit code is 2. Figures are medians over\n"
    "processes; intervals are distribution-free. Where naive would take too long, it is measured\n"
    "on random groups of tiles and marked estimated. Results are kept in a new folder of DIR, as\n"
    "they come in; results/README.md explains the files. SIGINT ends a run with what it has, and\n"
    "--resume goes on.",
    .positional_min = 0,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){options, rb_options_cells, rb_options_timing,
                                                rb_options_simulation, rb_options_hardware,
                                                rb_options_keeping, rb_options_settings,
                                                rb_options_strict, NULL},
    .run = run,
};

// Prints what this program (B) is against the other one (A).
static int print_verdicts(const struct rb_run *run)
{
    const struct rb_arguments compare = {
        .positional = {run->sides[1].folder, run->sides[0].folder},
        .positional_count = 2,
    };
    return run->side_count == 2 ? rb_command_compare.run(&compare) : RB_OK;
}

static int print_results(const struct rb_run *run, bool partial)
{
    for (int i = 0; i < run->plan->reference_count; i++)
        if (run->plan->references[i].made_by)
            rb_table_print(run->plan, &run->plan->references[i], 0, run->probe_ns);
    rb_table_print_summary(run->plan);
    printf(
        "\nns per ray: time of all threads over queue entries, misses included; medians over n\n"
        "processes. Mrays/s: trace and trace_shadow rays per frame time. A probe costs %.1f ns.\n",
        run->probe_ns);
    rb_session_print_folder(run, partial);
    return print_verdicts(run) ? RB_FAILED : RB_OK;
}

static const struct rb_session_kind kind = {
    .defaults = "# what is measured when nothing is said\n"
                "scenes = *\n"
                "variants = naive,bvh,packet,auto,auto+omp,fastest\n",
    .print = print_results,
};

// Kernels are compared where nothing but kernels differs.
static const struct rb_session_kind kind_against = {
    .defaults = "# what is measured against another program\n"
                "scenes = *\n"
                "variants = bvh,packet\n",
    .print = print_results,
};

static int run(const struct rb_arguments *arguments)
{
    return rb_session_run(arguments->bench.against ? &kind_against : &kind, arguments);
}
