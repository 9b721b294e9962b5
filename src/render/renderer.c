#include "render/renderer.h"

#include "base/fpenv.h"
#include "base/hash.h"
#include "base/memory.h"
#include "embree/embree.h"
#include "render/frame.h"
#include "render/inside.h"

#include <string.h>

// No more workers than tiles.
static int worker_count(const struct rb_renderer *renderer)
{
    uint32_t tiles = rb_renderer_tile_count(renderer);
    int threads = renderer->frame.settings.threads;
    if (!rb_variant_parallel(renderer->variant))
        return 1;
    return tiles < (uint32_t)threads ? (int)tiles : threads;
}

// Embree takes its own time, without the copies it wants of the scene.
static enum rb_status build_embree(struct rb_renderer *renderer, struct rb_error *error)
{
    struct rb_embree_cost cost = {0};
    if (renderer->frame.settings.spd)
        return rb_error_set(error, RB_INVALID, "Embree does not know SPD's one-sided surfaces");
    enum rb_status status =
        rb_embree_build(renderer->frame.world.scene, renderer->variant->embree,
                        worker_count(renderer), &renderer->embree, &cost, error);
    renderer->build_ns = cost.build_ns;
    renderer->embree_bytes = cost.bytes;
    renderer->frame.world.embree = renderer->embree;
    return status;
}

static enum rb_status build_accelerator(struct rb_renderer *renderer, struct rb_error *error)
{
    struct rb_world *world = &renderer->frame.world;
    enum rb_accelerator accelerator = renderer->variant->accelerator;
    int threads = worker_count(renderer);
    enum rb_status status = RB_OK;
    if (accelerator == RB_ACCEL_NONE)
        return RB_OK;
    if (accelerator == RB_ACCEL_EMBREE)
        return build_embree(renderer, error);
    uint64_t start_ns = rb_clock_ns();
    if (accelerator == RB_ACCEL_BVH) {
        status = rb_bvh_build(world->scene, threads, &renderer->bvh, error);
        world->bvh = &renderer->bvh;
    } else {
        status = rb_wide_build(world->scene, threads, &renderer->wide, error);
        world->wide = &renderer->wide;
    }
    renderer->build_ns = rb_clock_ns() - start_ns;
    return status;
}

static enum rb_status allocate(struct rb_renderer *renderer, struct rb_error *error)
{
    struct rb_frame *frame = &renderer->frame;
    size_t pixels = (size_t)frame->settings.width * (size_t)frame->settings.height;
    frame->film.rgb = rb_alloc(pixels, 3 * sizeof *frame->film.rgb);
    renderer->workers = rb_alloc((size_t)worker_count(renderer), sizeof *renderer->workers);
    if (!frame->film.rgb || !renderer->workers)
        return rb_error_memory(error, "the image");
    uint32_t tile_pixels = (uint32_t)(frame->settings.tile * frame->settings.tile);
    uint32_t batch = tile_pixels < RB_BATCH_MAX ? tile_pixels : RB_BATCH_MAX;
    for (int i = 0; i < worker_count(renderer); i++) {
        struct rb_worker *worker = &renderer->workers[i];
        worker->frame = frame;
        worker->reports = i == 0;
        if (rb_queues_alloc(&worker->queues, batch, frame->settings.depth, error))
            return RB_FAILED;
    }
    return RB_OK;
}

static enum rb_status prepare(struct rb_renderer *renderer, struct rb_error *error)
{
    struct rb_frame *frame = &renderer->frame;
    const struct rb_scene *scene = frame->world.scene;
    enum rb_status status = rb_settings_complete(&frame->settings, scene, error);
    if (status)
        return status;
    frame->kernels = renderer->variant->kernels;
    frame->world.one_sided = frame->settings.spd;
    frame->view = rb_view_make(scene, &frame->settings);
    frame->shading = rb_shading_make(scene, &frame->settings);
    frame->film.width = frame->settings.width;
    frame->film.height = frame->settings.height;
    frame->film.limit = RB_FILM_RANGE / (float)(frame->view.aa * frame->view.aa);
    frame->tiles_x = (frame->film.width - 1) / frame->settings.tile + 1;
    frame->tiles_y = (frame->film.height - 1) / frame->settings.tile + 1;
    status = allocate(renderer, error);
    return status ? status : build_accelerator(renderer, error);
}

enum rb_status rb_renderer_create(const struct rb_scene *scene, const struct rb_variant *variant,
                                  const struct rb_settings *settings, struct rb_renderer **renderer,
                                  struct rb_error *error)
{
    *renderer = NULL;
    if (!rb_variant_available(variant))
        return rb_error_set(error, RB_INVALID,
                            "variant %s needs %s, which this machine or build has not",
                            variant->name, variant->needs);
    struct rb_renderer *made = rb_alloc(1, sizeof *made);
    if (!made)
        return rb_error_memory(error, "the renderer");
    made->variant = rb_variant_resolve(variant);
    made->frame.world.scene = scene;
    made->frame.settings = *settings;
    fenv_t saved;
    rb_fpenv_enter(&saved);
    enum rb_status status = prepare(made, error);
    rb_fpenv_leave(&saved);
    if (status)
        rb_renderer_free(made);
    else
        *renderer = made;
    return status;
}

