// The wavefront pipeline of one worker: tile by tile, sample by sample, batch by batch
//
//     generate -> [ trace -> surface -> (light -> trace_shadow -> resolve)* ] -> children
//
// with a probe after each stage and nowhere else. Stages rather than recursion per ray is what
// makes their time measurable and their rays packable (Laine, Karras, Aila 2013, "Megakernels
// considered harmful"). Bounces are walked depth first by batches, so memory is bounded by depth,
// not by the number of rays.
#include "base/fpenv.h"
#include "base/hash.h"
#include "measure/simulate.h"
#include "render/frame.h"

// Of the counts of a stage, what its rays have cost their pixels.
static void heat(struct rb_worker *worker, const uint32_t *pixel, uint32_t count)
{
    uint32_t *cost = worker->queues.cost;
    for (uint32_t i = 0; i < count && worker->frame->how.heat; i++) {
        worker->frame->how.heat[pixel[i]] += cost[i];
        cost[i] = 0;
    }
}

// The stage that a test wants slower takes its share longer.
void rb_worker_lap(struct rb_worker *worker, enum rb_stage stage, int bounce, uint64_t rays)
{
    const struct rb_frame *frame = worker->frame;
    if (frame->how.slow_share > 0 && stage == frame->how.slow_stage)
        rb_probe_spin(&worker->recorder, frame->how.slow_share);
    rb_probe_lap(&worker->recorder, stage, bounce, rays);
    if (frame->how.simulate_from)
        rb_simulate_lap(stage, bounce, rays);
    if (frame->how.events && !frame->how.replay) {
        rb_events_lap(&worker->counter, stage, bounce);
        rb_probe_start(&worker->recorder); // reading them is no part of a frame
    }
    if (frame->how.counts)
        rb_counts_take(&worker->counts.at[stage][bounce]);
}

void rb_worker_begin(struct rb_worker *worker)
{
    if (worker->frame->how.events)
        rb_events_open(&worker->counter, worker->frame->how.event_group);
    rb_probe_start(&worker->recorder);
}

void rb_worker_end(struct rb_worker *worker)
{
    if (worker->frame->how.simulate_from)
        rb_simulate_stop();
    if (worker->frame->how.events)
        rb_events_close(&worker->counter);
}

static uint64_t hash_hits(const struct rb_rays *rays, const struct rb_hits *hits, uint32_t sample)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < rays->count; i++) {
        uint64_t h = rb_hash_word(sample, (uint64_t)rays->pixel[i] << 32 | rays->path[i]);
        h = rb_hash_word(h, (uint64_t)hits->prim[i] << 32 | rb_float_bits(hits->t[i]));
        h = rb_hash_word(h, (uint64_t)rb_float_bits(hits->u[i]) << 32 | rb_float_bits(hits->v[i]));
        sum += h;
    }
    return sum;
}

static void resolve_shadows(struct rb_film *film, const struct rb_shadows *shadows)
{
    for (uint32_t i = 0; i < shadows->count; i++)
        if (!shadows->occluded[i])
            rb_film_add(film, shadows->pixel[i], shadows->r[i], shadows->g[i], shadows->b[i]);
}

static void trace_shadows(struct rb_worker *worker, int bounce, void *user)
{
    (void)user;
    struct rb_frame *frame = worker->frame;
    struct rb_shadows *shadows = &worker->queues.shadows;
    frame->kernels->trace_shadow(&frame->world, shadows);
    rb_worker_lap(worker, RB_STAGE_TRACE_SHADOW, bounce, shadows->count);
    heat(worker, shadows->pixel, shadows->count);
    if (frame->how.observer) {
        frame->how.observer->shadowed(frame->how.observer->user, &worker->span, bounce, shadows);
        rb_probe_start(&worker->recorder);
    }
    resolve_shadows(&frame->film, shadows);
    rb_worker_lap(worker, RB_STAGE_RESOLVE, bounce, 0);
}

