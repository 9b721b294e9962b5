// Which row is best for a class of rays. A tree is built once for all rows that trace through it,
// and all of them answer the same batches, a random sample, in two passes, so that what else the
// machine does cannot hit all runs of a tree; the second one has the rows that were close to the
// best of some class, and more runs. A sample of 16 batches of 4096 rays has misjudged rows that
// differ by 6 %; it has 64. Rows that are alike may still be told apart wrongly.
#include "bench/versus/versus.h"

#include "base/hash.h"
#include "embree/embree.h"
#include "render/embree_rows.h"
#include "render/renderer.h"

#include <math.h>
#include <string.h>

enum { SAMPLE_RAYS = 262144, PASSES = 2, ROWS_MAX = 256 };
static const double CLOSE = 1.2; // times the best
static const int pass_runs[PASSES] = {2, 5};

// The sampled rays of all classes.
struct sample {
    struct rb_record record;
    struct rb_replay replay;
    uint64_t rays;
    double read_s;
};

struct samples {
    struct sample of[RB_VERSUS_CLASS_COUNT];
    int runs;
    double round_s[2][ROWS_MAX][RB_VERSUS_CLASS_COUNT]; // by side and row; 0: not tried
};

static double since_s(uint64_t start_ns)
{
    return (double)(rb_clock_ns() - start_ns) * 1e-9;
}

// Keeps random batches, as many as hold SAMPLE_RAYS, and frees the others.
static void thin_out(struct sample *sample)
{
    struct rb_batch *batches = sample->record.batches.data;
    size_t count = sample->record.batches.count, kept = 0;
    for (size_t i = 0; i < count; i++) { // Fisher and Yates
        size_t j = i + (size_t)(rb_hash_word(0, i) % (count - i));
        struct rb_batch batch = batches[j];
        batches[j] = batches[i];
        batches[i] = batch;
        if (sample->rays < SAMPLE_RAYS)
            sample->rays += rb_batch_count(&batches[kept++]);
        else
            rb_batch_free(&batches[i]);
    }
    sample->record.batches.count = kept;
}

static enum rb_status read_samples(const char *path, struct samples *samples,
                                   struct rb_contest *contests, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (int c = 0; c < RB_VERSUS_CLASS_COUNT && status == RB_OK; c++) {
        struct sample *sample = &samples->of[c];
        uint64_t start_ns = rb_clock_ns();
        status = rb_record_read(path, &rb_versus_classes[c].rays, &sample->record, error);
        sample->read_s = since_s(start_ns);
        const struct rb_batch *batches = sample->record.batches.data;
        for (size_t i = 0; i < sample->record.batches.count; i++)
            contests[c].ray_count += rb_batch_count(&batches[i]);
        thin_out(sample);
        sample->replay =
            (struct rb_replay){rb_versus_classes[c].rays.kernel, sample->record.batches.data,
                               sample->record.batches.count, 1};
    }
    return status;
}

static void free_samples(struct samples *samples)
{
    for (int c = 0; c < RB_VERSUS_CLASS_COUNT; c++)
        rb_record_free(&samples->of[c].record);
}

// Seconds for all rays of a contest, from the fastest of some runs over the sample.
static double round_s(struct rb_renderer *renderer, const struct sample *sample, uint64_t rays,
                      int runs)
{
    const struct rb_run_options how = {.replay = &sample->replay};
    double best_ns = (double)INFINITY;
    for (int run = 0; run < runs; run++) {
        struct rb_run_result result;
        rb_renderer_run(renderer, &how, &result);
        best_ns = fmin(best_ns, (double)result.wall_ns);
    }
    return best_ns * 1e-9 * (double)rays / (double)sample->rays;
}

static void try_row(struct rb_renderer *renderer, const struct rb_variant *row, size_t index,
                    double load_s, struct samples *samples, struct rb_contest *contests, int side)
{
    bool from_light = strstr(row->name, "-light") != NULL; // the same as without for other rays
    for (int c = 0; c < RB_VERSUS_CLASS_COUNT; c++) {
        const struct sample *sample = &samples->of[c];
        struct rb_versus_side *best = &contests[c].side[side];
        if (!sample->rays || (from_light && sample->replay.kernel != RB_STAGE_TRACE_SHADOW))
            continue;
        double seconds = round_s(renderer, sample, contests[c].ray_count, samples->runs);
        samples->round_s[side][index][c] = seconds;
        if (best->row && seconds >= best->round_s)
            continue;
        best->row = row;
        best->round_s = seconds;
        best->load_s = load_s + sample->read_s;
    }
}