void rb_renderer_free(struct rb_renderer *renderer)
{
    if (!renderer)
        return;
    for (int i = 0; renderer->workers && i < worker_count(renderer); i++)
        rb_queues_free(&renderer->workers[i].queues);
    rb_free(renderer->workers);
    rb_free(renderer->frame.film.rgb);
    rb_bvh_free(&renderer->bvh);
    rb_wide_free(&renderer->wide);
    rb_embree_free(renderer->embree);
    rb_free(renderer);
}

bool rb_renderer_take_row(struct rb_renderer *renderer, const struct rb_variant *row)
{
    const struct rb_variant *now = renderer->variant;
    if (!row->kernels || row->accelerator != now->accelerator || row->embree != now->embree ||
        rb_variant_parallel(row) || rb_variant_parallel(now))
        return false;
    renderer->variant = row;
    renderer->frame.kernels = row->kernels;
    return true;
}

float rb_film_value(const struct rb_frame *frame, size_t index)
{
    double samples = (double)(frame->view.aa * frame->view.aa);
    return (float)((double)(int64_t)frame->film.rgb[index] * 0x1p-32 / samples);
}

// Tiles that were not rendered are black in every row's film, so they need not be left out.
static uint64_t image_hash(const struct rb_frame *frame)
{
    size_t count = 3 * (size_t)frame->film.width * (size_t)frame->film.height;
    uint64_t hash = (uint64_t)frame->film.width << 32 | (uint64_t)frame->film.height;
    for (size_t i = 0; i < count; i++)
        hash = rb_hash_word(hash, rb_float_bits(rb_film_value(frame, i)));
    return hash;
}

void rb_film_clear(struct rb_film *film)
{
    memset(film->rgb, 0, 3 * sizeof *film->rgb * (size_t)film->width * (size_t)film->height);
}

static void add_counts(struct rb_count_table *to, const struct rb_count_table *from)
{
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            rb_counts_add(&to->at[stage][bounce], &from->at[stage][bounce]);
}

void rb_renderer_run(struct rb_renderer *renderer, const struct rb_run_options *options,
                     struct rb_run_result *result)
{
    static const struct rb_run_options defaults;
    struct rb_frame *frame = &renderer->frame;
    options = options ? options : &defaults;
    frame->how = *options;
    if (!frame->how.tiles)
        frame->how.tile_count = rb_renderer_tile_count(renderer);
    frame->kernels = options->counts ? renderer->variant->counted : renderer->variant->kernels;
    atomic_store(&frame->next_tile, 0);
    atomic_store(&frame->tiles_done, 0);
    int count = worker_count(renderer);
    for (int i = 0; i < count; i++) {
        renderer->workers[i].recorder = (struct rb_recorder){0};
        renderer->workers[i].counts = (struct rb_count_table){0};
        if (options->events) // not all of them need take part
            renderer->workers[i].counter.table = (struct rb_event_table){.cost_ticks = 0};
        renderer->workers[i].hits_hash = 0;
    }
    rb_film_clear(&frame->film);

    fenv_t saved;
    rb_fpenv_enter(&saved);
    uint64_t start_ns = rb_clock_ns();
    renderer->variant->schedule(frame, renderer->workers, count);
    *result = (struct rb_run_result){
        .wall_ns = rb_clock_ns() - start_ns,
        .thread_count = frame->thread_count,
    };
    for (int i = 0; i < count; i++) {
        uint64_t busy = rb_recorder_ticks(&renderer->workers[i].recorder);
        result->busy_max_ticks = busy > result->busy_max_ticks ? busy : result->busy_max_ticks;
        rb_recorder_add(&result->recorder, &renderer->workers[i].recorder);
        result->hits_hash += renderer->workers[i].hits_hash;
        if (options->counts)
            add_counts(options->counts, &renderer->workers[i].counts);
        if (options->events)
            rb_event_table_add(options->events, &renderer->workers[i].counter.table);
    }
    result->image_hash = image_hash(frame);
    rb_fpenv_leave(&saved);
}

void rb_renderer_pixels(const struct rb_renderer *renderer, float *pixels)
{
    const struct rb_film *film = &renderer->frame.film;
    size_t count = 3 * (size_t)film->width * (size_t)film->height;
    fenv_t saved;
    rb_fpenv_enter(&saved);
    for (size_t i = 0; i < count; i++)
        pixels[i] = rb_film_value(&renderer->frame, i);
    rb_fpenv_leave(&saved);
}

const struct rb_settings *rb_renderer_settings(const struct rb_renderer *renderer)
{
    return &renderer->frame.settings;
}

uint32_t rb_renderer_tile_count(const struct rb_renderer *renderer)
{
    return (uint32_t)renderer->frame.tiles_x * (uint32_t)renderer->frame.tiles_y;
}

uint64_t rb_renderer_build_ns(const struct rb_renderer *renderer)
{
    return renderer->build_ns;
}

size_t rb_renderer_tree_bytes(const struct rb_renderer *renderer)
{
    return renderer->bvh.bytes + renderer->wide.bytes + renderer->embree_bytes;
}
