#define _POSIX_C_SOURCE 200809L
#include "bench/run/energy_cell.h"

#include "base/memory.h"
#include "bench/run/reference.h"
#include "cli/commands.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct record {
    struct rb_sample sample;
    struct rb_energy_span span;
};

static bool keep(void *user, const struct rb_sample *sample)
{
    memcpy(user, sample, sizeof(struct record));
    return true;
}

enum rb_status rb_energy_run(const struct rb_worker_words *words, bool bind,
                             struct rb_energy_span *span, struct rb_error *error)
{
    static struct record record; // too large for the stack
    enum rb_status status = rb_process_run(words, bind, sizeof record, keep, &record, error);
    if (status == RB_OK && !rb_process_interrupted())
        *span = record.span;
    return status;
}

static enum rb_status measure_frames(const struct rb_run *run, struct rb_cell *cell,
                                     struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    rb_reference_words(&cell->settings, run->sides[0].program, cell->variant, &words);
    rb_worker_word(&words, "--energy");
    rb_worker_word(&words, "--cpu=-1");
    if (cell->variant->exact)
        rb_worker_word(&words, "--expect=%llx:%llx",
                       (unsigned long long)cell->reference->image_hash,
                       (unsigned long long)cell->reference->hits_hash);
    rb_reference_scene_word(cell->reference, &words);
    return rb_energy_run(&words, rb_variant_parallel(cell->variant), &cell->energy->frames, error);
}

// Records the rays of the cell's frame, but not if the cell before had the same ones.
static enum rb_status record_rays(const struct rb_run *run, const struct rb_cell *cell,
                                  const struct rb_cell *before, const char *path,
                                  struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    if (strlen(path) > RB_WORKER_WORD_MAX - 3)
        return rb_error_set(error, RB_INVALID, "the name of the results' folder is too long");
    if (before && before->reference == cell->reference &&
        before->settings.tile == cell->settings.tile)
        return RB_OK;
    rb_reference_words(&cell->settings, run->sides[0].program, rb_variant_find("bvh"), &words);
    snprintf(words.text[1], RB_WORKER_WORD_MAX, "record"); // which takes the same options
    for (int i = 0; i < words.count; i++)                  // but for one
        if (strncmp(words.text[i], "--threads", 9) == 0)
            snprintf(words.text[i], RB_WORKER_WORD_MAX, "-o%.*s", RB_WORKER_WORD_MAX - 3, path);
    rb_reference_scene_word(cell->reference, &words);
    return rb_process_run(&words, false, 0, NULL, NULL, error);
}

static enum rb_status measure_kernel(const struct rb_run *run, struct rb_cell *cell,
                                     const char *path, enum rb_stage kernel, int bounce,
                                     struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    rb_worker_word(&words, "%s", run->sides[0].program);
    rb_worker_word(&words, "replay-worker");
    rb_worker_word(&words, "--variant=%s", cell->variant->name);
    rb_worker_word(&words, "--kernel=%s", rb_stage_names[kernel]);
    rb_worker_word(&words, "--bounce=%d", bounce);
    rb_worker_word(&words, "--energy");
    rb_worker_word(&words, "--cpu=-1");
    rb_worker_word(&words, "--");
    rb_worker_word(&words, "%s", path);
    return rb_energy_run(&words, false, &cell->energy->place[kernel][bounce], error);
}

static enum rb_status measure_kernels(const struct rb_run *run, struct rb_cell *cell,
                                      const struct rb_cell *before, const char *path,
                                      struct rb_error *error)
{
    if (rb_variant_parallel(cell->variant)) {
        snprintf(cell->energy->kernels, sizeof cell->energy->kernels,
                 "kernels alone have one thread; see the serial row");
        return RB_OK;
    }
    enum rb_status status = record_rays(run, cell, before, path, error);
    for (int kernel = 0; kernel < RB_KERNEL_COUNT; kernel++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            if (status == RB_OK && !rb_process_interrupted() &&
                cell->reference->frame.stage[kernel][bounce].rays)
                status = measure_kernel(run, cell, path, (enum rb_stage)kernel, bounce, error);
    return status;
}

static void measure_cell(const struct rb_run *run, struct rb_cell *cell,
                         const struct rb_cell *before, const char *path)
{
    struct rb_error problem = {0}, told = {0};
    enum rb_status status = RB_OK;
    if (!run->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\renergy of %s, %s ...\033[K\r", cell->reference->scene_name,
                cell->variant->name);
    if (!cell->group_tiles)
        status = measure_frames(run, cell, &problem);
    if (status == RB_OK && !rb_process_interrupted())
        status = measure_kernels(run, cell, before, path, &problem);
    if (status == RB_OK || rb_process_interrupted())
        return;
    snprintf(cell->energy->note, sizeof cell->energy->note, "%.190s", problem.text);
    rb_error_set(&told, RB_FAILED, "energy of %s, %s is not measured: %.250s",
                 cell->reference->scene_name, cell->variant->name, problem.text);
    rb_report(RB_FAILED, &told);
}

static enum rb_status measure_cells(struct rb_run *run, struct rb_meter *meter,
                                    struct rb_error *error)
{
    char path[RB_PATH_MAX + 32];
    struct rb_cell *before = NULL;
    double idle_w[2] = {0, 0};
    snprintf(path, sizeof path, "%s/energy.rays", run->sides[0].folder);
    enum rb_status status =
        rb_energy_idle(meter, run->plan->arguments.bench.idle_s, &idle_w[0], error);
    for (int i = 0; i < run->unit_count && status == RB_OK && !rb_process_interrupted(); i++) {
        struct rb_cell *cell = &run->plan->cells[i];
        if (!cell->energy)
            continue;
        measure_cell(run, cell, before, path);
        if (!rb_variant_parallel(cell->variant))
            before = cell;
    }
    unlink(path);
    if (status == RB_OK)
        status = rb_energy_idle(meter, run->plan->arguments.bench.idle_s, &idle_w[1], error);
    for (int i = 0; i < run->unit_count; i++)
        if (run->plan->cells[i].energy) {
            run->plan->cells[i].energy->idle_before_w = idle_w[0];
            run->plan->cells[i].energy->idle_after_w = idle_w[1];
            rb_meter_describe(meter, run->plan->cells[i].energy->source);
        }
    return status;
}

enum rb_status rb_energy_cells(struct rb_run *run, struct rb_error *error)
{
    struct rb_meter meter;
    struct rb_error problem = {0};
    for (int i = 0; i < run->unit_count; i++) {
        struct rb_cell *cell = &run->plan->cells[i];
        if (cell->state != RB_CELL_OPEN)
            continue;
        cell->energy = rb_alloc(1, sizeof *cell->energy);
        if (!cell->energy)
            return rb_error_memory(error, "the energies");
    }
    enum rb_status status = rb_meter_open(&meter, rb_hardware_root(), &problem);
    if (status == RB_OK) {
        status = measure_cells(run, &meter, &problem);
        rb_meter_close(&meter);
    }
    if (status == RB_OK || rb_process_interrupted())
        return RB_OK;
    // Without idle power, or a meter, nothing of it is known.
    for (int i = 0; i < run->unit_count; i++)
        if (run->plan->cells[i].energy) {
            *run->plan->cells[i].energy = (struct rb_energy){.idle_before_w = 0};
            snprintf(run->plan->cells[i].energy->note, sizeof run->plan->cells[i].energy->note,
                     "%.190s", problem.text);
        }
    rb_report(status, &problem);
    return RB_OK;
}
