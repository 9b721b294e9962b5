#include "bench/explain/simulate_command.h"

#include "bench/explain/simulate_table.h"
#include "bench/run/session.h"
#include "bench/run/simulate_cell.h"
#include "cli/commands.h"

#include <stdio.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_simulate = {
    .name = "simulate",
    .summary = "instructions and misses per ray, by kernel and bounce, from a simulator",
    .synopsis = "SCENE...|PLAN [options]",
    .text = RB_HELP_SCENE
    " PLAN is a plan\n"
    "of raybench bench; scaling-sim comes with the program.\n\n"
    "  raybench simulate balls_high\n"
    "  raybench simulate mount_high --variant bvh --l1 48K,12 --ll 8M,16\n"
    "  raybench simulate scaling-sim\n\n"
    "Runs each row under valgrind's callgrind, one thread, and prints what a kernel at a bounce\n"
    "does for a ray: instructions, misses of the L1 and the last-level cache, mispredicted\n"
    "branches, and cycles modelled from them. No clock decides anything, so two runs give the\n"
    "same counts. The simulator is 20 to 100 times slower than the machine; what it gets are\n"
    "runs of neighbouring tiles, spread over the frame, once to warm its caches and once to\n"
    "count. Their hits must be those of a native run. Naive gets at least one tile of 16 x 16\n"
    "pixels, which takes five minutes on mount_very_high. valgrind has no AVX-512: auto and\n"
    "packet mean the widest rows without it. Results are kept in a new folder of DIR: the figures "
    "are\n"
    "columns of its kernels.csv.",
    .positional_min = 1,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){rb_options_cells, rb_options_simulation,
                                                rb_options_keeping, rb_options_settings,
                                                rb_options_strict, NULL},
    .run = run,
};

// Why others were not simulated has been said.
static int print(const struct rb_run *run, bool partial)
{
    int done = 0;
    for (int i = 0; i < run->plan->cell_count; i++) {
        if (!run->plan->cells[i].simulated)
            continue;
        if (done++ == 0)
            rb_simulate_print_caches(&run->caches);
        rb_simulate_print(&run->plan->cells[i]);
    }
    if (done == 0)
        return run->crashed ? RB_FAILED : RB_INVALID;
    rb_simulate_print_scaling(run->plan);
    rb_simulate_print_notes();
    rb_session_print_folder(run, partial);
    return RB_OK;
}

static int run(const struct rb_arguments *arguments)
{
    static const struct rb_session_kind kind = {
        .defaults = "measure = simulate\nvariants = naive,bvh,auto\n",
        .print = print,
    };
    rb_simulate_mask();
    return rb_session_run(&kind, arguments);
}
