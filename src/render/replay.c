#include "render/replay.h"

#include "base/fpenv.h"
#include "measure/simulate.h"
#include "render/frame.h"
#include "render/inside.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static bool media_fit(const struct rb_scene *scene, uint64_t media)
{
    for (; media; media >>= 16)
        if ((media & 0xffff) >= scene->media_count)
            return false;
    return true;
}

static bool rays_fit(const struct rb_frame *frame, const struct rb_batch *batch)
{
    const struct rb_scene *scene = frame->world.scene;
    uint32_t pixels = (uint32_t)frame->film.width * (uint32_t)frame->film.height;
    for (uint32_t i = 0; i < batch->rays.count; i++) {
        uint32_t self = batch->rays.self[i], prim = batch->hits.prim[i];
        if (batch->rays.pixel[i] >= pixels || !media_fit(scene, batch->rays.media[i]) ||
            (self != RB_NONE && self >= scene->primitive_count) ||
            (prim != RB_NONE && prim >= scene->primitive_count))
            return false;
    }
    return true;
}

static bool shadows_fit(const struct rb_frame *frame, const struct rb_batch *batch)
{
    uint32_t pixels = (uint32_t)frame->film.width * (uint32_t)frame->film.height;
    for (uint32_t i = 0; i < batch->shadows.count; i++)
        if (batch->shadows.pixel[i] >= pixels || batch->shadows.occluded[i] > 1 ||
            batch->shadows.self[i] >= frame->world.scene->primitive_count)
            return false;
    return true;
}

static bool span_fits(const struct rb_frame *frame, const struct rb_span *span, uint32_t batch)
{
    return span->x0 >= 0 && span->y0 >= 0 && span->x0 < span->x1 && span->y0 < span->y1 &&
           span->x1 <= frame->film.width && span->y1 <= frame->film.height &&
           (int64_t)(span->x1 - span->x0) * (span->y1 - span->y0) <= batch &&
           span->sample < frame->view.aa * frame->view.aa;
}

static bool batch_fits(const struct rb_renderer *renderer, const struct rb_replay *replay,
                       const struct rb_batch *batch)
{
    const struct rb_frame *frame = &renderer->frame;
    uint32_t most = renderer->workers[0].queues.batch;
    int bounces = replay->kernel == RB_STAGE_SHADE ? frame->settings.depth : RB_BOUNCE_MAX;
    if (batch->bounce < 0 || batch->bounce >= bounces || !span_fits(frame, &batch->span, most))
        return false;
    if (batch->kind == RB_BATCH_RAYS)
        return replay->kernel != RB_STAGE_TRACE_SHADOW && batch->rays.count <= most &&
               rays_fit(frame, batch);
    return (replay->kernel == RB_STAGE_TRACE_SHADOW || replay->kernel == RB_STAGE_SHADE) &&
           batch->shadows.count <= RB_SHADOW_BATCHES * most && shadows_fit(frame, batch);
}

enum rb_status rb_replay_check(const struct rb_renderer *renderer, const struct rb_replay *replay,
                               struct rb_error *error)
{
    for (size_t i = 0; i < replay->count; i++)
        if (!batch_fits(renderer, replay, &replay->batches[i]) ||
            (i == 0 && replay->kernel == RB_STAGE_SHADE &&
             replay->batches[i].kind != RB_BATCH_RAYS))
            return rb_error_set(error, RB_INVALID,
                                "batch %zu for %s is not of this scene and these settings", i,
                                rb_stage_names[replay->kernel]);
    return RB_OK;
}

// One call of a kernel in the making.
struct call {
    const struct rb_replay *replay;
    size_t index;       // of the batch
    rb_flush_fn *flush; // gets the shadow rays that shade makes, with the call as `user`
    bool differs;       // from the record
    struct rb_error *error;
};

static const struct rb_batch *batch_of(const struct call *call)
{
    return &call->replay->batches[call->index];
}

static void run_generate(struct rb_worker *worker, struct call *call)
{
    struct rb_rays *rays = &worker->queues.rays[0];
    rays->count = 0;
    worker->frame->kernels->generate(&worker->frame->view, &batch_of(call)->span, rays);
    rb_worker_lap(worker, RB_STAGE_GENERATE, batch_of(call)->bounce, rays->count);
}

static void run_trace(struct rb_worker *worker, struct call *call)
{
    const struct rb_batch *batch = batch_of(call);
    worker->frame->kernels->trace(&worker->frame->world, &batch->rays, &worker->queues.hits);
    rb_worker_lap(worker, RB_STAGE_TRACE, batch->bounce, batch->rays.count);
}

