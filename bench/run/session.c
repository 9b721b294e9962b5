// A run from its plan to its results.
#define _POSIX_C_SOURCE 200809L
#include "bench/run/session.h"

#include "base/file.h"
#include "bench/data/names.h"
#include "bench/run/bench.h"
#include "bench/run/columns.h"
#include "bench/run/evidence.h"
#include "bench/run/process.h"
#include "bench/run/results.h"
#include "bench/run/samples_file.h"
#include "bench/simulate/simulate.h"
#include "cli/commands.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

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

void rb_session_print_folder(const struct rb_run *run, bool partial)
{
    printf("%s in %s/%s.%s\n", partial ? "What there is so far is" : "Results are",
           run->sides[0].folder, partial ? "; raybench bench --resume goes on" : "",
           run->side_count == 2 ? "\n" : "");
}

static int measure(const struct rb_session_kind *kind, struct rb_run *run,
                   const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    enum rb_status status = rb_run_prepare(run, &error);
    if (status == RB_OK && !rb_process_interrupted())
        status = begin(run, arguments, &error);
    if (rb_process_interrupted() && !run->sides[0].samples)
        return RB_FAILED; // before there was anything to keep
    if (status == RB_OK && run->measure & RB_MEASURE_TIME)
        status = rb_run_cells(run, &error);
    if (status == RB_OK)
        status = rb_evidence_gather(run, &error);
    if (status != RB_OK && !run->sides[0].samples)
        return rb_report(status, &error);
    bool partial = rb_process_interrupted() || status != RB_OK;
    struct rb_error second = {0};
    enum rb_status finished = finish(run, arguments, partial, &second);
    if (status || finished)
        return status ? rb_report(status, &error) : rb_report(finished, &second);
    int code = kind->print(run, partial);
    if (code)
        return code;
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
    for (int i = 0; i < run->unit_count && plan->arguments.bench.energy_model; i++)
        plan->cells[i].energy_model = &run->model;
    run->budget_s = plan->arguments.budget_s > 0 ? plan->arguments.budget_s
                                                 : SCENE_BUDGET_S * scenes * run->side_count;
    return 0;
}

static enum rb_status choose_measures(struct rb_run *run, struct rb_error *error)
{
    static const char *const names[] = {"time", "count", "simulate", "hardware"}; // rb_measure
    enum { NAMES = sizeof names / sizeof *names };
    const struct rb_bench_arguments *bench = &run->plan->arguments.bench;
    const char *list = bench->measure ? bench->measure : "time,count";
    char item[RB_NAME_MAX];
    while (rb_names_next(&list, item)) {
        unsigned bit = 0;
        while (bit < NAMES && strcmp(item, names[bit]) != 0)
            bit++;
        if (bit == NAMES)
            return rb_error_set(error, RB_INVALID,
                                "--measure %.64s: expected time, count, simulate or hardware",
                                item);
        run->measure |= 1u << bit;
    }
    enum rb_status status = RB_OK;
    if (run->measure & RB_MEASURE_HARDWARE)
        status = rb_event_file_choose(rb_hardware_root(), bench->events, &run->events, error);
    if (status == RB_OK && bench->energy_model)
        status = rb_energy_model_read(bench->energy_model, &run->model, error);
    if (status == RB_OK && run->measure & RB_MEASURE_SIMULATE)
        status = rb_simulate_check(error);
    if (status == RB_OK && run->measure & RB_MEASURE_SIMULATE)
        status = rb_caches_choose("", bench->l1, bench->ll, &run->caches, error);
    return status;
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
static enum rb_status make_plan(struct rb_run *run, const char *defaults,
                                const struct rb_arguments *arguments, struct rb_error *error)
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
    status = rb_plan_compose(arguments, defaults, run->plan, error);
    return status ? status : rb_plan_parse(&rb_command_bench, run->plan, error);
}

int rb_session_run(const struct rb_session_kind *kind, const struct rb_arguments *arguments)
{
    static struct rb_plan plan;
    static struct rb_run run; // too large for the stack
    run = (struct rb_run){.plan = &plan, .given = arguments, .quiet = arguments->quiet};
    struct rb_error error = {0};
    run.parent = arguments->output ? arguments->output : "results";
    // A caller who closed standard output wants the files alone.
    if ((fcntl(STDOUT_FILENO, F_GETFL) & O_ACCMODE) == O_RDONLY)
        stdout = freopen("/dev/null", "w", stdout);
    enum rb_status status = make_plan(&run, kind->defaults, arguments, &error);
    plan.arguments.quiet = arguments->quiet;
    if (status == RB_OK)
        status = choose_measures(&run, &error);
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
        code = measure(kind, &run, arguments);
    }
    rb_plan_free(&plan);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return code;
}
