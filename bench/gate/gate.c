// Each plan is run as `raybench bench` would, its figures are written to a file, and that is held
// against the one of the same name in the baseline, or, if it was simulated, against what another
// program does with the same cells in the same run.
#include "bench/gate/gate.h"

#include "base/file.h"
#include "bench/gate/moved.h"
#include "bench/run/bench.h"
#include "bench/run/process.h"
#include "bench/run/session.h"
#include "bench/run/simulate_cell.h"
#include "bench/simulate/simulate.h"
#include "cli/commands.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--against", "PROGRAM", RB_OPTION_TEXT, BENCH(against), 0, 0,
     "another build of raybench: what is simulated is held against it instead of the baseline"},
    {"--baseline", "DIR", RB_OPTION_TEXT, BENCH(baseline), 0, 0,
     "folder of the baseline; default results/baseline"},
    {"--update", NULL, RB_OPTION_FLAG, BENCH(update), 0, 0, "write the baseline anew"},
    {"--strict", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, strict), 0, 0,
     "exit code 4 if anything cannot be compared on this machine"},
    {"--markdown", "FILE", RB_OPTION_TEXT, BENCH(markdown), 0, 0,
     "the report as Markdown, for a comment"},
    {"--json", "FILE", RB_OPTION_TEXT, BENCH(json_file), 0, 0, "the report as a JSON object"},
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder for result folders; default results"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0, "no progress"},
    {.name = NULL},
};

