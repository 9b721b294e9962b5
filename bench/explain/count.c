// `raybench count`: what the kernels do, exactly.
#include "bench/explain/count.h"

#include "bench/explain/count_table.h"
#include "bench/explain/heat.h"
#include "bench/run/session.h"
#include "cli/commands.h"
#include "render/image.h"

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--heatmap", "COUNTER|tests|ns", RB_OPTION_TEXT, offsetof(struct rb_arguments, bench.heatmap),
     0, 0, "draw what each pixel costs: a counter, tests of all primitives, or ns; needs -o"},
    {"-o", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, bench.picture), 0, 0,
     "picture of the heat map: .png, .ppm; .pfm has the numbers"},
    {.name = NULL},
};

const struct rb_command rb_command_count = {
    .name = "count",
    .summary = "count nodes, boxes, primitives, lanes and bytes per ray, by kernel and bounce",
    .synopsis = "SCENE... [options]",
    .text = RB_HELP_SCENE
    "\n\n"
    "  raybench count balls_high --variant bvh\n"
    "  raybench count mount_high --variants naive,bvh,packet\n"
    "  raybench count balls_high --variant packet --heatmap nodes -o nodes.png\n\n"
    "The kernels are compiled a second time with counting. Counts are exact, the same in every\n"
    "run and for any number of threads; the counting kernels must give the image and the hits\n"
    "of the reference. Where naive would take too long, a random group of tiles is counted.\n"
    "Results are kept in a new folder of DIR: the counts are columns of its kernels.csv.",
    .positional_min = 1,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){options, rb_options_cells, rb_options_keeping,
                                                rb_options_settings, rb_options_strict, NULL},
    .run = run,
};

static int print(const struct rb_run *run, bool partial)
{
    const struct rb_bench_arguments *given = &run->given->bench;
    struct rb_heat heat;
    struct rb_error error = {0};
    enum rb_status status = RB_OK;
    for (int i = 0; i < run->plan->cell_count; i++)
        rb_count_table_print(&run->plan->cells[i]);
    rb_count_table_print_notes();
    if (given->heatmap && !partial)
        status = rb_heat_find(given->heatmap, &heat, &error);
    if (given->heatmap && !partial && status == RB_OK)
        status = rb_heat_write(&run->plan->cells[0], &heat, given->picture, &error);
    rb_session_print_folder(run, partial);
    return status ? rb_report(status, &error) : RB_OK;
}

// Before the long work.
static enum rb_status check(const struct rb_arguments *arguments, struct rb_error *error)
{
    const struct rb_bench_arguments *bench = &arguments->bench;
    struct rb_heat heat;
    if (!bench->heatmap != !bench->picture)
        return rb_error_set(error, RB_INVALID, "--heatmap COUNTER and -o FILE belong together");
    if (!bench->heatmap)
        return RB_OK;
    if (!rb_image_format_of(bench->picture, error))
        return RB_INVALID;
    return rb_heat_find(bench->heatmap, &heat, error);
}

static int run(const struct rb_arguments *arguments)
{
    static const struct rb_session_kind kind = {
        .defaults = "measure = count\nvariants = fastest\n",
        .print = print,
    };
    struct rb_error error = {0};
    enum rb_status status = check(arguments, &error);
    return status ? rb_report(status, &error) : rb_session_run(&kind, arguments);
}
