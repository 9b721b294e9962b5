#include "bench/run/reference.h"

#include "base/file.h"
#include "base/hash.h"
#include "bench/data/csv_read.h"
#include "bench/run/tiles.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// One ray against one primitive by naive, one thread: 5.7 ns on a Zen 4 at 3.7 GHz (balls_high).
// Used to plan only.
static const double NAIVE_TEST_S = 6e-9;

// Above, naive in full is only made when asked for.
enum { PRIMITIVES_MAX = 100000 };

void rb_reference_words(const struct rb_settings *settings, const char *program,
                        const struct rb_variant *variant, struct rb_worker_words *words)
{
    rb_worker_word(words, "%s", program);
    rb_worker_word(words, "worker");
    rb_worker_word(words, "--variant=%s", variant->name);
    rb_worker_word(words, "--size=%dx%d", settings->width, settings->height);
    rb_worker_word(words, "--depth=%d", settings->depth);
    rb_worker_word(words, "--aa=%d", settings->aa);
    rb_worker_word(words, "--light-samples=%d", settings->light_samples);
    rb_worker_word(words, "--light-size=%.17g", settings->light_size);
    rb_worker_word(words, "--light-scale=%.17g", settings->light_scale);
    rb_worker_word(words, "--ambient=%.17g", settings->ambient);
    rb_worker_word(words, "--specular=%s", settings->phong ? "phong" : "blinn");
    if (settings->spd)
        rb_worker_word(words, "--spd");
    rb_worker_word(words, "--seed=%" PRIu64, settings->seed);
    rb_worker_word(words, "--tile=%d", settings->tile);
    rb_worker_word(words, "--threads=%d", settings->threads);
    rb_worker_word(words, "--quiet");
}

void rb_reference_scene_word(const struct rb_reference *reference, struct rb_worker_words *words)
{
    rb_worker_word(words, "--");
    rb_worker_word(words, "%s", reference->scene_name);
}

double rb_reference_naive_s(const struct rb_reference *reference)
{
    return NAIVE_TEST_S * reference->rays * reference->primitive_count;
}

void rb_reference_choose_group(struct rb_cell *cell, double slice_s)
{
    double frame_s = rb_reference_naive_s(cell->reference) / cell->settings.threads;
    if (cell->variant->accelerator != RB_ACCEL_NONE || 2 * frame_s < slice_s)
        return;
    int columns = (cell->settings.width - 1) / RB_SAMPLE_TILE + 1;
    int rows = (cell->settings.height - 1) / RB_SAMPLE_TILE + 1;
    double tiles = (double)columns * rows, affordable = tiles * slice_s / 2 / frame_s;
    cell->group_tiles = affordable > 1 ? (uint32_t)affordable : 1;
    cell->group_population = tiles / cell->group_tiles;
    cell->settings.tile = RB_SAMPLE_TILE;
}

static bool keep_sample(void *user, const struct rb_sample *sample)
{
    *(struct rb_sample *)user = *sample;
    return true;
}

// Runs one worker of a row, serial or, if it is there, parallel, and keeps its sample.
static enum rb_status render(const struct rb_reference *reference, const char *program,
                             const char *row, uint32_t group_tiles, struct rb_sample *sample,
                             struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    struct rb_settings settings = reference->settings;
    char parallel[64];
    snprintf(parallel, sizeof parallel, "%s+omp", row);
    const struct rb_variant *variant = rb_variant_find(parallel);
    if (!variant || !rb_variant_available(variant))
        variant = rb_variant_find(row);
    settings.threads = rb_threads_default();
    settings.tile = group_tiles ? RB_SAMPLE_TILE : RB_TILE_DEFAULT;
    rb_reference_words(&settings, program, variant, &words);
    rb_worker_word(&words, "--cpu=-1");
    rb_worker_word(&words, "--slice=0");
    if (group_tiles)
        rb_worker_word(&words, "--group-tiles=%u", group_tiles);
    rb_reference_scene_word(reference, &words);
    enum rb_status status =
        rb_process_run(&words, false, sizeof(struct rb_sample), keep_sample, sample, error);
    if (status == RB_INVALID)
        return rb_error_set(error, RB_INVALID,
                            "%s: naive and bvh disagree on a sample of tiles; there is no "
                            "reference",
                            reference->scene_name);
    return status;
}

