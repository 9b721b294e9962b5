// `raybench bench`: makes a plan, runs it, keeps the results, prints the tables.
#define _POSIX_C_SOURCE 200809L
#include "bench/run/bench.h"

#include "base/file.h"
#include "bench/compare/compare.h"
#include "bench/run/columns.h"
#include "bench/run/process.h"
#include "bench/run/results.h"
#include "bench/run/run.h"
#include "bench/run/samples_file.h"
#include "bench/run/table.h"
#include "cli/commands.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, BENCH(scenes), 0, 0,
     "scenes, comma-separated; patterns such as mount_* choose presets; default all six"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0,
     "rows, comma-separated names or patterns, or fastest; default naive,bvh,packet,fastest, the "
     "last three +omp, too"},
    {"--threads", "LIST", RB_OPTION_TEXT, BENCH(threads), 0, 0,
     "thread counts of +omp rows, max, or powers: 1, 2, 4 ... max; default max: as OpenMP has it"},
    {"--tile", "LIST", RB_OPTION_TEXT, BENCH(tiles), 0, 0,
     "edges of a tile in pixels, multiples of 16; default 64"},
    {"--depth", "LIST", RB_OPTION_TEXT, BENCH(depths), 0, 0,
     "levels of the ray tree, 1 = ray casting; default 5"},
    {"--light-samples", "LIST", RB_OPTION_TEXT, BENCH(light_samples), 0, 0,
     "shadow rays per light; default 1"},
    {"--budget", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 0.1, 1e6,
     "time to spend, such as 90s or 5m; default 12 s a scene"},
    {"--processes", "N", RB_OPTION_INT, BENCH(processes), 1, 1000,
     "processes each cell has at least; default 6, the fewest with a 95 % interval; 16 against a "
     "program"},
    {"--against", "PROGRAM", RB_OPTION_TEXT, BENCH(against), 0, 0,
     "another build of raybench, measured in turn with this one, and compared; variants: "
     "bvh,packet"},
    {"--full-reference", NULL, RB_OPTION_FLAG, BENCH(full_reference), 0, 0,
     "render naive in full for the reference, however long that takes; it is kept"},
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder for result folders; default results"},
    {"--resume", NULL, RB_OPTION_FLAG, BENCH(resume), 0, 0,
     "go on with the newest run in DIR, which was stopped"},
    {"--dry-run", NULL, RB_OPTION_FLAG, BENCH(dry_run), 0, 0, "print the cells and the time"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0,
     "no progress, no warnings"},
    {.name = NULL},
};

const struct rb_command rb_command_bench = {
    .name = "bench",
    .summary = "measure time per ray, by kernel and bounce, of every variant",
    .synopsis = "[SCENE...|PLAN] [options]",
    .text = RB_HELP_SCENE
    " Default: the six scenes of the 2019\n"
    "report. PLAN is a file of lines `option = value`, named with its .plan, or one of those that\n"
    "come with the program: smoke, table, ladder, scaling, tiles, depth, soft.\n\n"
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
    .groups =
        (const struct rb_option *const[]){options, rb_options_settings, rb_options_strict, NULL},
    .run = run,
};

static const double SCENE_BUDGET_S = 12;

// Folder of a side: the second one's is named after the first one's.
static enum rb_status make_folders(struct rb_run *run, struct rb_error *error)
{
    enum rb_status status = rb_folder_make(run->parent, run->sides[0].folder, error);
    if (status == RB_OK && run->side_count == 2)
        status = rb_folder_make_second(run->sides[0].folder, run->sides[1].folder, error);
    return status == RB_OK ? rb_folder_link_latest(run->parent, run->sides[0].folder, error)
                           : status;
}

// Opens samples.csv.part with what the cells already have.
static enum rb_status open_samples(struct rb_run *run, int side, struct rb_error *error)
{
    char path[RB_PATH_MAX + 32];
    snprintf(path, sizeof path, "%s/samples.csv.part", run->sides[side].folder);
    FILE *file = run->sides[side].samples = fopen(path, "w");
    if (file) {
        rb_columns_csv_header(file, rb_sample_columns);
        for (int i = 0; i < run->plan->cell_count; i++) {
            const struct rb_cell *cell = &run->plan->cells[i];
            for (size_t k = 0; cell->side == side && k < cell->sample_count; k++)
                rb_samples_write(file, cell, &cell->samples[k]);
        }
    }
    if (file && fflush(file) == 0)
        return RB_OK;
    snprintf(error->file, sizeof error->file, "%.255s", path);
    return rb_error_set(error, RB_FAILED, "cannot write: %s", strerror(errno));
}

static enum rb_status keep_plan(const struct rb_run *run, struct rb_error *error)
{
    char path[RB_PATH_MAX + 32];
    struct rb_output output;
    snprintf(path, sizeof path, "%s/run.plan", run->sides[0].folder);
    enum rb_status status = rb_output_open(&output, path, error);
    if (status)
        return status;
    fputs(run->plan->text, output.stream);
    return rb_output_commit(&output, error);
}