static void run_shade(struct rb_worker *worker, struct call *call)
{
    const struct rb_batch *batch = batch_of(call);
    worker->queues.shadows.count = 0;
    if (batch->kind == RB_BATCH_RAYS)
        rb_worker_shade(worker, batch->bounce, &batch->rays, &batch->hits, call->flush, call);
}

// The recorded shadow rays, with room of the worker's for their answers.
static struct rb_shadows to_answer(struct rb_worker *worker, const struct rb_batch *batch)
{
    struct rb_shadows shadows = batch->shadows;
    shadows.occluded = worker->queues.shadows.occluded;
    return shadows;
}

static void run_trace_shadow(struct rb_worker *worker, struct call *call)
{
    struct rb_shadows shadows = to_answer(worker, batch_of(call));
    worker->frame->kernels->trace_shadow(&worker->frame->world, &shadows);
    rb_worker_lap(worker, RB_STAGE_TRACE_SHADOW, batch_of(call)->bounce, shadows.count);
}

// Compares the first `arrays` arrays of what a kernel gave, `count` elements, with the record.
static void compare(struct call *call, const struct rb_members *got, uint32_t count,
                    const struct rb_members *recorded, uint32_t recorded_count, size_t arrays)
{
    char place[96];
    snprintf(place, sizeof place, "%s at bounce %d, batch %zu",
             rb_stage_names[call->replay->kernel], batch_of(call)->bounce, call->index);
    if (count != recorded_count) {
        call->differs = true;
        rb_error_set(call->error, RB_INVALID, "%s: %" PRIu32 " rays, but %" PRIu32 " in the record",
                     place, count, recorded_count);
    }
    for (size_t a = 0; a < arrays && !call->differs; a++) {
        size_t size = got->member[a].size, i = 0;
        const char *is = rb_member_array(&got->member[a]);
        const char *was = rb_member_array(&recorded->member[a]);
        while (i < count && memcmp(is + i * size, was + i * size, size) == 0)
            i++;
        if (i < count) {
            call->differs = true;
            rb_error_set(call->error, RB_INVALID, "%s, ray %zu: %s is not as recorded", place, i,
                         got->member[a].name);
        }
    }
}

static void compare_generate(struct rb_worker *worker, struct call *call)
{
    struct rb_rays is = worker->queues.rays[0], was = batch_of(call)->rays;
    struct rb_members got = rb_rays_members(&is), recorded = rb_rays_members(&was);
    compare(call, &got, is.count, &recorded, was.count, got.count);
}

static void compare_trace(struct rb_worker *worker, struct call *call)
{
    struct rb_hits is = worker->queues.hits, was = batch_of(call)->hits;
    struct rb_members got = rb_hits_members(&is), recorded = rb_hits_members(&was);
    uint32_t count = batch_of(call)->rays.count;
    compare(call, &got, count, &recorded, count, got.count);
}

// The shadow rays of rays are compared as they are flushed, which moves on in the record; there
// must be no more of them then.
static void compare_shade(struct rb_worker *worker, struct call *call)
{
    (void)worker;
    size_t next = call->index + 1;
    if (!call->differs && next < call->replay->count &&
        call->replay->batches[next].kind == RB_BATCH_SHADOWS) {
        call->index = next;
        compare(call, NULL, 0, NULL, batch_of(call)->shadows.count, 0);
    }
}

// The last array, the answers, is not known yet.
static void compare_flushed(struct rb_worker *worker, int bounce, void *user)
{
    struct call *call = user;
    size_t next = call->index + 1;
    struct rb_shadows is = worker->queues.shadows, was = {.count = 0};
    (void)bounce;
    if (call->differs)
        return;
    if (next < call->replay->count && call->replay->batches[next].kind == RB_BATCH_SHADOWS) {
        call->index = next;
        was = batch_of(call)->shadows;
    }
    struct rb_members got = rb_shadows_members(&is), recorded = rb_shadows_members(&was);
    compare(call, &got, is.count, &recorded, was.count, got.count - 1);
}

static void compare_trace_shadow(struct rb_worker *worker, struct call *call)
{
    struct rb_shadows is = to_answer(worker, batch_of(call)), was = batch_of(call)->shadows;
    struct rb_members got = rb_shadows_members(&is), recorded = rb_shadows_members(&was);
    compare(call, &got, is.count, &recorded, was.count, got.count);
}