// What the image depends on, in words: the key of the cache.
static void describe(const struct rb_reference *reference, char text[256])
{
    const struct rb_settings *s = &reference->settings;
    snprintf(text, 256,
             "%dx%d depth %d aa %d lights %d %.17g %.17g ambient %.17g %s%s seed %" PRIu64,
             s->width, s->height, s->depth, s->aa, s->light_samples, s->light_size, s->light_scale,
             s->ambient, s->phong ? "phong" : "blinn", s->spd ? " spd" : "", s->seed);
}

static bool look_up(struct rb_reference *reference, const char *cache_path)
{
    struct rb_csv csv;
    struct rb_error error = {0};
    char settings[256];
    bool found = false;
    describe(reference, settings);
    if (access(cache_path, R_OK) != 0 || rb_csv_load(cache_path, &csv, &error))
        return false;
    for (size_t row = 0; row < csv.row_count && !found; row++) {
        uint64_t scene, image, hits;
        found = rb_csv_word(&csv, row, rb_csv_column(&csv, "scene_hash"), &scene, 16) &&
                scene == reference->scene_hash &&
                strcmp(rb_csv_text(&csv, row, rb_csv_column(&csv, "settings")), settings) == 0 &&
                rb_csv_word(&csv, row, rb_csv_column(&csv, "image_hash"), &image, 16) &&
                rb_csv_word(&csv, row, rb_csv_column(&csv, "hits_hash"), &hits, 16);
        if (found) {
            reference->image_hash = image;
            reference->hits_hash = hits;
        }
    }
    rb_csv_free(&csv);
    return found;
}

// Appends by rewriting: the file is small and is never half written.
static enum rb_status keep(const struct rb_reference *reference, const char *cache_path,
                           struct rb_error *error)
{
    struct rb_output output;
    char settings[256];
    describe(reference, settings);
    enum rb_status status = rb_output_open(&output, cache_path, error);
    if (status)
        return status;
    FILE *old = fopen(cache_path, "r");
    if (!old)
        fputs("scene_hash,settings,image_hash,hits_hash\r\n", output.stream);
    for (int c; old && (c = getc(old)) != EOF;)
        fputc(c, output.stream);
    if (old)
        fclose(old);
    fprintf(output.stream, "%016" PRIx64 ",%s,%016" PRIx64 ",%016" PRIx64 "\r\n",
            reference->scene_hash, settings, reference->image_hash, reference->hits_hash);
    return rb_output_commit(&output, error);
}

static void adopt(struct rb_reference *reference, const struct rb_sample *sample, const char *row)
{
    reference->image_hash = sample->image_hash;
    reference->hits_hash = sample->hits_hash;
    reference->made_by = row;
}

// About half a second's worth of small tiles, for the check against naive.
static uint32_t sample_tiles(const struct rb_reference *reference)
{
    double tiles = ((double)reference->settings.width / RB_SAMPLE_TILE + 1) *
                   ((double)reference->settings.height / RB_SAMPLE_TILE + 1);
    double affordable = 0.5 / (rb_reference_naive_s(reference) / tiles);
    return affordable < 1 ? 1 : affordable > tiles ? (uint32_t)tiles : (uint32_t)affordable;
}

enum rb_status rb_reference_make(struct rb_reference *reference, const char *program,
                                 const char *cache_path, double budget_s, bool full,
                                 struct rb_error *error)
{
    static struct rb_sample naive; // too large for the stack
    enum rb_status status = render(reference, program, "bvh", 0, &reference->frame, error);
    if (status)
        return status;
    reference->rays = (double)rb_sample_rays(&reference->frame);
    if (look_up(reference, cache_path)) {
        reference->made_by = "naive";
        reference->cached = true;
        return RB_OK;
    }
    bool small = reference->primitive_count <= PRIMITIVES_MAX;
    if (full || (small && rb_reference_naive_s(reference) / rb_threads_default() <= budget_s)) {
        status = render(reference, program, "naive", 0, &naive, error);
        if (status)
            return status;
        adopt(reference, &naive, "naive");
        return keep(reference, cache_path, error);
    }
    status = render(reference, program, "naive", sample_tiles(reference), &naive, error);
    if (status == RB_OK)
        adopt(reference, &reference->frame, "bvh");
    return status;
}