static enum rb_status write_side(const struct rb_run *run, const struct rb_arguments *arguments,
                                 int side, bool partial, struct rb_error *error)
{
    struct rb_plan *plan = run->plan;
    struct rb_env_scene *scenes = calloc((size_t)plan->reference_count, sizeof *scenes);
    if (!scenes)
        return rb_error_memory(error, "the results");
    for (int i = 0; i < plan->reference_count; i++)
        scenes[i] =
            (struct rb_env_scene){plan->references[i].scene_name, plan->references[i].scene_hash,
                                  plan->references[i].primitive_count};
    const struct rb_results results = {
        .plan = plan,
        .side = side,
        .partial = partial,
        .probe_ns = run->probe_ns,
        .folder = run->sides[side].folder,
        .env = {.command_line = arguments->command_line,
                .session = run->session,
                .seed = plan->arguments.settings.seed,
                .scenes = scenes,
                .scene_count = plan->reference_count,
                .tsc_ns_per_tick = rb_clock_ns_per_tick(),
                .tsc_error_ppm = (double)NAN,
                .probe_ns = run->probe_ns,
                .complete = !partial,
                .program = side ? run->sides[side].program : NULL,
                .started = run->started,
                .pinning = "serial rows: a processor per process, in turn; OpenMP rows: "
                           "OMP_PROC_BIND=true unless set"},
    };
    enum rb_status status = rb_results_write(&results, error);
    free(scenes);
    return status;
}

// Files that a crash would leave say that nothing is finished.
static enum rb_status begin(struct rb_run *run, const struct rb_arguments *arguments,
                            struct rb_error *error)
{
    bool resume = arguments->bench.resume;
    enum rb_status status = resume ? RB_OK : make_folders(run, error);
    for (int side = 0; side < run->side_count && status == RB_OK && resume; side++) {
        char path[RB_PATH_MAX + 32];
        snprintf(path, sizeof path, "%s/samples.csv.part", run->sides[side].folder);
        status = rb_samples_read(path, run->plan, side, error);
    }
    if (status == RB_OK && !resume)
        status = keep_plan(run, error);
    for (int side = 0; side < run->side_count && status == RB_OK; side++)
        status = open_samples(run, side, error);
    const char *name = strrchr(run->sides[0].folder, '/');
    snprintf(run->session, sizeof run->session, "%.63s", name ? name + 1 : run->sides[0].folder);
    for (int side = 0; side < run->side_count && status == RB_OK; side++)
        status = write_side(run, arguments, side, true, error);
    return status;
}

// The samples get their final name when nothing is missing.
static enum rb_status finish_samples(struct rb_side *side, bool partial, struct rb_error *error)
{
    char part[RB_PATH_MAX + 32], whole[RB_PATH_MAX + 32];
    snprintf(part, sizeof part, "%s/samples.csv.part", side->folder);
    snprintf(whole, sizeof whole, "%s/samples.csv", side->folder);
    bool failed = fclose(side->samples) != 0;
    side->samples = NULL;
    if (!failed && (partial || rename(part, whole) == 0))
        return RB_OK;
    snprintf(error->file, sizeof error->file, "%.255s", part);
    return rb_error_set(error, RB_FAILED, "cannot write: %s", strerror(errno));
}

static enum rb_status finish(struct rb_run *run, const struct rb_arguments *arguments, bool partial,
                             struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (int side = 0; side < run->side_count && status == RB_OK; side++) {
        status = finish_samples(&run->sides[side], partial, error);
        if (status == RB_OK)
            status = write_side(run, arguments, side, partial, error);
    }
    return status;
}

static void print_results(const struct rb_run *run, bool partial)
{
    for (int i = 0; i < run->plan->reference_count; i++)
        if (run->plan->references[i].made_by)
            rb_table_print(run->plan, &run->plan->references[i], 0, run->probe_ns);
    rb_table_print_summary(run->plan);
    printf(
        "\nns per ray: time of all threads over queue entries, misses included; medians over n\n"
        "processes. Mrays/s: trace and trace_shadow rays per frame time. A probe costs %.1f ns.\n",
        run->probe_ns);
    printf("%s in %s/%s.%s\n", partial ? "What there is so far is" : "Results are",
           run->sides[0].folder, partial ? "; raybench bench --resume goes on" : "",
           run->side_count == 2 ? "\n" : "");
}

// Prints what this program (B) is against the other one (A).
static int print_verdicts(const struct rb_run *run)
{
    const struct rb_arguments compare = {
        .positional = {run->sides[1].folder, run->sides[0].folder},
        .positional_count = 2,
    };
    return run->side_count == 2 ? rb_command_compare.run(&compare) : RB_OK;
}

