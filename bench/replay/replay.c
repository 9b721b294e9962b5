// `raybench replay`: one kernel alone on recorded rays, in processes of its own, next to what the
// same kernel takes in whole frames. Process p of every unit and of the frames run in round p, so
// that they are neighbours in time; every other round goes backwards.
#include "bench/replay/replay.h"

#include "bench/replay/record.h"
#include "bench/replay/replay_evidence.h"
#include "bench/replay/source.h"
#include "bench/run/process.h"
#include "bench/run/reference.h"
#include "bench/run/session.h"
#include "bench/run/simulate_cell.h"
#include "cli/commands.h"
#include "measure/affinity.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--seconds", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 0.01, 1e6,
     "time for each kernel and bounce, and for the frames next to them; default 1"},
    {"--processes", "N", RB_OPTION_INT, BENCH(processes), 1, 1000,
     "processes it is shared among; default 6, the fewest with a 95 % interval"},
    {"--mode", "time|count|simulate|hardware|energy", RB_OPTION_TEXT, BENCH(mode), 0, 0,
     "what to find out: time; exact counts of what the kernels do; instructions and misses, from "
     "valgrind, of some of the batches; what the processor's counters say; or its energy, as "
     "--energy; default time"},
    {"--l1", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(l1), 0, 0,
     "simulated L1 data cache, such as 32K,8; default: this machine's"},
    {"--ll", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(ll), 0, 0,
     "simulated last-level cache, such as 32M,16; default: this machine's"},
    {"--list", NULL, RB_OPTION_FLAG, BENCH(list), 0, 0, "print what is in the file, and end"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0,
     "no progress, no warnings"},
    {.name = NULL},
};

const struct rb_command rb_command_replay = {
    .name = "replay",
    .summary = "run one kernel on recorded rays, again and again, and time it",
    .synopsis = "FILE [options]",
    .text = "FILE is what `raybench record` has written.\n\n"
            "  raybench replay balls_high.rays --variant bvh --kernel trace --bounce 1\n"
            "  raybench replay balls_high.rays --variant packet\n"
            "  raybench replay mount_high.rays --class diffuse --seconds 5\n\n"
            "Every process first holds what the kernel gives against the record, bit for bit:\n"
            "rays of generate, hits of trace, shadow rays of shade, answers of trace_shadow. What\n"
            "differs gets no time, and the exit code is 2. Rows are serial: a kernel alone has no\n"
            "threads. `in place` is the same kernel of the same row in whole frames, measured in\n"
            "turn; their ratio is that of neighbours in time.",
    .positional_min = 1,
    .positional_max = 1,
    .groups =
        (const struct rb_option *const[]){options, rb_options_choice, rb_options_hardware, NULL},
    .run = run,
};

enum { PROCESSES_DEFAULT = 6, CPUS_MAX = 1024 };
static const double SECONDS_DEFAULT = 1.0;

// One processor for all processes of a round: neighbours in time and in place.
static int choose_cpu(int round)
{
    static int cpus[CPUS_MAX], count = -1;
    if (count < 0)
        count = rb_affinity_list(cpus, CPUS_MAX);
    return count < 1 ? -1 : cpus[round % count];
}

static int process_count(const struct rb_arguments *arguments)
{
    return arguments->bench.processes ? arguments->bench.processes : PROCESSES_DEFAULT;
}

void rb_replay_unit_words(const struct rb_replay_run *run, const struct rb_replay_unit *unit,
                          struct rb_worker_words *words)
{
    rb_worker_word(words, "%s", run->program);
    rb_worker_word(words, "replay-worker");
    rb_worker_word(words, "--variant=%s", unit->cell.variant->name);
    rb_worker_word(words, "--kernel=%s", rb_stage_names[unit->choice.kernel]);
    rb_worker_word(words, "--class=%s", rb_ray_class_names[unit->choice.ray_class]);
    rb_worker_word(words, "--bounce=%d", unit->choice.bounce);
}

// Seconds of a process.
static double slice_s(const struct rb_arguments *arguments)
{
    double seconds = arguments->budget_s > 0 ? arguments->budget_s : SECONDS_DEFAULT;
    return seconds / process_count(arguments);
}

// The command line of a worker that renders frames, which must be those recorded.
static void frame_words(const struct rb_replay_run *run, struct rb_worker_words *words)
{
    const struct rb_record_contents *contents = &run->record.contents;
    rb_reference_words(&run->in_place.settings, run->program, run->in_place.variant, words);
    if (run->in_place.group_tiles)
        rb_worker_word(words, "--group-tiles=%u", run->in_place.group_tiles);
    else if (run->in_place.variant->exact)
        rb_worker_word(words, "--expect=%" PRIx64 ":%" PRIx64, contents->image_hash,
                       contents->hits_hash);
}

