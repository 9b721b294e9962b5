// `raybench bench`: every row of the table on every scene asked for.
#define _POSIX_C_SOURCE 200809L
#include "bench/bench.h"

#include "base/file.h"
#include "bench/csv.h"
#include "bench/folder.h"
#include "bench/table.h"
#include "cli/commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--budget", "S", RB_OPTION_NUMBER, offsetof(struct rb_arguments, budget_s), 0.1, 86400,
     "seconds to spend measuring, all scenes together; default 10 per scene"},
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder for result folders; default results"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0, "no warnings"},
    {.name = NULL},
};

const struct rb_command rb_command_bench = {
    .name = "bench",
    .summary = "measure time per ray, by kernel and bounce, of every variant",
    .synopsis = "[SCENE...] [options]",
    .text = RB_HELP_SCENE
    " Default: the six scenes of the 2019\n"
    "report.\n\n"
    "  raybench bench\n"
    "  raybench bench balls_high --budget 10\n\n"
    "Every row must first render the same pixels and hits as the reference; one that does not\n"
    "gets no time, and the exit code is 2. Frames of all rows are timed in turn. Where the\n"
    "reference would take too long, it renders a seeded random sample of small tiles, its\n"
    "figures are marked est. and the interval is that of the sample. Figures are medians.\n"
    "Results are kept in DIR/latest/kernels.csv; results/README.md explains the columns.",
    .positional_min = 0,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){options, rb_options_settings, rb_options_levels,
                                                rb_options_threads, rb_options_strict, NULL},
    .run = run,
};

// The results in the making. The CSV is kept in memory and saved after every scene, so that an
// interrupted run leaves whole files of what it has measured.
struct session {
    const struct rb_arguments *arguments;
    const char *parent;
    char folder[RB_PATH_MAX]; // "" until there is something to save
    char *text;
    size_t length;
    FILE *csv; // writes to `text`
    double scene_budget_s;
    double probe_ns, probe_worst;
    bool mismatch;
};

static enum rb_status save(struct session *session, struct rb_error *error)
{
    char path[RB_PATH_MAX + 16];
    struct rb_output output;
    if (fflush(session->csv) != 0)
        return rb_error_memory(error, "the results");
    enum rb_status status = RB_OK;
    if (!session->folder[0])
        status = rb_folder_make(session->parent, session->folder, error);
    if (status)
        return status;
    snprintf(path, sizeof path, "%s/kernels.csv", session->folder);
    status = rb_output_open(&output, path, error);
    if (status)
        return status;
    fwrite(session->text, 1, session->length, output.stream);
    status = rb_output_commit(&output, error);
    return status ? status : rb_folder_link_latest(session->parent, session->folder, error);
}

static int bench_scene(struct session *session, const char *name)
{
    static struct rb_scene_bench bench; // too large for the stack
    struct rb_scene scene;
    struct rb_error error = {0};
    int code = rb_open_scene(name, session->arguments, &scene);
    if (code)
        return code;
    enum rb_status status = rb_scene_bench_run(&bench, name, &scene, &session->arguments->settings,
                                               session->scene_budget_s, &error);
    if (status == RB_OK) {
        rb_table_print(&bench);
        rb_csv_rows(session->csv, &bench);
        session->mismatch |= bench.mismatch;
        for (int i = 0; i < bench.row_count; i++) {
            double share = rb_row_probe_share(&bench.rows[i], session->probe_ns);
            if (share > session->probe_worst)
                session->probe_worst = share;
        }
    }
    rb_scene_bench_free(&bench);
    rb_scene_free(&scene);
    if (status == RB_OK)
        status = save(session, &error);
    return status ? rb_report(status, &error) : 0;
}

// A line that the table of the scene replaces, for those who watch a terminal.
static void announce(const struct session *session, const char *name, int index, int count)
{
    if (isatty(STDERR_FILENO) && !session->arguments->quiet)
        fprintf(stderr, "\rmeasuring %s (%d of %d), about %.0f s left ...\033[K\r", name, index + 1,
                count, session->scene_budget_s * (count - index));
}

static int bench_scenes(struct session *session)
{
    const struct rb_arguments *arguments = session->arguments;
    int count = arguments->positional_count, code = 0;
    if (count == 0)
        while (rb_presets[count].name)
            count++;
    session->scene_budget_s = arguments->budget_s > 0 ? arguments->budget_s / count : 10;
    session->probe_ns = rb_probe_cost_ns();
    for (int i = 0; i < count && code == 0; i++) {
        const char *name =
            arguments->positional_count ? arguments->positional[i] : rb_presets[i].name;
        announce(session, name, i, count);
        code = bench_scene(session, name);
    }
    if (code == 0)
        rb_table_print_probes(session->probe_ns, session->probe_worst);
    return code;
}

static int run(const struct rb_arguments *arguments)
{
    struct session session = {
        .arguments = arguments,
        .parent = arguments->output ? arguments->output : "results",
    };
    struct rb_error error = {0};
    enum rb_status status = rb_folder_check(session.parent, &error);
    if (status)
        return rb_report(status, &error);
    session.csv = open_memstream(&session.text, &session.length);
    if (!session.csv)
        return rb_report(rb_error_memory(&error, "the results"), &error);
    rb_csv_header(session.csv);
    int code = bench_scenes(&session);
    fclose(session.csv);
    free(session.text);
    if (code == 0)
        printf("Results are in %s/kernels.csv.\n", session.folder);
    return code ? code : session.mismatch ? RB_INVALID : 0;
}
