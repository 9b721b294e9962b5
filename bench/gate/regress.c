// Sets of processes of two programs in turn: base against head; then, as often as the noise of this
// host is not known, head against itself; then, if something seems worse, base against head again.
#include "bench/gate/regress.h"

#include "bench/gate/floor.h"
#include "bench/gate/pairs.h"
#include "bench/gate/verdict.h"
#include "bench/gate/waivers.h"
#include "bench/machine/doctor.h"
#include "bench/run/folder.h"
#include "bench/run/process.h"
#include "cli/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--learn", "N", RB_OPTION_INT, BENCH(runs), 1, 100,
     "A/A comparisons that the noise is known from; missing ones are made first; default 3"},
    {"--baseline", "DIR", RB_OPTION_TEXT, BENCH(baseline), 0, 0,
     "folder of waivers.csv; default results/baseline"},
    {"--strict", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, strict), 0, 0,
     "exit code 4 if raybench doctor finds something bad here"},
    {"--markdown", "FILE", RB_OPTION_TEXT, BENCH(markdown), 0, 0,
     "the report as Markdown, for a comment"},
    {"--json", "FILE", RB_OPTION_TEXT, BENCH(json_file), 0, 0, "the report as a JSON object"},
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder for result folders and floor.csv; default results"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0, "no progress"},
    {.name = NULL},
};

const struct rb_command rb_command_regress = {
    .name = "regress",
    .summary = "is any kernel slower than in another build? by the clock, with its noise known",
    .synopsis = "[SCENE...|PLAN] --against PROGRAM [options]",
    .text =
        "Both programs measure in turn, in many processes. For each cell and kernel: the median\n"
        "over pairs of processes of the ratio of their median times, with the interval of the\n"
        "sign test, so wide that all of them hold at once with 95 %. What a host calls different\n"
        "of two equal programs, its noise, is learned for each row from comparisons of this\n"
        "program with itself and kept in DIR/floor.csv. PLAN is a plan of raybench bench;\n"
        "regress comes with the program and is the default.\n\n"
        "  raybench regress --against ../old/build/raybench\n"
        "  raybench regress balls_high --variants bvh --against ../old/build/raybench\n\n"
        "Worse is a row whose whole interval lies above its noise, whose tenth percentile agrees,\n"
        "and which is found so again in a fresh set of processes. The same is one whose interval\n"
        "lies within the noise. Everything else is inconclusive. Single bounces can be worse or\n"
        "better, but do not make a comparison inconclusive. DIR/waivers.csv of --baseline holds\n"
        "for the figure ms. `make regress BASE=REV` builds the base.\n\n"
        "Exit codes: 0 nothing is worse; 1 something is; 2 no verdict: another image, a program\n"
        "that fails, a broken file; 3 inconclusive; 4 with --strict, this machine is not fit.",
    .positional_min = 0,
    .positional_max = 8,
    .groups = (const struct rb_option *const[]){rb_options_pairs, options, NULL},
    .run = run,
};

enum { LEARN_DEFAULT = 3 };

static struct regress {
    const struct rb_arguments *arguments;
    const char *folder; // of result folders
    char self[RB_PATH_MAX];
    struct rb_gate_report report;
    struct rb_waivers waivers;
    struct rb_floor floor;
    struct rb_pairs first, second;
    size_t suspects; // rows that seem worse after the first set
} regress;

// The fewest A/A comparisons that any row's floor comes from.
static size_t known_runs(const struct rb_comparison *comparison)
{
    size_t least = SIZE_MAX, runs;
    for (size_t i = 0; i < comparison->cell_count; i++)
        for (size_t r = 0; r < comparison->cells[i].row_count; r++) {
            const struct rb_compare_row *row =
                &comparison->rows[comparison->cells[i].first_row + r];
            rb_floor_find(&regress.floor, comparison->cells[i].a, row, &runs);
            least = runs < least ? runs : least;
        }
    return least;
}

static enum rb_status learn(struct rb_error *error)
{
    size_t wanted = regress.arguments->bench.runs ? (size_t)regress.arguments->bench.runs
                                                  : (size_t)LEARN_DEFAULT;
    size_t known = known_runs(&regress.first.median);
    enum rb_status status = RB_OK;
    for (; known < wanted && !status; known++) {
        if (!regress.arguments->quiet)
            fprintf(stderr, "raybench: learning the noise of this host, %zu of %zu\n", known + 1,
                    wanted);
        status = rb_pairs_measure(regress.arguments, regress.self, &regress.second, error);
        if (!status)
            status = rb_floor_learn(&regress.floor, &regress.second.median, error);
    }
    return status;
}

static struct rb_gate_row judge_row(const struct rb_pairs *set, size_t cell, size_t index)
{
    const struct rb_compare_row *median = &set->median.rows[index], *low = &set->low.rows[index];
    size_t runs;
    struct rb_gate_row row = {
        .cell = *set->median.cells[cell].a,
        .kernel = rb_timed_kernels[median->kernel].name,
        .bounce = median->bounce,
        .figure = "ms",
        .mode = "time",
        .base = median->a_ns * 1e-6,
        .head = median->b_ns * 1e-6,
        .ratio = median->ratio.value,
        .low = median->ratio.low,
        .high = median->ratio.high,
    };
    row.floor = rb_floor_find(&regress.floor, &row.cell, median, &runs);
    row.moved = rb_gate_judge(&median->ratio, &low->ratio, row.floor);
    return row;
}

