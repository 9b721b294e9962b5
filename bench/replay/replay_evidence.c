#include "bench/replay/replay_evidence.h"

#include "bench/explain/simulate_table.h"
#include "bench/replay/source.h"
#include "bench/run/simulate_cell.h"
#include "bench/simulate/simulate.h"
#include "cli/commands.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Counters that counted anything, per ray.
static void print_counts(const struct rb_replay_unit *unit, const struct rb_counts *counts)
{
    printf("  %-10s %-12s %6d %9" PRIu64 " ", rb_ray_class_names[unit->choice.ray_class],
           rb_stage_names[unit->choice.kernel], unit->choice.bounce, unit->rays);
    for (int c = 0; c < RB_COUNTER_COUNT; c++)
        if (counts->of[c])
            printf(" %s %.4g", rb_counter_names[c], (double)counts->of[c] / (double)unit->rays);
    printf("\n");
}

static int count_unit(const struct rb_replay_run *run, const struct rb_replay_unit *unit,
                      const struct rb_arguments *arguments)
{
    static struct rb_count_table table;
    struct rb_replay_source source;
    struct rb_run_result result;
    int code = rb_replay_source_open(run->path, &unit->choice, arguments, &source);
    if (code)
        return code;
    struct rb_error error = {0};
    enum rb_status status =
        rb_replay_verify(source.renderer, &source.replay, 0, source.replay.count, &error);
    table = (struct rb_count_table){0};
    const struct rb_run_options how = {.replay = &source.replay, .counts = &table};
    if (status == RB_OK)
        rb_renderer_run(source.renderer, &how, &result);
    rb_replay_source_close(&source);
    snprintf(error.file, sizeof error.file, "%.255s", run->path);
    if (status)
        return rb_report(status, &error);
    print_counts(unit, &table.at[unit->choice.kernel][unit->choice.bounce]);
    return RB_OK;
}

int rb_replay_count(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    const struct rb_variant *variant = run->in_place.variant;
    int code = RB_OK;
    if (!variant->counted) {
        rb_error_set(&error, RB_INVALID, "%s has no kernels that count", variant->name);
        return rb_report(RB_INVALID, &error);
    }
    printf("\n  %-10s %-12s %6s %9s  counts per ray\n", "class", "kernel", "bounce", "rays");
    for (int i = 0; i < run->unit_count && code == RB_OK; i++)
        code = count_unit(run, &run->units[i], arguments);
    return code;
}

// Batches that the simulator gets through in about five seconds.
static uint64_t affordable_batches(const struct rb_replay_run *run,
                                   const struct rb_replay_unit *unit)
{
    double rays = rb_simulate_affordable_rays(&run->in_place);
    double batches = rays * (double)unit->batches / (double)unit->rays;
    return batches < 1 ? 1 : batches < (double)unit->batches ? (uint64_t)batches : unit->batches;
}

static enum rb_status simulate_unit(const struct rb_replay_run *run,
                                    const struct rb_replay_unit *unit,
                                    const struct rb_caches *caches, struct rb_simulated *all,
                                    struct rb_error *error)
{
    static struct rb_simulated one;
    struct rb_worker_words words = {.count = 0};
    char *pointers[RB_WORKER_WORDS_MAX + 1] = {NULL};
    rb_replay_unit_words(run, unit, &words);
    rb_worker_word(&words, "--cpu=-1");
    rb_worker_word(&words, "--simulate-batches=%" PRIu64, affordable_batches(run, unit));
    rb_worker_word(&words, "--");
    rb_worker_word(&words, "%s", run->path);
    for (int i = 0; i < words.count; i++)
        pointers[i] = words.text[i];
    enum rb_status status = rb_simulate_run(pointers, caches, &one, error);
    if (status == RB_OK) {
        struct rb_simulated_place place = one.place[unit->choice.kernel][unit->choice.bounce];
        memcpy(one.place, all->place, sizeof one.place);
        one.place[unit->choice.kernel][unit->choice.bounce] = place;
        *all = one;
    }
    return status;
}

int rb_replay_simulate(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    static struct rb_simulated all;
    struct rb_error error = {0};
    struct rb_caches caches;
    const char *refusal = rb_simulate_refusal(run->in_place.variant);
    enum rb_status status = rb_simulate_check(&error);
    if (status == RB_OK && refusal)
        status = rb_error_set(&error, RB_INVALID, "%s", refusal);
    if (status == RB_OK)
        status = rb_caches_choose("", arguments->bench.l1, arguments->bench.ll, &caches, &error);
    if (status == RB_OK)
        rb_simulate_print_caches(&caches);
    for (int c = 0; c < RB_CLASS_COUNT && status == RB_OK; c++) {
        bool any = false;
        all = (struct rb_simulated){.tiles = 0};
        for (int i = 0; i < run->unit_count && status == RB_OK; i++)
            if ((int)run->units[i].choice.ray_class == c) {
                status = simulate_unit(run, &run->units[i], &caches, &all, &error);
                any = true;
            }
        if (any && status == RB_OK) {
            printf("\nrays of class %s", rb_ray_class_names[c]);
            run->in_place.simulated = &all;
            rb_simulate_print(&run->in_place);
            run->in_place.simulated = NULL;
            printf("  share is that of the batches which were simulated, not of a frame\n");
        }
    }
    if (status)
        return rb_report(status, &error);
    rb_simulate_print_notes();
    return RB_OK;
}
