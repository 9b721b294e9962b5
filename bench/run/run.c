#define _POSIX_C_SOURCE 200809L
#include "bench/run/run.h"

#include "base/hash.h"
#include "base/memory.h"
#include "bench/run/process.h"
#include "bench/run/reference.h"
#include "bench/run/samples_file.h"
#include "cli/commands.h"
#include "measure/affinity.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// The least number of processes with a 95 % interval of their median (order statistics); and pairs
// enough for verdicts that hold for dozens of rows at once with 99 %.
enum { PROCESSES_DEFAULT = 6, PAIRS_DEFAULT = 16, CPUS_MAX = 1024, PADDING_MAX = 4096 };

// A unit is a cell, or with two programs the cell of each.
static struct rb_cell *cell_of(const struct rb_run *run, int unit, int side)
{
    return &run->plan->cells[side * run->unit_count + unit];
}

int rb_run_processes(const struct rb_run *run)
{
    int asked = run->plan->arguments.bench.processes;
    int fallback = run->side_count == 2 ? PAIRS_DEFAULT : PROCESSES_DEFAULT;
    return asked ? asked : fallback;
}

static bool is_open(const struct rb_run *run, int unit)
{
    bool open = true;
    for (int side = 0; side < run->side_count; side++)
        open = open && cell_of(run, unit, side)->state == RB_CELL_OPEN;
    return open;
}

static uint32_t processes_of(const struct rb_run *run, int unit)
{
    return cell_of(run, unit, run->side_count - 1)->process_count;
}

static int processes_missing(const struct rb_run *run)
{
    int missing = 0;
    for (int unit = 0; unit < run->unit_count; unit++) {
        int has = (int)processes_of(run, unit), wanted = rb_run_processes(run);
        if (is_open(run, unit) && has < wanted)
            missing += (wanted - has) * run->side_count;
    }
    return missing;
}

static double elapsed_s(const struct rb_run *run)
{
    return (double)(rb_clock_ns() - run->start_ns) * 1e-9;
}

// Seconds until the run ends, about.
static double left_s_of(const struct rb_run *run)
{
    double left_s = run->budget_s - elapsed_s(run), least_s = 0;
    for (int unit = 0; unit < run->unit_count; unit++) {
        int missing = rb_run_processes(run) - (int)processes_of(run, unit);
        for (int side = 0; side < run->side_count && missing > 0; side++)
            least_s += missing * cell_of(run, unit, side)->cost_s;
    }
    return left_s > 0.8 * least_s ? left_s : least_s;
}

// A line that is overwritten on a terminal; elsewhere one line per round.
static void show_progress(const struct rb_run *run, const struct rb_cell *cell, bool round_ends)
{
    uint32_t round = cell->process_count;
    if (run->quiet)
        return;
    if (isatty(STDERR_FILENO))
        fprintf(stderr, "\rprocess %u of %d: %s, %s; about %.0f s left\033[K\r", round + 1,
                rb_run_processes(run), cell->reference->scene_name, cell->variant->name,
                left_s_of(run));
    else if (round_ends)
        fprintf(stderr, "raybench: %u of %d processes a cell are done; about %.0f s left\n", round,
                rb_run_processes(run), left_s_of(run));
}

struct taker {
    struct rb_run *run;
    struct rb_cell *cell;
};

static bool take(void *user, const struct rb_sample *sample)
{
    struct taker *taker = user;
    if (sample->mismatch) // its times are worth nothing
        return true;
    rb_samples_write(taker->run->sides[taker->cell->side].samples, taker->cell, sample);
    return rb_cell_add(taker->cell, sample);
}

// One process on one processor after the other; parallel rows have them all.
static int choose_cpu(const struct rb_cell *cell)
{
    static int cpus[CPUS_MAX], count = -1;
    if (count < 0)
        count = rb_affinity_list(cpus, CPUS_MAX);
    if (rb_variant_parallel(cell->variant) || count < 1)
        return -1;
    return cpus[cell->process_count % (uint32_t)count];
}