static const struct {
    void (*run)(struct rb_worker *worker, struct call *call);
    void (*compare)(struct rb_worker *worker, struct call *call);
} kernels[RB_KERNEL_COUNT] = {
    [RB_STAGE_GENERATE] = {run_generate, compare_generate},
    [RB_STAGE_TRACE] = {run_trace, compare_trace},
    [RB_STAGE_SHADE] = {run_shade, compare_shade},
    [RB_STAGE_TRACE_SHADOW] = {run_trace_shadow, compare_trace_shadow},
};

static void run_call(struct rb_worker *worker, struct call *call)
{
    worker->span = batch_of(call)->span;
    rb_worker_lap(worker, RB_STAGE_OTHER, batch_of(call)->bounce, 0);
    kernels[call->replay->kernel].run(worker, call);
}

static void drop_shadows(struct rb_worker *worker, int bounce, void *user)
{
    (void)worker, (void)bounce, (void)user;
}

void rb_worker_replay(struct rb_worker *worker)
{
    struct rb_frame *frame = worker->frame;
    struct call call = {.replay = frame->how.replay, .flush = drop_shadows};
    size_t count = call.replay->count;
    for (;;) {
        size_t next = atomic_fetch_add(&frame->next_tile, 1);
        if (next >= count * call.replay->rounds)
            break;
        if (next && next == count * frame->how.simulate_from)
            rb_simulate_begin();
        call.index = next % count;
        run_call(worker, &call);
    }
    // One kernel at one bounce is all there was: reading them once is enough, and costs nothing.
    if (frame->how.events && count)
        rb_events_lap(&worker->counter, call.replay->kernel, call.replay->batches[0].bounce);
}

size_t rb_replay_group_end(const struct rb_replay *replay, size_t first)
{
    size_t end = first + 1;
    while (replay->kernel == RB_STAGE_SHADE && end < replay->count &&
           replay->batches[end].kind == RB_BATCH_SHADOWS)
        end++;
    return end;
}

enum rb_status rb_replay_verify(struct rb_renderer *renderer, const struct rb_replay *replay,
                                size_t first, size_t end, struct rb_error *error)
{
    struct rb_worker *worker = &renderer->workers[0];
    struct call call = {.replay = replay, .index = first, .flush = compare_flushed, .error = error};
    fenv_t saved;
    rb_fpenv_enter(&saved);
    for (; call.index < end && !call.differs; call.index++) {
        run_call(worker, &call);
        kernels[replay->kernel].compare(worker, &call);
    }
    rb_fpenv_leave(&saved);
    return call.differs ? RB_INVALID : RB_OK;
}

static bool alike(float is, float was)
{
    return isinf(is) || isinf(was) ? is == was : fabsf(is - was) <= RB_REPLAY_TOLERANCE * was;
}

static uint64_t count_differing(const struct rb_worker *worker, const struct rb_replay *replay,
                                const struct rb_batch *batch)
{
    uint64_t differ = 0;
    if (replay->kernel == RB_STAGE_TRACE)
        for (uint32_t i = 0; i < batch->rays.count; i++)
            differ += !alike(worker->queues.hits.t[i], batch->hits.t[i]);
    if (replay->kernel == RB_STAGE_TRACE_SHADOW)
        for (uint32_t i = 0; i < batch->shadows.count; i++)
            differ += worker->queues.shadows.occluded[i] != batch->shadows.occluded[i];
    return differ;
}

void rb_replay_difference(struct rb_renderer *renderer, const struct rb_replay *replay,
                          size_t first, size_t end, struct rb_replay_difference *difference)
{
    struct rb_worker *worker = &renderer->workers[0];
    struct call call = {.replay = replay, .index = first, .flush = drop_shadows};
    fenv_t saved;
    rb_fpenv_enter(&saved);
    for (; call.index < end; call.index++) {
        run_call(worker, &call);
        difference->rays += rb_batch_count(batch_of(&call));
        difference->differ += count_differing(worker, replay, batch_of(&call));
    }
    rb_fpenv_leave(&saved);
}

void rb_renderer_trace(const struct rb_renderer *renderer, const struct rb_rays *rays,
                       struct rb_hits *hits)
{
    renderer->frame.kernels->trace(&renderer->frame.world, rays, hits);
}

void rb_renderer_trace_shadow(const struct rb_renderer *renderer, struct rb_shadows *shadows)
{
    renderer->frame.kernels->trace_shadow(&renderer->frame.world, shadows);
}