static bool takes_part(const struct rb_variant *row)
{
    return rb_variant_available(row) && !row->best_of && !rb_variant_parallel(row) &&
           row->accelerator != RB_ACCEL_NONE;
}

// Was the row close to the best anywhere, or was nothing tried yet?
static bool is_close(const struct samples *samples, const struct rb_contest *contests, int side,
                     size_t index)
{
    bool close = false;
    for (int c = 0; c < RB_VERSUS_CLASS_COUNT; c++) {
        double seconds = samples->round_s[side][index][c];
        close = close || (seconds > 0 && seconds <= CLOSE * contests[c].side[side].round_s);
    }
    return close;
}

// Builds the tree of a row, and checks the samples against it.
static enum rb_status open_row(const struct rb_scene *scene, const struct rb_variant *row,
                               const struct samples *samples, struct rb_renderer **renderer,
                               struct rb_error *error)
{
    enum rb_status status =
        rb_renderer_create(scene, row, &samples->of[0].record.header.settings, renderer, error);
    for (int c = 0; c < RB_VERSUS_CLASS_COUNT && status == RB_OK; c++)
        status = rb_replay_check(*renderer, &samples->of[c].replay, error);
    return status;
}

// All rows of a table that are exact (ours), or are not.
static enum rb_status try_table(const struct rb_variant *table, bool exact,
                                const struct rb_scene *scene, double load_s, bool first,
                                struct samples *samples, struct rb_contest *contests,
                                struct rb_error *error)
{
    int side = exact ? 0 : 1;
    struct rb_renderer *renderer = NULL;
    enum rb_status status = RB_OK;
    double build_s = 0;
    for (const struct rb_variant *row = table; row->name && status == RB_OK; row++) {
        bool spheres = scene->count[RB_SPHERE] > 0;
        if (!takes_part(row) || row->exact != exact || (!spheres && strstr(row->name, "-native")))
            continue;
        size_t index = (size_t)(row - table);
        if (index >= ROWS_MAX || (!first && !is_close(samples, contests, side, index)))
            continue;
        if (!renderer || !rb_renderer_take_row(renderer, row)) {
            rb_renderer_free(renderer);
            uint64_t start_ns = rb_clock_ns();
            status = open_row(scene, row, samples, &renderer, error);
            build_s = since_s(start_ns);
        }
        if (status == RB_OK)
            try_row(renderer, row, index, load_s + build_s, samples, contests, side);
    }
    rb_renderer_free(renderer);
    return status;
}

// Tests that the rays of the samples need, one at a time.
static enum rb_status count_tests(const struct rb_scene *scene, const struct samples *samples,
                                  struct rb_contest *contests, struct rb_error *error)
{
    static struct rb_count_table table;
    const struct rb_variant *row = rb_variant_find("bvh8-avx2");
    struct rb_renderer *renderer;
    struct rb_run_result result;
    if (!rb_variant_available(row))
        return RB_OK;
    enum rb_status status = open_row(scene, row, samples, &renderer, error);
    for (int c = 0; c < RB_VERSUS_CLASS_COUNT && status == RB_OK; c++) {
        const struct sample *sample = &samples->of[c];
        const struct rb_record_choice *rays = &rb_versus_classes[c].rays;
        const struct rb_run_options how = {.replay = &sample->replay, .counts = &table};
        if (!sample->rays)
            continue;
        table = (struct rb_count_table){0};
        rb_renderer_run(renderer, &how, &result);
        contests[c].tests = rb_versus_tests_of(&table.at[rays->kernel][rays->bounce], sample->rays);
    }
    rb_renderer_free(renderer);
    return status;
}

enum rb_status rb_versus_choose(const char *path, const struct rb_scene *scene, double load_s,
                                struct rb_contest contests[RB_VERSUS_CLASS_COUNT],
                                struct rb_error *error)
{
    struct samples *samples = rb_alloc(1, sizeof *samples);
    if (!samples)
        return rb_error_memory(error, "the samples");
    enum rb_status status = read_samples(path, samples, contests, error);
    for (int pass = 0; pass < PASSES && status == RB_OK; pass++) {
        bool first = pass == 0;
        samples->runs = pass_runs[pass];
        status = try_table(rb_variants, true, scene, load_s, first, samples, contests, error);
        if (status == RB_OK)
            status =
                try_table(rb_embree_rows, false, scene, load_s, first, samples, contests, error);
    }
    if (status == RB_OK)
        status = count_tests(scene, samples, contests, error);
    free_samples(samples);
    rb_free(samples);
    return status;
}