// Each process has an environment of another size, and with it a stack that begins elsewhere: where
// things happen to lie can move times by more than a change does, and would move all processes of a
// program alike (Mytkowicz, Diwan, Hauswirth, Sweeney 2009, "Producing wrong data without doing
// anything obviously wrong!").
static void pad_environment(const struct rb_run *run, const struct rb_cell *cell)
{
    char padding[PADDING_MAX];
    uint64_t word = rb_hash_word((uint64_t)run->started, (uint64_t)(cell - run->plan->cells));
    size_t length = (size_t)(rb_hash_word(word, cell->process_count) % PADDING_MAX);
    memset(padding, 'x', length);
    padding[length] = '\0';
    setenv("ENVIRONMENT_PADDING", padding, 1);
}

static void tell_failure(struct rb_run *run, struct rb_cell *cell, struct rb_error *error)
{
    struct rb_error told = *error;
    snprintf(told.text, sizeof told.text, "%s, %s: %.250s; the cell is left out",
             cell->reference->scene_name, cell->variant->name, error->text);
    rb_report(RB_FAILED, &told);
    cell->state = RB_CELL_CRASHED;
    run->crashed = true;
}

static void tell_mismatch(struct rb_run *run, struct rb_cell *cell)
{
    fprintf(stderr,
            "raybench: %s, %s: image or hits differ from the reference (%s%s); the cell "
            "gets no time\n",
            cell->reference->scene_name, cell->variant->name, cell->reference->made_by,
            cell->reference->cached ? ", kept in reference.csv; if what an image is has changed, "
                                      "delete that file"
                                    : "");
    cell->state = RB_CELL_INVALID;
    run->mismatch = true;
}

// Starts the next process of a cell.
static enum rb_status run_process(struct rb_run *run, struct rb_cell *cell, double slice_s,
                                  struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    struct taker taker = {run, cell};
    struct rb_side *side = &run->sides[cell->side];
    rb_reference_words(&cell->settings, side->program, cell->variant, &words);
    rb_worker_word(&words, "--slice=%.4f", slice_s);
    rb_worker_word(&words, "--cpu=%d", choose_cpu(cell));
    rb_worker_word(&words, "--process=%u", cell->process_count);
    if (cell->group_tiles)
        rb_worker_word(&words, "--group-tiles=%u", cell->group_tiles);
    else if (cell->variant->exact)
        rb_worker_word(&words, "--expect=%llx:%llx",
                       (unsigned long long)cell->reference->image_hash,
                       (unsigned long long)cell->reference->hits_hash);
    rb_reference_scene_word(cell->reference, &words);
    pad_environment(run, cell);
    uint64_t start_ns = rb_clock_ns();
    struct rb_error problem = {0};
    enum rb_status status = rb_process_run(&words, rb_variant_parallel(cell->variant),
                                           sizeof(struct rb_sample), take, &taker, &problem);
    cell->cost_s = (double)(rb_clock_ns() - start_ns) * 1e-9;
    if (rb_process_interrupted())
        return RB_OK;
    if (status == RB_FAILED)
        tell_failure(run, cell, &problem);
    else if (status == RB_INVALID)
        tell_mismatch(run, cell);
    else
        cell->process_count++;
    if (fflush(side->samples) != 0) {
        snprintf(error->file, sizeof error->file, "%.230s/samples.csv.part", side->folder);
        return rb_error_set(error, RB_FAILED, "cannot write: %s", strerror(errno));
    }
    return RB_OK;
}

// Both programs' processes of a unit, the order changing from round to round.
static enum rb_status run_unit(struct rb_run *run, int unit, double slice_s, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    uint32_t round = processes_of(run, unit);
    for (int i = 0; i < run->side_count && status == RB_OK && !rb_process_interrupted(); i++) {
        struct rb_cell *cell = cell_of(run, unit, run->side_count == 2 ? i ^ (int)(round & 1) : 0);
        show_progress(run, cell, false);
        if (cell->state == RB_CELL_OPEN)
            status = run_process(run, cell, slice_s, error);
    }
    return status;
}