const struct rb_command rb_command_gate = {
    .name = "gate",
    .summary = "hold what the kernels do, counted and simulated, against a baseline",
    .synopsis = "[PLAN...] [options]",
    .text =
        "Without a clock, so that any machine will do. Plans: gate, which counts, and\n"
        "gate-sim, which simulates and needs valgrind, unless told. PLAN is compared with\n"
        "PLAN.csv of the baseline.\n\n"
        "  raybench gate\n"
        "  raybench gate gate-sim --against ../old/build/raybench\n"
        "  raybench gate --update\n\n"
        "Counts must be equal. Simulated instructions may move by 0.5 %, L1 misses by 2 % and\n"
        "misses of the last level by 5 %, or by a few events where there are few rays; they\n"
        "are those of one compiler and its flags, and compared with no others. DIR/waivers.csv\n"
        "says what may grow: scene, variant, kernel, bounce, figure (names or patterns),\n"
        "ceiling_pct, expires (YYYY-MM-DD) and reason.\n\n"
        "Exit codes: 0 fine; 1 something does more work; 2 no verdict: baseline and run are\n"
        "not about the same work, one of them is no such file or missing, or the program does\n"
        "less than the baseline says, which is then to be renewed; 4 nothing can be compared\n"
        "here, or with --strict not everything.",
    .positional_min = 0,
    .positional_max = 8,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

static const char *const usual_plans[] = {"gate", "gate-sim"};
enum { PLANS_MAX = 8 };

// What the prints of the sessions share.
static struct gate {
    const struct rb_arguments *arguments;
    const char *baseline;
    struct rb_gate_report report;
    struct rb_waivers waivers;
    struct rb_csv files[PLANS_MAX][2]; // rows of the report point there
    int plan_index;
    char path[RB_PATH_MAX]; // of the plan's baseline
    size_t left_out, stale;
    enum rb_status status; // so far
    struct rb_error error;
} gate;

// A baseline has all of the plan, whatever this machine lacks.
static enum rb_status check_whole(const struct rb_run *run, struct rb_error *error)
{
    for (int i = 0; i < run->unit_count; i++) {
        const struct rb_cell *cell = &run->plan->cells[i];
        if (!cell->counted && !cell->simulated)
            return rb_error_set(error, RB_INVALID,
                                "%.100s, %s was not measured: a baseline needs all of the plan",
                                cell->reference->scene_name, cell->variant->name);
    }
    return RB_OK;
}

static enum rb_status update(const struct rb_run *run, const char *path, struct rb_error *error)
{
    enum rb_status status = check_whole(run, error);
    if (!status)
        status = rb_figures_write(path, run, error);
    if (!status)
        printf("wrote %s\n", path);
    return status;
}

// Puts the figures of the other program in the place of ours.
static enum rb_status simulate_other(const struct rb_run *run, struct rb_error *error)
{
    const char *against = gate.arguments->bench.against;
    char program[RB_PATH_MAX];
    enum rb_status status = RB_OK;
    snprintf(program, sizeof program, "%s%s", strchr(against, '/') ? "" : "./", against);
    for (int i = 0; i < run->unit_count && !status; i++)
        if (run->plan->cells[i].simulated)
            status = rb_simulate_cell(&run->plan->cells[i], program,
                                      (uint32_t)run->plan->arguments.bench.simulate_tiles,
                                      &run->caches, error);
    return status;
}

// Is what the plan simulates held against another program?
static bool has_other(unsigned measure)
{
    return measure == RB_MEASURE_SIMULATE && gate.arguments->bench.against;
}

static enum rb_status compare(const struct rb_run *run, struct rb_error *error)
{
    char path[RB_PATH_MAX + 32];
    struct rb_csv *base = &gate.files[gate.plan_index][0], *head = base + 1;
    bool other = has_other(run->measure);
    size_t better = gate.report.counts[RB_MOVED_BETTER];
    snprintf(path, sizeof path, "%s/figures.csv", run->sides[0].folder);
    enum rb_status status = rb_figures_write(path, run, error);
    if (!status)
        status = rb_figures_load(path, head, error);
    if (!status && other) {
        status = simulate_other(run, error);
        snprintf(path, sizeof path, "%s/figures.against.csv", run->sides[0].folder);
        if (!status)
            status = rb_figures_write(path, run, error);
        if (!status)
            status = rb_figures_load(path, base, error);
    }
    if (!status)
        status = rb_figures_compare(base, head, &gate.waivers, &gate.report, &gate.left_out, error);
    if (!other)
        gate.stale += gate.report.counts[RB_MOVED_BETTER] - better;
    return status;
}

static int judge_plan(const struct rb_run *run, bool partial)
{
    if (partial)
        gate.status = rb_error_set(&gate.error, RB_INVALID, "interrupted");
    else if (gate.arguments->bench.update)
        gate.status = update(run, gate.path, &gate.error);
    else
        gate.status = compare(run, &gate.error);
    return (int)gate.status;
}

// What the plan measures, as bits of rb_measure; only whether it simulates and counts is of
// interest.
static enum rb_status read_plan(const char *name, unsigned *measure, struct rb_error *error)
{
    static struct rb_plan plan;
    char path[RB_PLAN_PATH_MAX];
    const struct rb_arguments given = {.positional = {name}, .positional_count = 1};
    if (!rb_plan_find(name, path))
        return rb_error_set(error, RB_INVALID, "there is no plan '%.100s'; see bench/plans", name);
    const char *file = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    snprintf(gate.path, sizeof gate.path, "%.400s/%.*s.csv", gate.baseline,
             (int)(strlen(file) - strlen(".plan")), file);
    enum rb_status status = rb_plan_compose(&given, "", &plan, error);
    if (!status)
        status = rb_plan_parse(&rb_command_bench, &plan, error);
    const char *list = plan.arguments.bench.measure ? plan.arguments.bench.measure : "";
    *measure = strstr(list, "simulate") ? RB_MEASURE_SIMULATE : 0;
    *measure |= strstr(list, "count") ? RB_MEASURE_COUNT : 0;
    rb_plan_free(&plan);
    return status;
}

// Runs one plan; what it is held against is read before the work.
static enum rb_status run_plan(const char *name, struct rb_error *error)
{
    static const struct rb_session_kind kind = {.defaults = "", .print = judge_plan};
    const struct rb_bench_arguments *given = &gate.arguments->bench;
    const struct rb_arguments session = {.positional = {name},
                                         .positional_count = 1,
                                         .output = gate.arguments->output,
                                         .quiet = gate.arguments->quiet,
                                         .command_line = gate.arguments->command_line};
    unsigned measure = 0;
    struct rb_error lacks = {0};
    enum rb_status status = read_plan(name, &measure, error);
    if (!status && !given->update && !has_other(measure))
        status = rb_figures_load(gate.path, &gate.files[gate.plan_index][0], error);
    if (status)
        return status;
    if (measure & RB_MEASURE_SIMULATE && !given->update && rb_simulate_check(&lacks)) {
        rb_gate_report_note(&gate.report, "not compared: %s: %.300s", name, lacks.text);
        gate.left_out++;
        return RB_OK;
    }
    gate.status = RB_OK;
    if (rb_session_run(&kind, &session) && !gate.status)
        return rb_error_set(error, RB_INVALID, "%s could not be measured", name);
    return gate.status;
}

static const char *plural(size_t count)
{
    return count == 1 ? "" : "s";
}

static void judge(struct rb_gate_report *report)
{
    char worst[RB_GATE_TEXT_MAX];
    size_t compared = 0, grown = report->counts[RB_MOVED_WORSE];
    for (int i = 0; i < RB_MOVED_COUNT; i++)
        compared += report->counts[i];
    rb_gate_report_worst(report, worst);
    if (gate.status)
        rb_gate_report_judge(report, RB_GATE_INVALID, "invalid: %.256s%s%s", gate.error.file,
                             gate.error.file[0] ? ": " : "", gate.error.text);
    else if (grown)
        rb_gate_report_judge(report, RB_GATE_REGRESSED, "regressed: %zu figure%s grew; worst: %s",
                             grown, plural(grown), worst);
    else if (gate.stale)
        rb_gate_report_judge(report, RB_GATE_INVALID,
                             "stale: the program does less than the baseline says, in %zu "
                             "figure%s; run make baseline and commit what it changes",
                             gate.stale, plural(gate.stale));
    else if (!compared || (gate.left_out && gate.arguments->strict))
        rb_gate_report_judge(report, RB_GATE_UNFIT, "unfit: %s could be compared on this machine",
                             compared ? "not everything" : "nothing");
    else
        rb_gate_report_judge(report, RB_GATE_FINE, "fine: %zu figures compared, %zu waived",
                             compared, report->counts[RB_MOVED_WAIVED]);
}

static int finish(void)
{
    int code = RB_GATE_FINE;
    struct rb_gate_report *report = &gate.report;
    if (gate.status)
        rb_report(gate.status, &gate.error);
    if (gate.arguments->bench.update) {
        code = gate.status ? RB_GATE_INVALID : RB_GATE_FINE;
    } else {
        judge(report);
        code = rb_gate_report_put(report, gate.arguments->bench.markdown,
                                  gate.arguments->bench.json_file);
    }
    for (int i = 0; i < PLANS_MAX; i++)
        for (int side = 0; side < 2; side++)
            rb_csv_free(&gate.files[i][side]);
    rb_csv_free(&gate.waivers.csv);
    rb_gate_report_free(report);
    return code;
}

static int run(const struct rb_arguments *arguments)
{
    bool told = arguments->positional_count > 0;
    const char *const *plans = told ? arguments->positional : usual_plans;
    int count =
        told ? arguments->positional_count : (int)(sizeof usual_plans / sizeof *usual_plans);
    const char *against = arguments->bench.against;
    gate = (struct gate){.arguments = arguments, .report = {.name = "gate"}};
    gate.baseline = arguments->bench.baseline ? arguments->bench.baseline : "results/baseline";
    if (against && access(against, X_OK) != 0) {
        snprintf(gate.error.file, sizeof gate.error.file, "%.255s", against);
        gate.status =
            rb_error_set(&gate.error, RB_INVALID, "cannot run the program: %s", strerror(errno));
    }
    if (!gate.status)
        gate.status = rb_waivers_load(gate.baseline, &gate.waivers, &gate.report, &gate.error);
    for (int i = 0; i < count && !gate.status; i++) {
        gate.plan_index = i;
        gate.status = run_plan(plans[i], &gate.error);
    }
    return finish();
}
