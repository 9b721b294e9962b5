// The reference (the first row of the table) renders a seeded sample of small tiles, every other
// row must render the same pixels and hits, and only then is anything timed. The sample is the
// whole image where the reference can afford it; where not, the same renders are what the slow rows
// are timed on. Whole frames of all other rows are timed in rounds, one after the other, so that
// drift of the machine hits all of them alike.
#include "bench/scene_bench.h"

#include "base/memory.h"

#include <string.h>

// Fewer samples have no 95 % interval of the median.
enum { ROUNDS_WANTED = 6 };

// The budget is spent on the sample (a sixth), and on rounds (a half, up to three times that until
// ROUNDS_WANTED are done).
static const double SAMPLE_SHARE = 1.0 / 6, ROUNDS_SHARE = 1.0 / 2, PATIENCE = 3.0;

static double seconds_since(uint64_t start_ns)
{
    return (double)(rb_clock_ns() - start_ns) * 1e-9;
}

static bool same_rays(const struct rb_run_result *a, const struct rb_run_result *b)
{
    const struct rb_recorder *x = &a->recorder, *y = &b->recorder;
    bool same = a->image_hash == b->image_hash && a->hits_hash == b->hits_hash;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
        for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
            same = same && x->tally[stage][bounce].rays == y->tally[stage][bounce].rays;
        same = same && x->hits[bounce] == y->hits[bounce];
    }
    return same;
}

static void invalidate(struct rb_scene_bench *bench, struct rb_row *row)
{
    row->state = RB_ROW_INVALID;
    row->sample_count = 0;
    bench->mismatch = true;
}

static enum rb_status open_row(struct rb_scene_bench *bench, struct rb_row *row, int tile,
                               struct rb_error *error)
{
    struct rb_settings settings = bench->settings;
    settings.tile = tile;
    rb_renderer_free(row->renderer);
    return rb_renderer_create(bench->scene, row->variant, &settings, &row->renderer, error);
}

// Every row renders the sample, group by group in turn.
static void run_groups(struct rb_scene_bench *bench)
{
    const struct rb_row *reference = &bench->rows[0];
    for (uint32_t g = 0; g < bench->tiles.group_count; g++) {
        for (int i = 0; i < bench->row_count; i++) {
            struct rb_row *row = &bench->rows[i];
            if (row->state != RB_ROW_MEASURED)
                continue;
            rb_tiles_run(&bench->tiles, g, row->renderer, &row->samples[g]);
            row->sample_count = (int)g + 1;
            if (!same_rays(&row->samples[g], &reference->samples[g]))
                invalidate(bench, row);
        }
    }
}

// Slow rows keep what they rendered as their samples; the others make place for whole frames.
static enum rb_status settle_row(struct rb_scene_bench *bench, struct rb_row *row,
                                 struct rb_error *error)
{
    if (row->variant->accelerator == RB_ACCEL_NONE && !rb_tiles_complete(&bench->tiles)) {
        row->state = RB_ROW_ESTIMATED;
        row->population = (double)bench->tiles.total / bench->tiles.group_size;
        return RB_OK;
    }
    row->sample_count = 0;
    return open_row(bench, row, bench->settings.tile, error);
}

static enum rb_status verify(struct rb_scene_bench *bench, double budget_s, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (int i = 0; i < bench->row_count && status == RB_OK; i++)
        if (bench->rows[i].state == RB_ROW_MEASURED)
            status = open_row(bench, &bench->rows[i], RB_SAMPLE_TILE, error);
    if (status)
        return status;
    rb_tiles_fit(&bench->tiles, bench->rows[0].renderer, budget_s);
    run_groups(bench);
    for (int i = 0; i < bench->row_count && status == RB_OK; i++)
        if (bench->rows[i].state == RB_ROW_MEASURED)
            status = settle_row(bench, &bench->rows[i], error);
    return status;
}

// A frame of every measured row, which also warms up; hits, image and rays must be equal again.
static void run_first_round(struct rb_scene_bench *bench)
{
    struct rb_run_result first, result;
    const struct rb_run_options options = {.hash_hits = true};
    for (int i = 0; i < bench->row_count; i++) {
        struct rb_row *row = &bench->rows[i];
        if (row->state != RB_ROW_MEASURED)
            continue;
        rb_renderer_run(row->renderer, &options, &result);
        if (bench->frame_rays == 0) {
            first = result;
            bench->frame = result.recorder;
            bench->frame_rays = rb_result_rays(&result);
        } else if (!same_rays(&first, &result)) {
            invalidate(bench, row);
        }
    }
}

static void time_rounds(struct rb_scene_bench *bench, double budget_s)
{
    uint64_t start_ns = rb_clock_ns();
    for (int round = 0; round < RB_ROW_SAMPLES_MAX; round++) {
        double spent_s = seconds_since(start_ns);
        if (round > 0 && spent_s > budget_s &&
            (round >= ROUNDS_WANTED || spent_s > PATIENCE * budget_s))
            break;
        for (int i = 0; i < bench->row_count; i++) {
            struct rb_row *row = &bench->rows[i];
            if (row->state == RB_ROW_MEASURED)
                rb_renderer_run(row->renderer, NULL, &row->samples[row->sample_count++]);
        }
    }
}

static enum rb_status list_rows(struct rb_scene_bench *bench, struct rb_error *error)
{
    for (const struct rb_variant *v = rb_variants; v->name && bench->row_count < RB_ROWS_MAX; v++) {
        if (v->best_of) // measured under its own name
            continue;
        struct rb_row *row = &bench->rows[bench->row_count++];
        row->variant = v;
        row->state = rb_variant_available(v) ? RB_ROW_MEASURED : RB_ROW_UNAVAILABLE;
        row->samples = rb_alloc(RB_ROW_SAMPLES_MAX, sizeof *row->samples);
        if (!row->samples)
            return rb_error_memory(error, "the measurements");
    }
    return RB_OK;
}

enum rb_status rb_scene_bench_run(struct rb_scene_bench *bench, const char *name,
                                  const struct rb_scene *scene, const struct rb_settings *settings,
                                  double budget_s, struct rb_error *error)
{
    *bench = (struct rb_scene_bench){.name = name, .scene = scene, .settings = *settings};
    enum rb_status status = rb_settings_complete(&bench->settings, scene, error);
    if (status == RB_OK)
        status = list_rows(bench, error);
    if (status == RB_OK)
        status = rb_tiles_shuffle(&bench->tiles, bench->settings.width, bench->settings.height,
                                  bench->settings.seed, error);
    if (status == RB_OK)
        status = verify(bench, budget_s * SAMPLE_SHARE, error);
    if (status)
        return status;
    run_first_round(bench);
    time_rounds(bench, budget_s * ROUNDS_SHARE);
    return RB_OK;
}

void rb_scene_bench_free(struct rb_scene_bench *bench)
{
    for (int i = 0; i < bench->row_count; i++) {
        rb_renderer_free(bench->rows[i].renderer);
        rb_free(bench->rows[i].samples);
    }
    rb_free(bench->tiles.order);
    bench->tiles.order = NULL;
    bench->row_count = 0;
}

const struct rb_row *rb_scene_bench_row(const struct rb_scene_bench *bench, const char *name)
{
    for (int i = 0; i < bench->row_count; i++)
        if (strcmp(bench->rows[i].variant->name, name) == 0)
            return &bench->rows[i];
    return NULL;
}
