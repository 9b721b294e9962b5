// `raybench versus`: for every class of rays of a scene, our best row against Embree's best mode.
// First all rows answer a sample of the rays, in this process; then the best of either side
// measure all of them, in processes in turn, so that both have the same neighbours in time.
#include "bench/data/names.h"
#include "bench/replay/record.h"
#include "bench/run/process.h"
#include "bench/versus/pages.h"
#include "bench/versus/session.h"
#include "cli/commands.h"
#include "embree/embree.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--budget", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 1, 1e6,
     "time for everything, about, shared among the scenes; if too short fewer processes run, two "
     "at "
     "least; default: 0.5 s a process"},
    {"--processes", "N", RB_OPTION_INT, BENCH(processes), 1, 1000,
     "processes of either side; default 6, the fewest with a 95 % interval"},
    {"--class", "primary|shadow|reflection|refraction|diffuse,...", RB_OPTION_TEXT, BENCH(classes),
     0, 0, "rays; default all"},
    {"--threads", "N", RB_OPTION_INT, offsetof(struct rb_arguments, settings.threads), 1,
     RB_THREADS_MAX, "threads at most; 1: one alone; default: one, and all there are"},
    {"--size", "WxH", RB_OPTION_SIZE, offsetof(struct rb_arguments, settings), 1, RB_SIZE_MAX,
     "image whose pixels the rays start from; default 1024x1024"},
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder for result folders; default results"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0, "no progress"},
    {.name = NULL},
};