static bool keep_sample(void *user, const struct rb_sample *sample)
{
    return sample->mismatch || rb_cell_add(user, sample);
}

// Runs the next process of a cell, `what` in words. Workers that replay say themselves what is not
// as recorded.
static void run_process(struct rb_cell *cell, const struct rb_worker_words *words, bool replays,
                        const char *what)
{
    struct rb_error error = {0}, told = {0};
    enum rb_status status =
        rb_process_run(words, false, sizeof(struct rb_sample), keep_sample, cell, &error);
    if (rb_process_interrupted())
        return;
    cell->process_count += status == RB_OK;
    if (status)
        cell->state = status == RB_INVALID ? RB_CELL_INVALID : RB_CELL_CRASHED;
    if (status == RB_FAILED)
        rb_error_set(&told, status, "%s: %.300s", what, error.text);
    else if (status == RB_INVALID && !replays)
        rb_error_set(&told, status, "%s: image or hits are not those of the record", what);
    if (told.text[0])
        rb_report(status, &told);
}

// Unit `index`, or with -1 the frames.
static void run_turn(struct rb_replay_run *run, const struct rb_arguments *arguments, int index,
                     int round)
{
    struct rb_worker_words words = {.count = 0};
    struct rb_replay_unit *unit = index < 0 ? NULL : &run->units[index];
    struct rb_cell *cell = unit ? &unit->cell : &run->in_place;
    char what[64] = "frames in place";
    if (cell->state != RB_CELL_OPEN || (!unit && !run->frames_wanted))
        return;
    if (unit) {
        rb_replay_unit_words(run, unit, &words);
        snprintf(what, sizeof what, "%s at bounce %d, %s", rb_stage_names[unit->choice.kernel],
                 unit->choice.bounce, rb_ray_class_names[unit->choice.ray_class]);
    } else {
        frame_words(run, &words);
    }
    rb_worker_word(&words, "--slice=%.4f", slice_s(arguments));
    rb_worker_word(&words, "--cpu=%d", choose_cpu(round));
    rb_worker_word(&words, "--process=%d", round);
    rb_worker_word(&words, "--");
    rb_worker_word(&words, "%s", unit ? run->path : run->reference.scene_name);
    if (!arguments->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\rprocess %d of %d: %s\033[K\r", round + 1, process_count(arguments),
                what);
    run_process(cell, &words, unit != NULL, what);
}

static void run_rounds(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    int turns = run->unit_count + 1;
    for (int round = 0; round < process_count(arguments); round++)
        for (int turn = 0; turn < turns && !rb_process_interrupted(); turn++)
            run_turn(run, arguments, (round % 2 ? turns - 1 - turn : turn) - 1, round);
    if (!arguments->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\033[K");
}

// Everything in the record that was asked for, kernel after kernel; the image alone has all four.
static void make_units(struct rb_replay_run *run, const struct rb_variant *variant, int kernel,
                       int ray_class, int bounce)
{
    for (int c = 0; c < RB_CLASS_COUNT; c++)
        for (int k = 0; k < RB_KERNEL_COUNT; k++)
            for (int b = 0; b < RB_BOUNCE_MAX; b++) {
                enum rb_batch_kind kind = rb_kernel_batch_kind((enum rb_stage)k);
                bool others = k == RB_STAGE_TRACE || k == RB_STAGE_TRACE_SHADOW;
                bool there = run->record.contents.of[c][kind][b].rays &&
                             (c == RB_CLASS_IMAGE || others) && (k != RB_STAGE_GENERATE || b == 0);
                bool asked = (kernel < 0 || kernel == k) && (bounce < 0 || bounce == b) &&
                             (ray_class == RB_CLASS_COUNT || ray_class == c);
                if (!there || !asked)
                    continue;
                struct rb_replay_unit *unit = &run->units[run->unit_count++];
                unit->choice = (struct rb_record_choice){(enum rb_ray_class)c, (enum rb_stage)k, b};
                unit->rays = run->record.contents.of[c][kind][b].rays;
                unit->batches = run->record.contents.of[c][kind][b].batches;
                run->frames_wanted |= c == RB_CLASS_IMAGE;
                unit->cell = (struct rb_cell){.variant = variant,
                                              .reference = &run->reference,
                                              .settings = run->reference.settings};
            }
}

static enum rb_status prepare(struct rb_replay_run *run, const struct rb_variant *variant,
                              const struct rb_arguments *arguments, struct rb_error *error)
{
    int kernel, ray_class, bounce;
    if (rb_variant_parallel(variant))
        return rb_error_set(error, RB_INVALID,
                            "replay runs one kernel in one thread; %s has the kernels of the "
                            "serial row %s",
                            variant->name, variant->baseline);
    if (!rb_variant_available(variant))
        return rb_error_set(error, RB_INVALID,
                            "variant %s needs %s, which this machine or build has not",
                            variant->name, variant->needs);
    if (strlen(run->path) >= RB_WORKER_WORD_MAX)
        return rb_error_set(error, RB_INVALID, "the name of the file is longer than %d bytes",
                            RB_WORKER_WORD_MAX - 1);
    enum rb_status status = rb_choice_parse(arguments, &kernel, &ray_class, &bounce, error);
    if (status == RB_OK)
        status = rb_process_self(run->program, sizeof run->program, error);
    if (status)
        return status;
    run->reference.scene_name = run->record.header.scene;
    run->reference.settings = run->record.header.settings;
    run->reference.settings.threads = 1;
    make_units(run, rb_variant_resolve(variant), kernel, ray_class, bounce);
    run->in_place = (struct rb_cell){.variant = rb_variant_resolve(variant),
                                     .reference = &run->reference,
                                     .settings = run->reference.settings};
    if (run->unit_count == 0) {
        snprintf(error->file, sizeof error->file, "%.255s", run->path);
        return rb_error_set(error, RB_INVALID,
                            "no such rays were recorded; --list says what there is");
    }
    return RB_OK;
}

// Frames that take too long are measured in groups of tiles, as bench does.
static void prepare_frames(struct rb_replay_run *run, const struct rb_scene *scene, double slice)
{
    struct rb_reference *reference = &run->reference;
    reference->primitive_count = scene->primitive_count;
    for (int kind = 0; kind < RB_BATCH_KIND_COUNT; kind++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            reference->rays += (double)run->record.contents.of[RB_CLASS_IMAGE][kind][bounce].rays;
    rb_reference_choose_group(&run->in_place, slice);
}

// The exit code: 2 if anything differed, 1 if anything crashed.
static int judge(const struct rb_replay_run *run)
{
    bool invalid = run->in_place.state == RB_CELL_INVALID;
    bool crashed = run->in_place.state == RB_CELL_CRASHED;
    for (int i = 0; i < run->unit_count; i++) {
        invalid |= run->units[i].cell.state == RB_CELL_INVALID;
        crashed |= run->units[i].cell.state == RB_CELL_CRASHED;
    }
    return invalid ? RB_INVALID : crashed ? RB_FAILED : RB_OK;
}

static int measure_times(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    rb_clock_begin();
    rb_process_catch_signals();
    run_rounds(run, arguments);
    run->probe_ns = rb_probe_cost_ns();
    rb_replay_print(run);
    for (int i = 0; i < run->unit_count; i++)
        rb_free(run->units[i].cell.samples);
    rb_free(run->in_place.samples);
    fflush(stdout);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return judge(run);
}

typedef int mode_fn(struct rb_replay_run *run, const struct rb_arguments *arguments);

static const struct {
    const char *name;
    mode_fn *run;
} modes[] = {{"time", measure_times},
             {"count", rb_replay_count},
             {"simulate", rb_replay_simulate},
             {"hardware", rb_replay_hardware},
             {"energy", rb_replay_energy}};

// NULL after reporting an unknown name.
static mode_fn *find_mode(const char *name)
{
    struct rb_error error = {0};
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++)
        if (strcmp(name ? name : modes[0].name, modes[i].name) == 0)
            return modes[i].run;
    rb_error_set(&error, RB_INVALID,
                 "--mode %.64s: there are time, count, simulate, hardware, energy", name);
    rb_report(RB_INVALID, &error);
    return NULL;
}

static int measure(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    struct rb_scene scene;
    mode_fn *mode = find_mode(arguments->bench.energy ? "energy" : arguments->bench.mode);
    if (mode == rb_replay_simulate)
        rb_simulate_mask();
    const struct rb_variant *variant = mode ? rb_replay_variant(arguments) : NULL;
    if (!variant)
        return RB_INVALID;
    enum rb_status status = prepare(run, variant, arguments, &error);
    if (status)
        return rb_report(status, &error);
    int code = rb_record_open_scene(&run->record, run->path, arguments, &scene);
    if (code)
        return code;
    prepare_frames(run, &scene, slice_s(arguments));
    rb_scene_free(&scene);
    rb_replay_print_head(run);
    return mode(run, arguments);
}

static int run(const struct rb_arguments *arguments)
{
    static struct rb_replay_run run;
    struct rb_error error = {0};
    run.path = arguments->positional[0];
    enum rb_status status = rb_record_read(run.path, NULL, &run.record, &error);
    if (status)
        return rb_report(status, &error);
    if (!arguments->bench.list)
        return measure(&run, arguments);
    rb_record_print(&run.record.header, &run.record.contents);
    return 0;
}
