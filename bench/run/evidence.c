#include "bench/run/evidence.h"

#include "base/memory.h"
#include "bench/run/energy_cell.h"
#include "bench/run/process.h"
#include "bench/run/reference.h"
#include "bench/run/simulate_cell.h"
#include "bench/run/tiles.h"
#include "cli/commands.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Where a frame takes too long, so much of it is counted, by the estimate of what naive takes.
static const double COUNTED_S = 2.0;

// Events are counted for so long.
static const double HARDWARE_S = 2.0;

static void show_progress(const struct rb_run *run, const struct rb_cell *cell, const char *what)
{
    if (!run->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\r%s %s, %s ...\033[K\r", what, cell->reference->scene_name,
                cell->variant->name);
}

static void tell(const struct rb_cell *cell, const char *what, const struct rb_error *error)
{
    struct rb_error told = *error;
    snprintf(told.text, sizeof told.text, "%s, %s is not %s: %.250s", cell->reference->scene_name,
             cell->variant->name, what, error->text);
    rb_report(RB_FAILED, &told);
}

// Where a record goes.
struct keeper {
    void *to;
    size_t bytes;
};

static bool keep(void *user, const struct rb_sample *sample)
{
    const struct keeper *keeper = user;
    memcpy(keeper->to, sample, keeper->bytes); // what follows the sample, too
    return true;
}

static uint32_t counted_tiles(const struct rb_cell *cell)
{
    double tiles = cell->group_population * cell->group_tiles;
    double affordable = tiles * COUNTED_S / rb_reference_naive_s(cell->reference);
    return affordable > cell->group_tiles ? (uint32_t)affordable : cell->group_tiles;
}

// Runs a worker with one more option, and keeps its record.
static enum rb_status gather(const struct rb_run *run, const struct rb_cell *cell,
                             const char *option, double slice_s, const struct keeper *keeper,
                             struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    rb_reference_words(&cell->settings, run->sides[0].program, cell->variant, &words);
    rb_worker_word(&words, "%s", option);
    rb_worker_word(&words, "--slice=%g", slice_s);
    rb_worker_word(&words, "--cpu=-1");
    if (cell->group_tiles)
        rb_worker_word(&words, "--group-tiles=%u", counted_tiles(cell));
    else if (cell->variant->exact)
        rb_worker_word(&words, "--expect=%llx:%llx",
                       (unsigned long long)cell->reference->image_hash,
                       (unsigned long long)cell->reference->hits_hash);
    rb_reference_scene_word(cell->reference, &words);
    return rb_process_run(&words, rb_variant_parallel(cell->variant), keeper->bytes, keep,
                          (void *)keeper, error);
}

static enum rb_status count(const struct rb_run *run, struct rb_cell *cell, struct rb_error *error)
{
    struct rb_counted *counted = rb_alloc(1, sizeof *counted);
    if (!counted)
        return rb_error_memory(error, "the counts");
    const struct keeper keeper = {counted, sizeof *counted};
    enum rb_status status = gather(run, cell, "--count", 0, &keeper, error);
    if (status == RB_OK && !rb_process_interrupted())
        cell->counted = counted;
    else
        rb_free(counted);
    return status;
}

// A cell with the same kernels and batches has the same counts, whatever its threads.
static const struct rb_cell *find_alike(const struct rb_run *run, const struct rb_cell *cell)
{
    for (int i = 0; i < run->unit_count; i++) {
        const struct rb_cell *other = &run->plan->cells[i];
        if (other->counted && other->reference == cell->reference &&
            other->variant->kernels == cell->variant->kernels &&
            other->settings.tile == cell->settings.tile && other->group_tiles == cell->group_tiles)
            return other;
    }
    return NULL;
}

static enum rb_status count_cell(struct rb_run *run, struct rb_cell *cell, struct rb_error *error)
{
    const struct rb_cell *alike = find_alike(run, cell);
    struct rb_error problem = {0};
    if (!cell->variant->counted) {
        rb_error_set(&problem, RB_INVALID, "its kernels do not count");
        tell(cell, "counted", &problem);
        return RB_OK;
    }
    if (alike) {
        cell->counted = rb_alloc(1, sizeof *cell->counted);
        if (!cell->counted)
            return rb_error_memory(error, "the counts");
        *cell->counted = *alike->counted;
        return RB_OK;
    }
    show_progress(run, cell, "counting");
    enum rb_status status = count(run, cell, &problem);
    if (status == RB_INVALID && !problem.text[0]) {
        rb_error_set(&problem, RB_INVALID, "image or hits of its counting kernels differ");
        cell->state = RB_CELL_INVALID;
        run->mismatch = true;
    }
    if (status && !rb_process_interrupted())
        tell(cell, "counted", &problem);
    return RB_OK;
}

// A row that cannot be simulated is left out; that is no failure.
static void simulate_cell(struct rb_run *run, struct rb_cell *cell)
{
    struct rb_error problem = {0};
    enum rb_status status = RB_OK;
    uint32_t tiles = (uint32_t)run->plan->arguments.bench.simulate_tiles;
    if (rb_simulate_refusal(cell->variant)) {
        rb_error_set(&problem, RB_INVALID, "%s", rb_simulate_refusal(cell->variant));
    } else {
        show_progress(run, cell, "simulating");
        status = rb_simulate_cell(cell, run->sides[0].program, tiles, &run->caches, &problem);
    }
    if (!problem.text[0] || rb_process_interrupted())
        return;
    run->mismatch |= status == RB_INVALID;
    run->crashed |= status == RB_FAILED;
    tell(cell, "simulated", &problem);
}

// What a worker that counts events sends.
struct hardware_record {
    struct rb_sample sample;
    struct rb_hardware hardware;
};

// Once, if no event counts on this machine.
static void tell_uncounted(struct rb_run *run, const struct rb_hardware *hardware)
{
    char reason[RB_HARDWARE_TEXT];
    struct rb_error problem = {0};
    for (int i = 0; i < hardware->file->event_count; i++)
        if (hardware->state[i] == RB_EVENT_COUNTED)
            return;
    rb_hardware_reason(hardware, RB_STAGE_TRACE, 0, reason);
    rb_error_set(&problem, RB_FAILED, "no event of %s is counted: %s", hardware->file->stem,
                 reason);
    if (!run->uncounted)
        rb_report(RB_FAILED, &problem);
    run->uncounted = true;
}

static enum rb_status count_events(struct rb_run *run, struct rb_cell *cell, struct rb_error *error)
{
    static struct hardware_record record; // too large for the stack
    const struct keeper keeper = {&record, sizeof record};
    const char *asked = run->plan->arguments.bench.events;
    struct rb_error problem = {0};
    char option[RB_WORKER_WORD_MAX];
    snprintf(option, sizeof option, "--events=%s", asked ? asked : run->events.stem);
    show_progress(run, cell, "counting events of");
    enum rb_status status = gather(run, cell, option, HARDWARE_S, &keeper, &problem);
    if (status == RB_INVALID && !problem.text[0]) {
        rb_error_set(&problem, RB_INVALID, "image or hits differ");
        cell->state = RB_CELL_INVALID;
        run->mismatch = true;
    }
    if (status && !rb_process_interrupted())
        tell(cell, "counted by hardware", &problem);
    if (status || rb_process_interrupted())
        return RB_OK;
    cell->hardware = rb_alloc(1, sizeof *cell->hardware);
    if (!cell->hardware)
        return rb_error_memory(error, "the events");
    *cell->hardware = record.hardware;
    cell->hardware->file = &run->events;
    tell_uncounted(run, cell->hardware);
    return RB_OK;
}

enum rb_status rb_evidence_gather(struct rb_run *run, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (int i = 0; i < run->unit_count && status == RB_OK; i++) {
        struct rb_cell *cell = &run->plan->cells[i];
        if (cell->state == RB_CELL_OPEN && run->measure & RB_MEASURE_COUNT &&
            !rb_process_interrupted())
            status = count_cell(run, cell, error);
        if (cell->state == RB_CELL_OPEN && status == RB_OK && run->measure & RB_MEASURE_HARDWARE &&
            !rb_process_interrupted())
            status = count_events(run, cell, error);
        if (cell->state != RB_CELL_INVALID && run->measure & RB_MEASURE_SIMULATE &&
            !rb_process_interrupted())
            simulate_cell(run, cell);
    }
    if (status == RB_OK && run->plan->arguments.bench.energy && !rb_process_interrupted())
        status = rb_energy_cells(run, error);
    return status;
}
