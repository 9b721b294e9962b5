#define _POSIX_C_SOURCE 200809L
#include "bench/times/render_command.h"
#include "bench/hardware/event_file.h"
#include "bench/times/render_energy.h"

#include "base/memory.h"
#include "bench/times/render_files.h"
#include "bench/times/render_measure.h"
#include "bench/times/render_select.h"
#include "bench/times/timed.h"
#include "cli/commands.h"
#include "measure/clock.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

static const double BUDGET_S = 15 * 60;

static const struct rb_option options[] = {
    {"--budget", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 0.1, 864000,
     "what to spend: 90s, 15m, 1h; default 15m"},
    {"--runs", "N", RB_OPTION_INT, offsetof(struct rb_arguments, bench.runs), 1, 1000,
     "runs of what takes less than a second; default 10"},
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, offsetof(struct rb_arguments, bench.scenes), 0, 0,
     "names or globs, comma-separated; default: all six. Needs --out"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, offsetof(struct rb_arguments, bench.variants), 0,
     0, "names or globs, comma-separated; default: all of this machine. Needs --out"},
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder of table1.csv and table1.md; default report, and README.md then"},
    {"--readme", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, bench.readme), 0, 0,
     "put the block into this file"},
    {"--check", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, bench.check), 0, 0,
     "measure nothing; fail unless the files are what table1.csv makes of them"},
    {"--rewrite", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, bench.rewrite), 0, 0,
     "measure nothing; make the files from table1.csv"},
    {.name = NULL},
};

const struct rb_command rb_command_table = {
    .name = "table",
    .summary = "measure the render times of Table 1 of the 2019 report",
    .synopsis = "[options]",
    .text =
        "Times whole processes, `raybench render SCENE --variant V -o FILE.ppm --quiet`: the six\n"
        "scenes of the 2019 report, every variant. Writes table1.csv, table1.md and the block\n"
        "between the markers of README.md.\n\n"
        "  raybench table\n"
        "  raybench table --budget 1m --scenes 'balls_*' --out /tmp/table\n"
        "  raybench table --check\n\n"
        "hyperfine keeps the time where it is installed, our own clock where not. All variants\n"
        "must make the same image; one that does not gets no time, and the exit code is 2. What\n"
        "takes over 10 seconds runs once, what takes less than one N times, after a warm-up.\n"
        "Where the budget is too small, the longest runs are scaled up from small images and\n"
        "marked est.",
    .positional_min = 0,
    .positional_max = 0,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

// Where the files are.
struct place {
    const char *folder, *readme; // readme: NULL to leave it alone
    struct rb_render_selection selection;
};

// A table of some rows must not replace that of all of them.
static enum rb_status find_place(const struct rb_arguments *arguments, struct place *place,
                                 struct rb_error *error)
{
    bool partial = arguments->bench.scenes || arguments->bench.variants;
    place->folder = arguments->output ? arguments->output : "report";
    place->readme = arguments->bench.readme ? arguments->bench.readme
                    : arguments->output     ? NULL
                                            : "README.md";
    place->selection =
        (struct rb_render_selection){arguments->bench.scenes, arguments->bench.variants};
    if (arguments->bench.check && arguments->bench.rewrite)
        return rb_error_set(error, RB_INVALID, "--check or --rewrite, not both");
    if (partial && !arguments->output)
        return rb_error_set(error, RB_INVALID,
                            "--scenes and --variants make a part of the table, "
                            "which is not for report/: add --out DIR");
    return RB_OK;
}

// --check and --rewrite: from the CSV to the files.
static enum rb_status from_csv(const struct place *place, bool check, struct rb_error *error)
{
    char path[RB_RENDER_FILE_PATH_MAX];
    struct rb_render_table table;
    struct rb_render_files files;
    enum rb_status status = rb_render_files_csv_path(place->folder, path, error);
    if (status == RB_OK)
        status = rb_render_table_load(path, &table, error);
    if (status == RB_FAILED && access(path, F_OK) != 0)
        return rb_error_set(error, RB_INVALID, "there is no table yet; run make table");
    if (status)
        return status;
    status = rb_render_complete(&place->selection, &table, error);
    if (status)
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, path);
    else
        status = rb_render_files_make(&files, &table, place->folder, place->readme, error);
    if (status == RB_OK) {
        status = check ? rb_render_files_check(&files, error) : rb_render_files_save(&files, error);
        rb_render_files_free(&files);
    }
    rb_render_table_free(&table);
    return status;
}

// What can be found out before minutes are spent: can the files be written?
static enum rb_status check_place(const struct place *place, struct rb_error *error)
{
    const struct rb_render_table nothing = {0};
    struct rb_render_files files;
    if (mkdir(place->folder, 0777) != 0 && errno != EEXIST) {
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1,
                 place->folder);
        return rb_error_set(error, RB_FAILED, "cannot make the folder: %s", strerror(errno));
    }
    enum rb_status status =
        rb_render_files_make(&files, &nothing, place->folder, place->readme, error);
    if (status)
        return status;
    status = rb_render_files_probe(&files, error);
    rb_render_files_free(&files);
    return status;
}

struct origin {
    char cpu_model[128], git_commit[32], utc[32], available[RB_AVAILABLE_ROOM];
};

// The commit we stand in, "-dirty" if the sources are not those of it; "" outside of a checkout.
static void read_commit(char commit[32])
{
    static const char command[] =
        "c=$(git rev-parse --short=7 HEAD 2>/dev/null) && { git diff --quiet HEAD -- :/src :/bench "
        ":/Makefile 2>/dev/null || c=$c-dirty; echo \"$c\"; }";
    FILE *pipe = popen(command, "r");
    if (!pipe || !fgets(commit, 32, pipe))
        commit[0] = '\0';
    commit[strcspn(commit, "\n")] = '\0';
    if (pipe)
        pclose(pipe);
}