static void shuffle(int *order, int count, uint64_t seed, uint64_t round)
{
    for (int i = 0; i < count; i++) { // Fisher and Yates, inside out
        int j = (int)(rb_hash_word(rb_hash_word(seed, round), (uint64_t)i) % (uint64_t)(i + 1));
        order[i] = order[j];
        order[j] = i;
    }
}

// What each of the processes still missing may take.
static double fair_slice_s(const struct rb_run *run)
{
    int missing = processes_missing(run);
    double left_s = run->budget_s - elapsed_s(run);
    return missing && left_s > 0 ? left_s / missing : 0.001;
}

static enum rb_status run_rounds(struct rb_run *run, int *order, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (int round = 0; round < rb_run_processes(run); round++) {
        bool any = false;
        shuffle(order, run->unit_count, run->plan->arguments.settings.seed, (uint64_t)round);
        for (int i = 0; i < run->unit_count; i++) {
            if (status || rb_process_interrupted())
                return status;
            if (!is_open(run, order[i]) || (int)processes_of(run, order[i]) > round)
                continue;
            status = run_unit(run, order[i], fair_slice_s(run), error);
            any = true;
        }
        if (any && status == RB_OK)
            show_progress(run, cell_of(run, order[0], 0), true);
    }
    return status;
}

// The unit whose interval is widest, in relation to its value, of those that fit the time.
static int find_widest(const struct rb_run *run, double left_s)
{
    int widest = -1;
    double width = 0;
    for (int unit = 0; unit < run->unit_count; unit++) {
        struct rb_figure frame = rb_cell_frame_ns(cell_of(run, unit, 0));
        double cost_s = cell_of(run, unit, 0)->cost_s * run->side_count;
        double relative = (frame.high - frame.low) / frame.value;
        if (is_open(run, unit) && cost_s < left_s && relative > width) {
            widest = unit;
            width = relative;
        }
    }
    return widest;
}

static enum rb_status spend_rest(struct rb_run *run, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    while (status == RB_OK && !rb_process_interrupted()) {
        double left_s = run->budget_s - elapsed_s(run);
        int unit = find_widest(run, left_s);
        if (unit < 0)
            break;
        status = run_unit(run, unit, cell_of(run, unit, 0)->cost_s, error);
    }
    return status;
}

static void choose_groups(struct rb_run *run)
{
    double slice_s = run->budget_s / (rb_run_processes(run) * run->plan->cell_count);
    for (int i = 0; i < run->plan->cell_count; i++)
        if (run->plan->cells[i].state == RB_CELL_OPEN)
            rb_reference_choose_group(&run->plan->cells[i], slice_s);
}

static enum rb_status make_references(struct rb_run *run, struct rb_error *error)
{
    const struct rb_bench_arguments *bench = &run->plan->arguments.bench;
    char cache_path[RB_PATH_MAX + 16];
    snprintf(cache_path, sizeof cache_path, "%s/reference.csv", run->parent);
    double share_s = 0.1 * run->budget_s / run->plan->reference_count;
    enum rb_status status = RB_OK;
    for (int i = 0; i < run->plan->reference_count && status == RB_OK; i++) {
        struct rb_reference *reference = &run->plan->references[i];
        if (!run->quiet && isatty(STDERR_FILENO))
            fprintf(stderr, "\rreference of %s ...\033[K\r", reference->scene_name);
        status = rb_reference_make(reference, run->sides[0].program, cache_path, share_s,
                                   bench->full_reference, error);
        if (rb_process_interrupted())
            break;
    }
    return status;
}

enum rb_status rb_run_prepare(struct rb_run *run, struct rb_error *error)
{
    run->start_ns = rb_clock_ns();
    enum rb_status status = make_references(run, error);
    if (status == RB_OK)
        choose_groups(run);
    return status;
}

enum rb_status rb_run_cells(struct rb_run *run, struct rb_error *error)
{
    int *order = rb_alloc((size_t)run->unit_count, sizeof *order);
    if (!order)
        return rb_error_memory(error, "the order of the cells");
    enum rb_status status = run_rounds(run, order, error);
    if (status == RB_OK)
        status = spend_rest(run, error);
    rb_free(order);
    if (!run->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\033[K");
    return status;
}
