#define _POSIX_C_SOURCE 200809L
#include "bench/run/simulate_command.h"

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
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, BENCH(scenes), 0, 0,
     "more scenes, comma-separated; patterns such as mount_* choose presets"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0,
     "serial rows, comma-separated names or patterns; default naive,bvh,packet"},
    {"--variant", "VARIANT", RB_OPTION_TEXT, BENCH(variants), 0, 0, "the same"},
    {"--depth", "LIST", RB_OPTION_TEXT, BENCH(depths), 0, 0,
     "levels of the ray tree, 1 = ray casting; default 5"},
    {"--light-samples", "LIST", RB_OPTION_TEXT, BENCH(light_samples), 0, 0,
     "shadow rays per light; default 1"},
    {"--tile", "LIST", RB_OPTION_TEXT, BENCH(tiles), 0, 0,
     "edges of a tile in pixels, multiples of 16; default 64; naive has 16"},
    {"--tiles", "N", RB_OPTION_INT, BENCH(simulate_tiles), 1, 1e9,
     "tiles of the frame to simulate; default: as many as take about ten seconds"},
    {"--l1", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(l1), 0, 0,
     "L1 data cache, such as 32K,8; default: this machine's"},
    {"--ll", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(ll), 0, 0,
     "last-level cache, such as 32M,16; default: this machine's"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0,
     "no progress, no warnings"},
    {.name = NULL},
};

const struct rb_command rb_command_simulate = {
    .name = "simulate",
    .summary = "instructions and misses per ray, by kernel and bounce, from a simulator",
    .synopsis = "SCENE... [options]",
    .text = RB_HELP_SCENE
    "\n\n"
    "  raybench simulate balls_high\n"
    "  raybench simulate mount_high --variant bvh --l1 48K,12 --ll 8M,16\n"
    "  raybench simulate balls2 balls3 balls4 balls5 balls6 --variant bvh --ll 1M,16\n\n"
    "Runs each row under valgrind's callgrind, one thread, and prints what a kernel at a bounce\n"
    "does for a ray: instructions, misses of the L1 and the last-level cache, mispredicted\n"
    "branches, and cycles modelled from them. No clock decides anything, so two runs give the\n"
    "same counts. The simulator is 20 to 100 times slower than the machine; what it gets are\n"
    "runs of neighbouring tiles, spread over the frame, once to warm its caches and once to\n"
    "count. Their hits must be those of a native run. valgrind has no AVX-512: packet means the\n"
    "widest packets without it.",
    .positional_min = 1,
    .positional_max = 16,
    .groups =
        (const struct rb_option *const[]){options, rb_options_settings, rb_options_strict, NULL},
    .run = run,
};

// Rows that stand for others, and the machine's own choices, do without what valgrind lacks.
static void disable_avx512(void)
{
    const char *disabled = getenv("RAYBENCH_CPU_DISABLE");
    char list[256];
    snprintf(list, sizeof list, "%.200s%savx512f", disabled ? disabled : "",
             disabled && *disabled ? "," : "");
    setenv("RAYBENCH_CPU_DISABLE", list, 1);
}

static void print_head(const struct rb_caches *caches)
{
    const struct rb_variant *packet = rb_variant_resolve(rb_variant_find("packet"));
    rb_simulate_print_caches(caches);
    if (packet)
        printf("valgrind has no AVX-512: packet means %s\n", packet->name);
}

static void show_progress(const struct rb_cell *cell, const struct rb_arguments *arguments)
{
    if (!arguments->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\rsimulating %s, %s ...\033[K\r", cell->reference->scene_name,
                cell->variant->name);
}

// Why a cell is left out, or NULL.
static const char *left_out(const struct rb_cell *cell)
{
    const char *refusal = rb_simulate_refusal(cell->variant);
    bool unavailable = cell->state == RB_CELL_UNAVAILABLE;
    return refusal ? refusal : unavailable ? "this machine or build lacks what it needs" : NULL;
}

static enum rb_status simulate(struct rb_cell *cell, const struct rb_arguments *arguments,
                               const char *program, const struct rb_caches *caches,
                               struct rb_error *error)
{
    enum rb_status status = RB_OK;
    show_progress(cell, arguments);
    if (!cell->reference->made_by)
        status = rb_reference_make(cell->reference, program, "/dev/null", 0, false, error);
    if (status == RB_OK && !rb_process_interrupted())
        status = rb_simulate_cell(cell, program, (uint32_t)arguments->bench.simulate_tiles, caches,
                                  error);
    return status;
}

static int simulate_all(struct rb_plan *plan, const char *program, const struct rb_caches *caches,
                        struct rb_error *error)
{
    int done = 0;
    for (int i = 0; i < plan->cell_count && !rb_process_interrupted(); i++) {
        struct rb_cell *cell = &plan->cells[i];
        if (left_out(cell)) {
            fprintf(stderr, "raybench: %s is not simulated: %s\n", cell->variant->name,
                    left_out(cell));
            continue;
        }
        enum rb_status status = simulate(cell, &plan->arguments, program, caches, error);
        if (rb_process_interrupted())
            return RB_FAILED;
        if (status)
            return rb_report(status, error);
        if (done++ == 0)
            print_head(caches);
        rb_simulate_print(cell);
    }
    if (done == 0)
        return RB_INVALID;
    rb_simulate_print_scaling(plan);
    rb_simulate_print_notes();
    return RB_OK;
}

static int run(const struct rb_arguments *arguments)
{
    static struct rb_plan plan;
    struct rb_error error = {0};
    struct rb_caches caches;
    char program[1024];
    enum rb_status status = rb_simulate_check(&error);
    if (status == RB_OK)
        status = rb_caches_choose("", arguments->bench.l1, arguments->bench.ll, &caches, &error);
    if (status == RB_OK)
        status = rb_process_self(program, sizeof program, &error);
    if (status == RB_OK)
        status = rb_plan_compose(arguments, "variants = naive,bvh,packet\n", &plan, &error);
    if (status == RB_OK)
        status = rb_plan_parse(&rb_command_simulate, &plan, &error);
    disable_avx512();
    plan.arguments.quiet = arguments->quiet;
    if (!arguments->bench.variants)
        plan.arguments.bench.variants = "naive,bvh,packet";
    int code = status ? rb_report(status, &error) : rb_plan_expand(&plan);
    rb_process_catch_signals();
    if (code == 0)
        code = simulate_all(&plan, program, &caches, &error);
    rb_plan_free(&plan);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return code;
}