static void read_cpu_model(char model[128])
{
    static const char key[] = "model name\t: ";
    char line[128 + sizeof key];
    FILE *file = fopen("/proc/cpuinfo", "r");
    model[0] = '\0';
    while (file && !model[0] && fgets(line, sizeof line, file))
        if (strncmp(line, key, sizeof key - 1) == 0)
            snprintf(model, 128, "%.*s", (int)strcspn(line + sizeof key - 1, "\n"),
                     line + sizeof key - 1);
    if (file)
        fclose(file);
}

static void find_origin(struct origin *origin)
{
    time_t now = time(NULL);
    struct tm utc;
    strftime(origin->utc, sizeof origin->utc, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    read_commit(origin->git_commit);
    read_cpu_model(origin->cpu_model);
    rb_render_available(origin->available);
}

static void announce_plan(const struct rb_render_session *session, double planned_s,
                          double budget_s)
{
    size_t once = 0, extrapolated = 0;
    for (size_t i = 0; i < session->count; i++) {
        once += session->cells[i].runs == 1;
        extrapolated += session->cells[i].runs == 0;
    }
    printf("%zu rows, about %.0f s of a budget of %.0f s; %zu in one run, %zu extrapolated; times "
           "by %s\n",
           session->count, planned_s, budget_s, once, extrapolated,
           session->hyperfine[0] ? session->hyperfine : "our own clock");
    if (planned_s > budget_s)
        printf("The budget is too small even for one run of what takes less than a second.\n");
    fflush(stdout);
}

static enum rb_status measure(const struct rb_arguments *arguments,
                              struct rb_render_session *session, struct rb_render_table *table,
                              struct rb_error *error)
{
    double budget_s = arguments->budget_s > 0 ? arguments->budget_s : BUDGET_S;
    int runs = arguments->bench.runs ? arguments->bench.runs : RB_RUNS_DEFAULT;
    uint64_t start_ns = rb_clock_ns();
    enum rb_status status = rb_render_estimate(session, error);
    if (status)
        return status;
    budget_s -= (double)(rb_clock_ns() - start_ns) * 1e-9;
    announce_plan(session, rb_render_plan(session->cells, session->count, runs, budget_s),
                  budget_s);
    status = rb_render_measure(session, runs, budget_s, table->rows, error);
    if (status == RB_OK)
        status = rb_render_measure_energy(session, rb_hardware_root(), table->rows, error);
    if (status == RB_OK)
        printf("Measured in %.1f s.\n", (double)(rb_clock_ns() - start_ns) * 1e-9);
    return status;
}

static enum rb_status save(const struct place *place, struct rb_render_table *table,
                           const struct origin *origin, struct rb_error *error)
{
    struct rb_render_files files;
    for (struct rb_render_row *row = table->rows; row < table->rows + table->count; row++) {
        row->cpu_model = origin->cpu_model;
        row->git_commit = origin->git_commit;
        row->utc = origin->utc;
        row->available = origin->available;
    }
    rb_render_table_derive(table);
    enum rb_status status =
        rb_render_files_make(&files, table, place->folder, place->readme, error);
    if (status)
        return status;
    status = rb_render_files_save(&files, error);
    for (int i = 0; i < files.count && status == RB_OK; i++)
        printf("%s %s", i ? "," : "Written:", files.files[i].path);
    if (status == RB_OK)
        printf("\n");
    rb_render_files_free(&files);
    return status;
}

// Did the image of any row differ? Those have no time.
static bool any_disagrees(const struct rb_render_session *session)
{
    bool any = false;
    for (size_t i = 0; i < session->count; i++)
        any |= session->disagrees[i];
    return any;
}

static enum rb_status measure_and_save(const struct rb_arguments *arguments,
                                       const struct place *place, struct rb_render_cell *cells,
                                       size_t count, struct rb_error *error)
{
    struct rb_render_session session;
    struct rb_render_table table;
    struct origin origin;
    enum rb_status status = rb_render_table_create(&table, count, error);
    if (status)
        return status;
    status = rb_render_session_open(&session, cells, count, error);
    if (status == RB_OK) {
        find_origin(&origin);
        status = measure(arguments, &session, &table, error);
        if (status == RB_OK)
            status = save(place, &table, &origin, error);
        if (status == RB_OK && any_disagrees(&session))
            status = rb_error_set(error, RB_INVALID, "rows disagree about the image");
        rb_render_session_close(&session);
    }
    rb_render_table_free(&table);
    return status;
}

static int run(const struct rb_arguments *arguments)
{
    struct place place;
    struct rb_error error = {0};
    enum rb_status status = find_place(arguments, &place, &error);
    if (status)
        return rb_report(status, &error);
    if (arguments->bench.check || arguments->bench.rewrite) {
        status = from_csv(&place, arguments->bench.check, &error);
        return status ? rb_report(status, &error) : 0;
    }
    struct rb_render_cell *cells = NULL;
    size_t count = 0;
    status = rb_render_select(&place.selection, &cells, &count, &error);
    if (status == RB_OK)
        status = check_place(&place, &error);
    if (status == RB_OK)
        status = measure_and_save(arguments, &place, cells, count, &error);
    rb_free(cells);
    int code = status ? rb_report(status, &error) : 0;
    if (rb_timed_interrupted())
        raise(rb_timed_interrupted());
    return code;
}