const struct rb_command rb_command_versus = {
    .name = "versus",
    .summary = "our best row against Embree's best mode, for every class of rays",
    .synopsis = "[SCENE...] [options]",
    .text =
        "Needs a build with libembree. Scenes: balls_high balls6 mount6 mount9 mount10, unless "
        "told.\n\n"
        "  raybench versus balls_high --processes 10\n"
        "  raybench versus mount6 mount9 --class primary,shadow --budget 2m\n\n"
        "Rays are those of `raybench record --classes all`. Embree's mode is the fastest of\n"
        "single rays, packets of 8 and 16, streams, coherent or not, either build quality,\n"
        "either kind of spheres, AVX2 or AVX-512, shadow rays from the point or from the\n"
        "light, found with one thread on a sample of the rays for each class; our row is found\n"
        "likewise. Both then measure all rays, one process after the other, with one thread\n"
        "and with all, which take batches of at most 4096 rays in turn. The memory of both\n"
        "sides asks for huge pages, unless GLIBC_TUNABLES is set. Writes versus.csv to a new\n"
        "folder of DIR, and results/latest.",
    .positional_min = 0,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

const struct rb_versus_class rb_versus_classes[RB_VERSUS_CLASS_COUNT] = {
    {"primary", {RB_CLASS_IMAGE, RB_STAGE_TRACE, 0}},
    {"shadow", {RB_CLASS_SHADOW, RB_STAGE_TRACE_SHADOW, 0}},
    {"reflection", {RB_CLASS_REFLECTION, RB_STAGE_TRACE, 1}},
    {"refraction", {RB_CLASS_REFRACTION, RB_STAGE_TRACE, 1}},
    {"diffuse", {RB_CLASS_DIFFUSE, RB_STAGE_TRACE, 1}},
};

static const char *const plan[] = {"balls_high", "balls6", "mount6", "mount9", "mount10"};

enum { SIZE_DEFAULT = 1024 };

// The contests of a scene: all classes of rays with one thread, then with all.
static void begin_contests(struct rb_versus_session *session, int scene,
                           const struct rb_scene *loaded, struct rb_contest *contests)
{
    struct rb_reference *reference = &session->reference[scene];
    *reference = (struct rb_reference){.scene_name = session->scenes[scene],
                                       .primitive_count = loaded->primitive_count};
    for (int i = 0; i < session->scene_contests; i++) {
        int threads = i / RB_VERSUS_CLASS_COUNT, c = i % RB_VERSUS_CLASS_COUNT;
        contests[i] = (struct rb_contest){.scene = session->scenes[scene],
                                          .rays_name = rb_versus_classes[c].name,
                                          .rays = &rb_versus_classes[c],
                                          .primitive_count = loaded->primitive_count,
                                          .threads = session->thread_counts[threads],
                                          .single = threads ? &contests[c] : NULL,
                                          .trees = &session->trees[scene][threads],
                                          .tests = rb_versus_untested};
        session->contest_count++;
    }
}

// Rows that were chosen with one thread stand for all.
static void name_rows(const struct rb_versus_session *session, int scene,
                      struct rb_contest *contests)
{
    for (int i = 0; i < session->scene_contests; i++)
        for (int side = 0; side < 2; side++) {
            struct rb_contest *contest = &contests[i];
            struct rb_versus_side *one = &contest->side[side];
            if (contest->single) {
                contest->ray_count = contest->single->ray_count;
                contest->tests = contest->single->tests;
                *one = contest->single->side[side];
            }
            one->cell.variant = one->row;
            one->cell.reference = (struct rb_reference *)(uintptr_t)&session->reference[scene];
            one->cell.state = one->row ? RB_CELL_OPEN : RB_CELL_UNAVAILABLE;
        }
}

// Records the rays with our fastest serial row: they are the same for every row.
static int record(const struct rb_versus_session *session, const char *scene, const char *path)
{
    struct rb_arguments arguments = {
        .positional = {scene},
        .positional_count = 1,
        .settings = session->arguments->settings,
        .output = path,
        .quiet = true,
        .bench = {.classes = "all"},
    };
    struct rb_settings *settings = &arguments.settings;
    settings->depth = 1;
    settings->width = settings->width ? settings->width : SIZE_DEFAULT;
    settings->height = settings->height ? settings->height : SIZE_DEFAULT;
    for (const struct rb_variant *row = rb_variants; row->name; row++)
        if (row->exact && !row->best_of && !rb_variant_parallel(row) && rb_variant_available(row))
            arguments.variant = row->name;
    return rb_command_record.run(&arguments);
}

static int contend(struct rb_versus_session *session, int index, const char *path)
{
    struct rb_contest *contests = &session->contests[session->contest_count];
    const char *name = session->scenes[index];
    struct rb_error error = {0};
    struct rb_scene scene;
    rb_versus_tell(session, name, "recording rays");
    int code = record(session, name, path);
    if (code)
        return code;
    uint64_t start_ns = rb_clock_ns();
    code = rb_open_scene(name, session->arguments, &scene);
    if (code)
        return code;
    double load_s = (double)(rb_clock_ns() - start_ns) * 1e-9;
    begin_contests(session, index, &scene, contests);
    enum rb_status status = RB_OK;
    rb_versus_tell(session, name, "building trees");
    for (int t = 0; t < session->scene_contests / RB_VERSUS_CLASS_COUNT && status == RB_OK; t++)
        status =
            rb_versus_build(&scene, session->thread_counts[t], &session->trees[index][t], &error);
    rb_versus_tell(session, name, "looking for the best rows");
    if (status == RB_OK)
        status = rb_versus_choose(path, &scene, load_s, contests, &error);
    rb_scene_free(&scene);
    if (status)
        return rb_report(status, &error);
    name_rows(session, index, contests);
    rb_versus_measure(session, contests, index, path);
    return 0;
}

static int write_csv(const struct rb_versus_session *session)
{
    static struct rb_output output;
    struct rb_error error = {0};
    char path[RB_PATH_MAX + 16];
    const char *parent = session->arguments->output ? session->arguments->output : "results";
    snprintf(path, sizeof path, "%s/versus.csv", session->folder);
    enum rb_status status = rb_output_open(&output, path, &error);
    if (status == RB_OK) {
        rb_versus_write(output.stream, session->contests, session->contest_count);
        status = rb_output_commit(&output, &error);
    }
    if (status == RB_OK)
        status = rb_folder_link_latest(parent, session->folder, &error);
    if (status)
        return rb_report(status, &error);
    printf("\n%s\n", path);
    return 0;
}

static enum rb_status check_classes(const char *list, struct rb_error *error)
{
    char item[RB_NAME_MAX];
    while (list && rb_names_next(&list, item)) {
        bool known = false;
        for (int c = 0; c < RB_VERSUS_CLASS_COUNT; c++)
            known = known || rb_name_matches(item, rb_versus_classes[c].name);
        if (!known)
            return rb_error_set(error, RB_INVALID,
                                "--class: there are no rays '%.64s'; there are primary, shadow, "
                                "reflection, refraction, diffuse",
                                item);
    }
    return RB_OK;
}

static enum rb_status begin(struct rb_versus_session *session, const struct rb_arguments *arguments,
                            struct rb_error *error)
{
    *session = (struct rb_versus_session){.arguments = arguments, .start_ns = rb_clock_ns()};
    bool told = arguments->positional_count > 0;
    session->scenes = told ? arguments->positional : plan;
    session->scene_count = told ? arguments->positional_count : (int)(sizeof plan / sizeof *plan);
    int most = rb_threads_default(), asked = arguments->settings.threads;
    session->thread_counts[0] = 1;
    session->thread_counts[1] = asked && asked < most ? asked : most;
    session->scene_contests = RB_VERSUS_CLASS_COUNT * (session->thread_counts[1] > 1 ? 2 : 1);
    if (!rb_embree_version())
        return rb_error_set(error, RB_INVALID, "versus needs libembree: run make setup, then make");
    const char *parent = arguments->output ? arguments->output : "results";
    enum rb_status status = check_classes(arguments->bench.classes, error);
    if (status == RB_OK)
        status = rb_process_self(session->program, sizeof session->program, error);
    if (status == RB_OK)
        rb_versus_restart(session->program);
    if (status == RB_OK)
        status = rb_folder_check(parent, error);
    if (status == RB_OK)
        status = rb_folder_make(parent, session->folder, error);
    return status;
}

static int run(const struct rb_arguments *arguments)
{
    static struct rb_versus_session session;
    struct rb_error error = {0};
    char path[RB_PATH_MAX + 16];
    enum rb_status status = begin(&session, arguments, &error);
    if (status)
        return rb_report(status, &error);
    int code = 0;
    rb_clock_begin();
    rb_process_catch_signals();
    snprintf(path, sizeof path, "%s/versus.rays", session.folder);
    for (int i = 0; i < session.scene_count && !code && !rb_process_interrupted(); i++)
        code = contend(&session, i, path);
    unlink(path);
    rb_versus_tell(&session, "", "");
    rb_versus_print(session.contests, session.contest_count);
    int written = write_csv(&session); // of what there is, also after a failure
    for (size_t i = 0; i < session.contest_count; i++)
        for (int side = 0; side < 2; side++)
            rb_cell_release(&session.contests[i].side[side].cell);
    fflush(stdout);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return code ? code : session.failed ? RB_FAILED : written;
}
