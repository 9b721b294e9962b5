#define _POSIX_C_SOURCE 200809L
#include "bench/run/simulate_cell.h"

#include "base/memory.h"
#include "bench/run/process.h"
#include "bench/run/reference.h"
#include "bench/run/simulate_sample.h"
#include "bench/run/tiles.h"
#include "bench/simulate/simulate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Instructions of naive for a ray against a primitive, and of the others for a ray with its share
// of shading, about; and what callgrind gets through in five seconds on a Zen 4. To plan with only.
static const double NAIVE_TEST = 100, TREE_RAY = 2000, AFFORDABLE = 5e8;

const char *rb_simulate_refusal(const struct rb_variant *variant)
{
    if (rb_variant_parallel(variant))
        return "the simulator runs one thread: take the row without +omp";
    if (variant->accelerator == RB_ACCEL_EMBREE)
        return "Embree is a yardstick of time alone";
    if (strstr(variant->needs, "avx512f"))
        return "valgrind has no AVX-512: take its avx2 row";
    return rb_variant_available(variant) ? NULL : "this machine or build lacks what it needs";
}

void rb_simulate_mask(void)
{
    const char *disabled = getenv("RAYBENCH_CPU_DISABLE");
    char list[256];
    snprintf(list, sizeof list, "%.200s%savx512f", disabled ? disabled : "",
             disabled && *disabled ? "," : "");
    setenv("RAYBENCH_CPU_DISABLE", list, 1);
}

// Naive takes so long that only small tiles leave a choice.
static int tile_edge(const struct rb_cell *cell)
{
    return cell->variant->accelerator == RB_ACCEL_NONE ? RB_SAMPLE_TILE : cell->settings.tile;
}

static uint32_t tiles_across(int pixels, int edge)
{
    return (uint32_t)((pixels - 1) / edge + 1);
}

double rb_simulate_affordable_rays(const struct rb_cell *cell)
{
    bool naive = cell->variant->accelerator == RB_ACCEL_NONE;
    return AFFORDABLE / (TREE_RAY + (naive ? NAIVE_TEST * cell->reference->primitive_count : 0));
}

static uint32_t choose_tiles(const struct rb_cell *cell, uint32_t all)
{
    double affordable = rb_simulate_affordable_rays(cell) / (cell->reference->rays / all);
    return affordable < 1 ? 1 : affordable < all ? (uint32_t)affordable : all;
}

// Of several native runs, the least time of each place.
static bool keep_sample(void *user, const struct rb_sample *sample)
{
    struct rb_sample *least = user;
    struct rb_sample before = *least;
    *least = *sample;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            if (sample->repetition > 0 &&
                before.stage[stage][bounce].ns < sample->stage[stage][bounce].ns)
                least->stage[stage][bounce].ns = before.stage[stage][bounce].ns;
    return true;
}

static void add_native(struct rb_simulated *simulated, const struct rb_sample *native)
{
    simulated->tree_bytes = native->tree_bytes;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            const struct rb_sample_stage *place = &native->stage[stage][bounce];
            if (place->rays && place->ns)
                simulated->place[stage][bounce].native_ns_per_ray =
                    (double)place->ns / (double)place->rays;
        }
}

// The native run went over the tiles twice.
static bool agrees(const struct rb_simulated *simulated, const struct rb_sample *native)
{
    bool same = simulated->hits_hash == native->hits_hash;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            same = same &&
                   2 * simulated->place[stage][bounce].rays == native->stage[stage][bounce].rays;
    return same;
}

// Runs the same worker natively and under the simulator, and compares.
static enum rb_status run_both(const struct rb_worker_words *words, const struct rb_caches *caches,
                               struct rb_simulated *simulated, struct rb_error *error)
{
    static struct rb_sample native; // too large for the stack
    char *pointers[RB_WORKER_WORDS_MAX + 1] = {NULL};
    for (int i = 0; i < words->count; i++)
        pointers[i] = (char *)words->text[i];
    enum rb_status status =
        rb_process_run(words, false, sizeof(struct rb_sample), keep_sample, &native, error);
    if (status == RB_OK && rb_process_interrupted())
        status = rb_error_set(error, RB_FAILED, "interrupted");
    if (status == RB_OK)
        status = rb_simulate_run(pointers, caches, simulated, error);
    if (status)
        return status;
    add_native(simulated, &native);
    return agrees(simulated, &native)
               ? RB_OK
               : rb_error_set(error, RB_INVALID,
                              "hits and rays under the simulator are not those of a native run: "
                              "there are no numbers");
}

enum rb_status rb_simulate_cell(struct rb_cell *cell, const char *program, uint32_t tiles,
                                const struct rb_caches *caches, struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    struct rb_settings settings = cell->settings;
    uint64_t seed;
    settings.tile = tile_edge(cell);
    uint32_t all =
        tiles_across(settings.width, settings.tile) * tiles_across(settings.height, settings.tile);
    tiles = tiles ? tiles : choose_tiles(cell, all);
    tiles = tiles < all ? tiles : all;
    enum rb_status status = rb_simulate_choose_sample(cell, &settings, tiles, &seed, error);
    if (status)
        return status;
    struct rb_simulated *simulated = rb_alloc(1, sizeof *simulated);
    if (!simulated)
        return rb_error_memory(error, "the simulation");
    rb_reference_words(&settings, program, cell->variant, &words);
    rb_worker_word(&words, "--cpu=-1");
    rb_worker_word(&words, "--simulate-tiles=%u", tiles);
    rb_worker_word(&words, "--simulate-sample=%llu", (unsigned long long)seed);
    rb_reference_scene_word(cell->reference, &words);
    status = run_both(&words, caches, simulated, error);
    simulated->tiles = tiles;
    simulated->all_tiles = all;
    simulated->tile = settings.tile;
    rb_free(status ? simulated : cell->simulated);
    if (status == RB_OK)
        cell->simulated = simulated;
    return status;
}
