#define _POSIX_C_SOURCE 200809L
#include "bench/run/simulate_command.h"

#include "base/cpu.h"
#include "bench/run/folder.h"
#include "bench/run/plan.h"
#include "bench/run/process.h"
#include "bench/run/reference.h"
#include "bench/run/simulate_cell.h"
#include "bench/run/simulate_table.h"
#include "bench/simulate/simulate.h"
#include "cli/commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, BENCH(scenes), 0, 0, "scenes"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0,
     "rows; default naive,bvh,packet"},
    {"--variant", "VARIANT", RB_OPTION_TEXT, BENCH(variants), 0, 0, "the same"},
    {"--depth", "LIST", RB_OPTION_TEXT, BENCH(depths), 0, 0, "levels of the ray tree; default 5"},
    {"--l1", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(l1), 0, 0,
     "L1 data cache, such as 32K,8; default: the host's"},
    {"--ll", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(ll), 0, 0,
     "last-level cache, such as 1M,16; default: the host's"},
    {"--simulate-tiles", "N", RB_OPTION_INT, BENCH(simulate_tiles), 1, 1e9,
     "tiles to simulate; default: as many as take ten seconds"},
    {.name = NULL},
};

const struct rb_command rb_command_simulate = {
    .name = "simulate",
    .summary = "instructions and misses per ray, by kernel and bounce, from a simulator",
    .synopsis = "SCENE... [options]",
    .text = RB_HELP_SCENE,
    .positional_min = 1,
    .positional_max = 16,
    .groups =
        (const struct rb_option *const[]){options, rb_options_settings, rb_options_strict, NULL},
    .run = run,
};

static int run(const struct rb_arguments *arguments)
{
    static struct rb_plan plan;
    static struct rb_simulated simulated[64];
    struct rb_error error = {0};
    struct rb_caches caches;
    char program[1024];
    setenv("RAYBENCH_CPU_DISABLE", "avx512f", 1);
    enum rb_status status = rb_simulate_check(&error);
    if (status == RB_OK)
        status = rb_caches_choose("", arguments->bench.l1, arguments->bench.ll, &caches, &error);
    if (status == RB_OK)
        status = rb_plan_compose(arguments, &plan, &error);
    if (status == RB_OK)
        status = rb_plan_parse(&rb_command_simulate, &plan, &error);
    if (status == RB_OK)
        status = rb_process_self(program, sizeof program, &error);
    if (status)
        return rb_report(status, &error);
    int code = rb_plan_expand(&plan);
    if (code)
        return code;
    rb_process_catch_signals();
    rb_simulate_print_caches(&caches);
    for (int i = 0; i < plan.cell_count; i++) {
        struct rb_cell *cell = &plan.cells[i];
        if (!cell->reference->made_by)
            status = rb_reference_make(cell->reference, program, "/dev/null", 0, false, &error);
        if (status == RB_OK)
            status = rb_simulate_cell(cell, program, (uint32_t)arguments->bench.simulate_tiles,
                                      &caches, &simulated[i], &error);
        if (status)
            return rb_report(status, &error);
        rb_simulate_print(cell, &simulated[i]);
    }
    for (int i = 0; i < plan.cell_count; i++)
        rb_simulate_print_scaling(&plan.cells[i], &simulated[i]);
    rb_simulate_print_notes();
    return 0;
}
