// One frame in the making: what all workers share, and what each has for itself. Private to
// render/.
#ifndef RB_RENDER_FRAME_H
#define RB_RENDER_FRAME_H

#include "render/counted.h"
#include "render/queues.h"
#include "render/renderer.h"
#include "render/replay.h"
#include "render/settings.h"
#include "render/variants.h"

#include <stdatomic.h>

struct rb_frame {
    const struct rb_kernels *kernels;
    struct rb_world world;
    struct rb_view view;
    struct rb_shading shading;
    struct rb_settings settings;
    struct rb_film film;
    int tiles_x, tiles_y;

    // Of the running render:
    struct rb_run_options how; // its tile_count is that of the frame if there are no `tiles`
    atomic_uint next_tile, tiles_done; // next_tile counts batches in a replay
    int thread_count;                  // that took part
};

struct rb_worker {
    struct rb_frame *frame;
    struct rb_queues queues;
    struct rb_recorder recorder;
    struct rb_count_table counts;
    struct rb_event_counter counter;
    uint64_t hits_hash;  // sum over all rays, so that their order cannot matter
    struct rb_span span; // in the making
    bool reports;        // calls frame->progress
};

// Before the first and after the last stage, in the worker's own thread.
void rb_worker_begin(struct rb_worker *worker);
void rb_worker_end(struct rb_worker *worker);

// Ends a stage: everything since the last one was `stage` at `bounce`.
void rb_worker_lap(struct rb_worker *worker, enum rb_stage stage, int bounce, uint64_t rays);

// What becomes of shadow rays when their queue is full or the lights are done; there is at least
// one. The queue is emptied afterwards.
typedef void rb_flush_fn(struct rb_worker *worker, int bounce, void *user);

// Secondary rays, at the start and from queues.batch on of the queue of the next bounce.
struct rb_children {
    uint32_t reflected, refracted;
};

// The stage `shade` on at most queues.batch rays: their surfaces, and all lights on them.
struct rb_children rb_worker_shade(struct rb_worker *worker, int bounce, const struct rb_rays *rays,
                                   const struct rb_hits *hits, rb_flush_fn *flush, void *user);

// Renders tiles, or replays batches, until none is left; called once by every worker, in its own
// thread.
void rb_worker_run(struct rb_worker *worker);

// The latter: batches of frame->how.replay, round after round.
void rb_worker_replay(struct rb_worker *worker);

#endif