static void flush_shadows(struct rb_worker *worker, int bounce, rb_flush_fn *flush, void *user)
{
    struct rb_shadows *shadows = &worker->queues.shadows;
    if (shadows->count)
        flush(worker, bounce, user);
    shadows->count = 0;
}

// Light after light, so that the shadow rays of one light stay together.
static void light_surfaces(struct rb_worker *worker, int bounce, rb_flush_fn *flush, void *user)
{
    const struct rb_frame *frame = worker->frame;
    const struct rb_surfaces *surfaces = &worker->queues.surfaces;
    struct rb_shadows *shadows = &worker->queues.shadows;
    struct rb_light_sample sample = {.pixel_sample = worker->span.sample};
    for (; sample.light < frame->world.scene->light_count; sample.light++) {
        for (sample.sample = 0; sample.sample < frame->shading.light_samples; sample.sample++) {
            if (shadows->count + surfaces->count > shadows->capacity)
                flush_shadows(worker, bounce, flush, user);
            frame->kernels->light(&frame->world, &frame->shading, surfaces, &sample, shadows);
            rb_worker_lap(worker, RB_STAGE_SHADE, bounce, 0);
            heat(worker, surfaces->pixel, surfaces->count);
        }
    }
    flush_shadows(worker, bounce, flush, user);
}

struct rb_children rb_worker_shade(struct rb_worker *worker, int bounce, const struct rb_rays *rays,
                                   const struct rb_hits *hits, rb_flush_fn *flush, void *user)
{
    struct rb_frame *frame = worker->frame;
    struct rb_queues *queues = &worker->queues;
    bool last = bounce + 1 == frame->settings.depth;
    struct rb_rays reflected = {0}, refracted = {0};
    if (!last) {
        struct rb_rays *next = &queues->rays[bounce + 1];
        reflected = rb_rays_view(next, 0, 0, queues->batch);
        refracted = rb_rays_view(next, queues->batch, 0, queues->batch);
    }
    queues->surfaces.count = 0;
    frame->kernels->surface(&frame->world, &frame->shading, rays, hits, &queues->surfaces,
                            last ? NULL : &reflected, last ? NULL : &refracted, &frame->film);
    worker->recorder.hits[bounce] += queues->surfaces.count;
    rb_worker_lap(worker, RB_STAGE_SHADE, bounce, rays->count);
    light_surfaces(worker, bounce, flush, user);
    return (struct rb_children){reflected.count, refracted.count};
}

static void trace_children(struct rb_worker *worker, struct rb_children children, int bounce);

// Everything that becomes of the rays [first, first + count) of the queue of `bounce`.
static void trace_batch(struct rb_worker *worker, int bounce, uint32_t first, uint32_t count)
{
    const struct rb_frame *frame = worker->frame;
    struct rb_queues *queues = &worker->queues;
    struct rb_rays rays = rb_rays_view(&queues->rays[bounce], first, count, count);
    rb_worker_lap(worker, RB_STAGE_OTHER, bounce, 0);

    frame->kernels->trace(&frame->world, &rays, &queues->hits);
    rb_worker_lap(worker, RB_STAGE_TRACE, bounce, count);
    heat(worker, rays.pixel, count);
    if (frame->how.hash_hits)
        worker->hits_hash += hash_hits(&rays, &queues->hits, worker->span.sample);
    if (frame->how.observer)
        frame->how.observer->traced(frame->how.observer->user, &worker->span, bounce, &rays,
                                    &queues->hits);
    if (frame->how.hash_hits || frame->how.observer)
        rb_probe_start(&worker->recorder); // neither is a part of a frame

    struct rb_children children =
        rb_worker_shade(worker, bounce, &rays, &queues->hits, trace_shadows, NULL);
    if (bounce + 1 < frame->settings.depth)
        trace_children(worker, children, bounce + 1);
}