typedef void row_fn(size_t cell, size_t index, const struct rb_gate_row *row);

static void for_each_row(const struct rb_pairs *set, row_fn *call)
{
    for (size_t i = 0; i < set->median.cell_count; i++)
        for (size_t r = 0; r < set->median.cells[i].row_count; r++) {
            size_t index = set->median.cells[i].first_row + r;
            struct rb_gate_row row = judge_row(set, i, index);
            call(i, index, &row);
        }
}

static void count_suspect(size_t cell, size_t index, const struct rb_gate_row *row)
{
    (void)cell, (void)index;
    regress.suspects += row->moved == RB_MOVED_WORSE;
}

// Both sets measure the same cells, so their rows stand alike. What was confirmed is told with the
// figures of the second set: those of the first are the higher for having been chosen.
static void report_row(size_t cell, size_t index, const struct rb_gate_row *first)
{
    struct rb_gate_row row = *first;
    if (row.moved == RB_MOVED_WORSE) {
        row = judge_row(&regress.second, cell, index);
        if (row.moved != RB_MOVED_WORSE) {
            row.moved = RB_MOVED_UNDECIDED;
            snprintf(row.reason, sizeof row.reason, "worse at first, by %.2f %%, and not again",
                     100 * (first->ratio - 1));
        }
        rb_waivers_apply(&regress.waivers, &row);
    }
    bool whole = row.bounce == RB_ALL_BOUNCES;
    if (whole || row.moved != RB_MOVED_UNDECIDED)
        rb_gate_report_add(&regress.report, &row, whole || row.moved != RB_MOVED_NOT);
}

static void judge(struct rb_gate_report *report)
{
    char worst[RB_GATE_TEXT_MAX];
    size_t slower = report->counts[RB_MOVED_WORSE], open = report->counts[RB_MOVED_UNDECIDED];
    rb_gate_report_worst(report, worst);
    if (slower)
        rb_gate_report_judge(report, RB_GATE_REGRESSED,
                             "regressed: %zu row%s slower, confirmed; worst: %s", slower,
                             slower == 1 ? " is" : "s are", worst);
    else if (open)
        rb_gate_report_judge(report, RB_GATE_INCONCLUSIVE,
                             "inconclusive: %zu row%s not decided; more time (--budget) or a "
                             "quieter machine would tell",
                             open, open == 1 ? " is" : "s are");
    else
        rb_gate_report_judge(report, RB_GATE_FINE, "fine: no row is slower by more than its noise");
}

static enum rb_status decide(struct rb_error *error)
{
    const char *against = regress.arguments->bench.against;
    enum rb_status status = rb_pairs_measure(regress.arguments, against, &regress.first, error);
    if (!status)
        status = learn(error);
    if (status)
        return status;
    for_each_row(&regress.first, count_suspect);
    if (regress.suspects)
        status = rb_pairs_measure(regress.arguments, against, &regress.second, error);
    if (!status && regress.suspects &&
        regress.second.median.row_count != regress.first.median.row_count)
        status = rb_error_set(error, RB_INVALID, "the second set has other rows than the first");
    if (status)
        return status;
    rb_gate_report_note(&regress.report, "base: %.200s; noise of %.200s: %s", against,
                        regress.floor.host, regress.floor.path);
    for_each_row(&regress.first, report_row);
    judge(&regress.report);
    return RB_OK;
}

// Not fit: something bad that touches timings.
static bool is_fit(struct rb_gate_report *report)
{
    struct rb_machine machine;
    struct rb_doctor doctor;
    bool fit = true;
    rb_machine_read(&machine, "");
    rb_doctor_examine(&doctor, &machine);
    for (int i = 0; i < doctor.count; i++)
        if (doctor.checks[i].scored && doctor.checks[i].state == RB_CHECK_BAD) {
            fit = false;
            rb_gate_report_note(report, "%s: %s", doctor.checks[i].name, doctor.checks[i].found);
        }
    return fit;
}

static enum rb_status begin(struct rb_error *error)
{
    const struct rb_bench_arguments *bench = &regress.arguments->bench;
    const char *baseline = bench->baseline ? bench->baseline : "results/baseline";
    if (!bench->against)
        return rb_error_set(error, RB_INVALID,
                            "give the base with --against PROGRAM; make regress BASE=REV builds "
                            "it");
    enum rb_status status = rb_process_self(regress.self, sizeof regress.self, error);
    if (!status)
        status = rb_waivers_load(baseline, &regress.waivers, &regress.report, error);
    return status ? status : rb_floor_load(regress.folder, &regress.floor, error);
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    struct rb_gate_report *report = &regress.report;
    regress = (struct regress){.arguments = arguments, .report = {.name = "regress"}};
    regress.folder = arguments->output ? arguments->output : "results";
    enum rb_status status = begin(&error);
    if (!status && arguments->strict && !is_fit(report))
        rb_gate_report_judge(report, RB_GATE_UNFIT, "unfit: see raybench doctor");
    else if (!status)
        status = decide(&error);
    if (status) {
        rb_report(status, &error);
        rb_gate_report_judge(report, RB_GATE_INVALID, "invalid: %s", error.text);
    }
    int code = rb_gate_report_put(report, arguments->bench.markdown, arguments->bench.json_file);
    rb_pairs_free(&regress.first);
    rb_pairs_free(&regress.second);
    rb_csv_free(&regress.floor.csv);
    rb_csv_free(&regress.waivers.csv);
    rb_gate_report_free(report);
    return code;
}