static int measure(struct rb_run *run, const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    enum rb_status status = rb_run_prepare(run, &error);
    if (status == RB_OK && !rb_process_interrupted())
        status = begin(run, arguments, &error);
    if (rb_process_interrupted() && !run->sides[0].samples)
        return RB_FAILED; // before there was anything to keep
    if (status == RB_OK)
        status = rb_run_cells(run, &error);
    if (status != RB_OK && !run->sides[0].samples)
        return rb_report(status, &error);
    bool partial = rb_process_interrupted() || status != RB_OK;
    struct rb_error second = {0};
    enum rb_status finished = finish(run, arguments, partial, &second);
    if (status || finished)
        return status ? rb_report(status, &error) : rb_report(finished, &second);
    print_results(run, partial);
    if (print_verdicts(run))
        return RB_FAILED;
    return run->mismatch ? RB_INVALID : run->crashed ? RB_FAILED : RB_OK;
}

static void print_cells(const struct rb_run *run)
{
    for (int i = 0; i < run->unit_count; i++) {
        const struct rb_cell *cell = &run->plan->cells[i];
        const struct rb_settings *s = &cell->settings;
        printf("%-18s %-18s %d x %d, depth %d, light samples %d, tile %d, threads %d%s%s\n",
               cell->reference->scene_name, cell->variant->name, s->width, s->height, s->depth,
               s->light_samples, s->tile, s->threads,
               cell->state == RB_CELL_UNAVAILABLE ? ": needs " : "",
               cell->state == RB_CELL_UNAVAILABLE ? cell->variant->needs : "");
    }
    printf("%d cells%s, at least %d processes each, about %.0f s\n", run->unit_count,
           run->side_count == 2 ? " with two programs" : "", rb_run_processes(run), run->budget_s);
}

static int expand(struct rb_run *run)
{
    struct rb_plan *plan = run->plan;
    int code = rb_plan_expand(plan);
    if (code)
        return code;
    int scenes = 0;
    for (int i = 0; i < plan->reference_count; i++)
        scenes += i == 0 ||
                  strcmp(plan->references[i].scene_name, plan->references[i - 1].scene_name) != 0;
    run->side_count = plan->arguments.bench.against ? 2 : 1;
    run->unit_count = plan->cell_count / run->side_count;
    run->budget_s = plan->arguments.budget_s > 0 ? plan->arguments.budget_s
                                                 : SCENE_BUDGET_S * scenes * run->side_count;
    return 0;
}

static enum rb_status find_programs(struct rb_run *run, struct rb_error *error)
{
    const char *against = run->plan->arguments.bench.against;
    if (against && access(against, X_OK) != 0) {
        snprintf(error->file, sizeof error->file, "%.255s", against);
        return rb_error_set(error, RB_INVALID, "cannot run the program: %s", strerror(errno));
    }
    if (against)
        snprintf(run->sides[1].program, sizeof run->sides[1].program, "%s%s",
                 strchr(against, '/') ? "" : "./", against);
    return rb_process_self(run->sides[0].program, sizeof run->sides[0].program, error);
}

// The plan of a new run, or of the one to go on with.
static enum rb_status make_plan(struct rb_run *run, const struct rb_arguments *arguments,
                                struct rb_error *error)
{
    struct rb_arguments stopped = {.positional = {NULL}, .positional_count = 1};
    char path[RB_PATH_MAX + 32];
    enum rb_status status = rb_folder_check(run->parent, error);
    if (status)
        return status;
    if (arguments->bench.resume) {
        status = rb_folder_find_stopped(run->parent, run->sides[0].folder, error);
        if (status)
            return status;
        snprintf(run->sides[1].folder, RB_PATH_MAX, "%.700s.against", run->sides[0].folder);
        snprintf(path, sizeof path, "%s/run.plan", run->sides[0].folder);
        stopped.positional[0] = path;
        arguments = &stopped;
    }
    status = rb_plan_compose(arguments, run->plan, error);
    return status ? status : rb_plan_parse(&rb_command_bench, run->plan, error);
}

static int run(const struct rb_arguments *arguments)
{
    static struct rb_plan plan;
    struct rb_run run = {.plan = &plan, .quiet = arguments->quiet};
    struct rb_error error = {0};
    run.parent = arguments->output ? arguments->output : "results";
    // A caller who closed standard output wants the files alone.
    if ((fcntl(STDOUT_FILENO, F_GETFL) & O_ACCMODE) == O_RDONLY)
        stdout = freopen("/dev/null", "w", stdout);
    enum rb_status status = make_plan(&run, arguments, &error);
    plan.arguments.quiet = arguments->quiet;
    int code = status ? rb_report(status, &error) : expand(&run);
    if (code == 0) {
        status = find_programs(&run, &error);
        code = status ? rb_report(status, &error) : 0;
    }
    if (code == 0 && arguments->bench.dry_run) {
        print_cells(&run);
    } else if (code == 0) {
        run.probe_ns = rb_probe_cost_ns();
        run.started = time(NULL);
        rb_process_catch_signals();
        code = measure(&run, arguments);
    }
    rb_plan_free(&plan);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return code;
}
