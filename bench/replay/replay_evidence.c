#include "bench/replay/replay_evidence.h"

#include "bench/explain/count_table.h"
#include "bench/explain/simulate_table.h"
#include "bench/replay/source.h"
#include "bench/run/simulate_cell.h"
#include "bench/simulate/simulate.h"
#include "cli/commands.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Is the unit the last one of its class?
static bool ends_class(const struct rb_replay_run *run, int index)
{
    return index + 1 == run->unit_count ||
           run->units[index + 1].choice.ray_class != run->units[index].choice.ray_class;
}

// Adds what a unit counts to the class's table.
static int count_unit(const struct rb_replay_run *run, const struct rb_replay_unit *unit,
                      const struct rb_arguments *arguments, struct rb_counted *counted)
{
    struct rb_replay_source source;
    struct rb_run_result result;
    struct rb_error error = {0};
    int code = rb_replay_source_open(run->path, &unit->choice, arguments, &source);
    if (code)
        return code;
    const struct rb_run_options how = {.replay = &source.replay, .counts = &counted->table};
    enum rb_status status =
        rb_replay_verify(source.renderer, &source.replay, 0, source.replay.count, &error);
    if (status == RB_OK)
        rb_renderer_run(source.renderer, &how, &result);
    rb_replay_source_close(&source);
    counted->sample.stage[unit->choice.kernel][unit->choice.bounce].rays = unit->rays;
    snprintf(error.file, sizeof error.file, "%.255s", run->path);
    return status ? rb_report(status, &error) : 0;
}

int rb_replay_count(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    static struct rb_counted counted[RB_CLASS_COUNT];
    struct rb_error error = {0};
    const struct rb_variant *variant = run->in_place.variant;
    int code = RB_OK;
    if (!variant->counted) {
        rb_error_set(&error, RB_INVALID, "%s has no kernels that count", variant->name);
        return rb_report(RB_INVALID, &error);
    }
    for (int i = 0; i < run->unit_count && code == RB_OK; i++) {
        const struct rb_replay_unit *unit = &run->units[i];
        enum rb_ray_class ray_class = unit->choice.ray_class;
        code = count_unit(run, unit, arguments, &counted[ray_class]);
        if (code == RB_OK && ends_class(run, i)) {
            struct rb_cell cell = {
                .variant = variant, .reference = &run->reference, .counted = &counted[ray_class]};
            printf("\nrays of class %s", rb_ray_class_names[ray_class]);
            rb_count_table_print(&cell);
        }
    }
    if (code == RB_OK)
        rb_count_table_print_notes();
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
    static struct rb_simulated simulated[RB_CLASS_COUNT];
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
    for (int i = 0; i < run->unit_count && status == RB_OK; i++) {
        const struct rb_replay_unit *unit = &run->units[i];
        enum rb_ray_class ray_class = unit->choice.ray_class;
        status = simulate_unit(run, unit, &caches, &simulated[ray_class], &error);
        if (status == RB_OK && ends_class(run, i)) {
            struct rb_cell cell = {.reference = &run->reference,
                                   .simulated = &simulated[ray_class]};
            printf("\nrays of class %s", rb_ray_class_names[ray_class]);
            rb_simulate_print(&cell);
            printf("  share is that of the batches which were simulated, not of a frame\n");
        }
    }
    if (status)
        return rb_report(status, &error);
    rb_simulate_print_notes();
    return RB_OK;
}
