// The reference (the first row of the table) renders a seeded sample of small tiles, every other
// row must render the same pixels and hits, and only then is anything timed. The sample is the
// whole image where the reference can afford it. Whole frames of all rows are timed in rounds, one
// after the other, so that drift of the machine hits all of them alike.
#include "bench/scene_bench.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { ROUNDS_MIN = 3, PILOT_TILES = 8 };

static struct rb_settings sampled_settings(const struct rb_scene_bench *bench)
{
    struct rb_settings settings = bench->settings;
    settings.tile = RB_SAMPLE_TILE;
    return settings;
}

static double seconds_since(uint64_t start_ns)
{
    return (double)(rb_clock_ns() - start_ns) * 1e-9;
}

// Renders the first `count` tiles of the sample, hits hashed.
static void run_tiles(struct rb_renderer *renderer, const struct rb_tile_sample *sample,
                      uint32_t first, uint32_t count, bool hash, struct rb_run_result *result)
{
    struct rb_run_options options = {
        .tiles = sample->tiles + first,
        .tile_count = count,
        .hash_hits = hash,
    };
    rb_renderer_run(renderer, &options, result);
}

// Cuts the sample to what the reference can render in `budget_s`, whole groups of it.
static void fit_sample(struct rb_scene_bench *bench, struct rb_renderer *reference, double budget_s)
{
    struct rb_tile_sample *sample = &bench->sample;
    uint32_t pilot = sample->total < PILOT_TILES ? sample->total : PILOT_TILES;
    struct rb_run_result result;
    run_tiles(reference, sample, 0, pilot, false, &result);
    double tile_s = (double)result.wall_ns * 1e-9 / pilot;
    if (tile_s * sample->total <= budget_s)
        return;
    uint32_t groups = (uint32_t)(budget_s / tile_s) / RB_SAMPLE_GROUPS;
    sample->count = (groups ? groups : 1) * RB_SAMPLE_GROUPS;
    if (sample->count > sample->total)
        sample->count = sample->total;
}

// Renders the sample with a row of its own tile size and compares with the reference.
static enum rb_status verify_row(struct rb_scene_bench *bench, struct rb_row *row,
                                 const struct rb_run_result *expected, struct rb_error *error)
{
    struct rb_settings settings = sampled_settings(bench);
    struct rb_renderer *renderer;
    struct rb_run_result result;
    enum rb_status status =
        rb_renderer_create(bench->scene, row->variant, &settings, &renderer, error);
    if (status)
        return status;
    run_tiles(renderer, &bench->sample, 0, bench->sample.count, true, &result);
    rb_renderer_free(renderer);
    if (result.image_hash != expected->image_hash || result.hits_hash != expected->hits_hash) {
        row->state = RB_ROW_INVALID;
        bench->mismatch = true;
    }
    return RB_OK;
}

static enum rb_status verify(struct rb_scene_bench *bench, double budget_s, struct rb_error *error)
{
    struct rb_settings settings = sampled_settings(bench);
    struct rb_renderer *reference;
    struct rb_run_result expected;
    enum rb_status status =
        rb_renderer_create(bench->scene, &rb_variants[0], &settings, &reference, error);
    if (status)
        return status;
    fit_sample(bench, reference, budget_s);
    run_tiles(reference, &bench->sample, 0, bench->sample.count, true, &expected);
    rb_renderer_free(reference);
    for (int i = 0; i < bench->row_count && status == RB_OK; i++)
        if (bench->rows[i].state != RB_ROW_UNAVAILABLE && bench->rows[i].variant != rb_variants)
            status = verify_row(bench, &bench->rows[i], &expected, error);
    return status;
}

static bool row_runs(const struct rb_row *row)
{
    return row->state == RB_ROW_MEASURED || row->state == RB_ROW_ESTIMATED;
}