// The children lie in two runs, at the start and in the middle of their queue. They are traced
// together, or in two batches if they are too many.
static void trace_children(struct rb_worker *worker, struct rb_children children, int bounce)
{
    struct rb_queues *queues = &worker->queues;
    worker->recorder.reflected[bounce] += children.reflected;
    worker->recorder.refracted[bounce] += children.refracted;
    rb_rays_move(&queues->rays[bounce], children.reflected, queues->batch, children.refracted);
    uint32_t count = children.reflected + children.refracted;
    for (uint32_t first = 0; first < count; first += queues->batch) {
        uint32_t rest = count - first;
        trace_batch(worker, bounce, first, rest < queues->batch ? rest : queues->batch);
    }
}

static void render_span(struct rb_worker *worker, const struct rb_span *span)
{
    struct rb_rays *rays = &worker->queues.rays[0];
    rays->count = 0;
    worker->span = *span;
    rb_worker_lap(worker, RB_STAGE_OTHER, 0, 0);
    worker->frame->kernels->generate(&worker->frame->view, span, rays);
    rb_worker_lap(worker, RB_STAGE_GENERATE, 0, rays->count);
    trace_batch(worker, 0, 0, rays->count);
}

static int min_int(int a, int b)
{
    return a < b ? a : b;
}

// A tile larger than a batch is rendered in strips of whole blocks.
static void render_tile(struct rb_worker *worker, uint32_t tile)
{
    const struct rb_frame *frame = worker->frame;
    int edge = frame->settings.tile;
    int x0 = (int)tile % frame->tiles_x * edge, y0 = (int)tile / frame->tiles_x * edge;
    int x1 = min_int(x0 + edge, frame->view.width), y1 = min_int(y0 + edge, frame->view.height);
    int strip = (int)worker->queues.batch / edge / RB_BLOCK * RB_BLOCK;
    uint32_t samples = frame->view.aa * frame->view.aa;
    for (uint32_t sample = 0; sample < samples; sample++)
        for (int y = y0; y < y1; y += strip) {
            struct rb_span span = {x0, y, x1, min_int(y + strip, y1), sample};
            render_span(worker, &span);
        }
}

// Hashing would be booked on the stage that follows, and push its data out of the L1 cache.
static void begin_simulation(struct rb_worker *worker)
{
    worker->frame->how.hash_hits = false;
    rb_simulate_begin();
}

static void render_tiles(struct rb_worker *worker)
{
    struct rb_frame *frame = worker->frame;
    rb_counting.cost = frame->how.heat ? worker->queues.cost : NULL;
    rb_counting.chosen = frame->how.heat_of;
    for (;;) {
        uint32_t next = atomic_fetch_add(&frame->next_tile, 1);
        if (next >= frame->how.tile_count)
            break;
        if (frame->how.simulate_from && next == frame->how.simulate_from)
            begin_simulation(worker);
        uint32_t tile = frame->how.tiles ? frame->how.tiles[next] : next;
        uint64_t start = worker->recorder.last;
        render_tile(worker, tile);
        if (frame->how.tile_ticks)
            frame->how.tile_ticks[tile] = worker->recorder.last - start;
        uint32_t done = atomic_fetch_add(&frame->tiles_done, 1) + 1;
        if (frame->how.progress && worker->reports)
            frame->how.progress(frame->how.user, done, frame->how.tile_count);
        rb_worker_lap(worker, RB_STAGE_OTHER, 0, 0);
    }
    rb_counting.cost = NULL;
}

void rb_worker_run(struct rb_worker *worker)
{
    const struct rb_run_options *how = &worker->frame->how;
    fenv_t saved;
    rb_fpenv_enter(&saved);
    rb_worker_begin(worker);
    (how->replay ? rb_worker_replay : render_tiles)(worker);
    rb_worker_end(worker);
    rb_fpenv_leave(&saved);
}