// Rows without an accelerator are as slow as the reference and are sampled when it is.
static enum rb_status open_rows(struct rb_scene_bench *bench, struct rb_error *error)
{
    bool sampled = bench->sample.count < bench->sample.total;
    for (int i = 0; i < bench->row_count; i++) {
        struct rb_row *row = &bench->rows[i];
        if (!row_runs(row))
            continue;
        struct rb_settings settings = bench->settings;
        if (sampled && row->variant->accelerator == RB_ACCEL_NONE) {
            row->state = RB_ROW_ESTIMATED;
            row->population = RB_SAMPLE_GROUPS * (double)bench->sample.total / bench->sample.count;
            settings = sampled_settings(bench);
        }
        enum rb_status status =
            rb_renderer_create(bench->scene, row->variant, &settings, &row->renderer, error);
        if (status)
            return status;
    }
    return RB_OK;
}

static void time_groups(const struct rb_scene_bench *bench, struct rb_row *row)
{
    uint32_t size = bench->sample.count / RB_SAMPLE_GROUPS;
    for (uint32_t g = 0; g < RB_SAMPLE_GROUPS; g++)
        run_tiles(row->renderer, &bench->sample, g * size, size, false,
                  &row->samples[row->sample_count++]);
}

// One frame of every measured row; their images must be equal to the last bit.
static void time_round(struct rb_scene_bench *bench, uint64_t *image_hash, bool keep)
{
    for (int i = 0; i < bench->row_count; i++) {
        struct rb_row *row = &bench->rows[i];
        if (row->state != RB_ROW_MEASURED)
            continue;
        struct rb_run_result *result = &row->samples[row->sample_count];
        rb_renderer_run(row->renderer, NULL, result);
        if (*image_hash == 0) {
            *image_hash = result->image_hash;
            bench->frame = result->recorder;
            bench->frame_rays = rb_result_rays(result);
        } else if (result->image_hash != *image_hash) {
            row->state = RB_ROW_INVALID;
            bench->mismatch = true;
        }
        row->sample_count += keep;
    }
}

static void time_rows(struct rb_scene_bench *bench, double budget_s)
{
    uint64_t image_hash = 0;
    for (int i = 0; i < bench->row_count; i++)
        if (bench->rows[i].state == RB_ROW_ESTIMATED)
            time_groups(bench, &bench->rows[i]);
    time_round(bench, &image_hash, false); // warm-up
    uint64_t start_ns = rb_clock_ns();
    for (int round = 0; round < RB_ROW_SAMPLES_MAX; round++) {
        if (round >= ROUNDS_MIN && seconds_since(start_ns) > budget_s)
            break;
        time_round(bench, &image_hash, true);
    }
}

enum rb_status rb_scene_bench_run(struct rb_scene_bench *bench, const char *name,
                                  const struct rb_scene *scene, const struct rb_settings *settings,
                                  double budget_s, struct rb_error *error)
{
    *bench = (struct rb_scene_bench){.name = name, .scene = scene, .settings = *settings};
    enum rb_status status = rb_settings_complete(&bench->settings, scene, error);
    if (status)
        return status;
    for (const struct rb_variant *v = rb_variants; v->name && bench->row_count < RB_ROWS_MAX; v++) {
        struct rb_row *row = &bench->rows[bench->row_count++];
        row->variant = v;
        row->state = rb_variant_available(v) ? RB_ROW_MEASURED : RB_ROW_UNAVAILABLE;
    }
    status = rb_tile_sample_draw(&bench->sample, bench->settings.width, bench->settings.height,
                                 bench->settings.seed, error);
    // Half of the budget goes to rows that are sampled: verified once, timed serial and parallel.
    if (status == RB_OK)
        status = verify(bench, budget_s / 6, error);
    if (status == RB_OK)
        status = open_rows(bench, error);
    if (status == RB_OK)
        time_rows(bench, budget_s / 2);
    return status;
}

void rb_scene_bench_free(struct rb_scene_bench *bench)
{
    for (int i = 0; i < bench->row_count; i++)
        rb_renderer_free(bench->rows[i].renderer);
    rb_free(bench->sample.tiles);
    bench->sample.tiles = NULL;
    bench->row_count = 0;
}

const struct rb_row *rb_scene_bench_row(const struct rb_scene_bench *bench, const char *name)
{
    for (int i = 0; i < bench->row_count; i++)
        if (strcmp(bench->rows[i].variant->name, name) == 0)
            return &bench->rows[i];
    return NULL;
}
