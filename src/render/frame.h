// One frame in the making: what all workers share, and what each has for itself. Private to
// render/.
#ifndef RB_RENDER_FRAME_H
#define RB_RENDER_FRAME_H

#include "render/counted.h"
#include "render/queues.h"
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
    const uint32_t *tiles; // indices of the tiles to render, or NULL for all
    uint32_t tile_count;
    bool hash_hits;
    enum rb_stage slow_stage;
    double slow_share;
    uint32_t simulate_from; // index into `tiles`; 0: never
    bool count;
    uint32_t heat_of;
    uint64_t *heat, *tile_ticks;
    void (*progress)(void *user, uint32_t done, uint32_t total);
    void *user;
    atomic_uint next_tile, tiles_done;
    int thread_count; // that took part
};

struct rb_worker {
    struct rb_frame *frame;
    struct rb_queues queues;
    struct rb_recorder recorder;
    struct rb_count_table counts;
    uint64_t hits_hash; // sum over all rays, so that their order cannot matter
    uint32_t sample;    // AA sample in the making
    bool reports;       // calls frame->progress
};

// Renders tiles until none is left; called once by every worker, in its own thread.
void rb_worker_run(struct rb_worker *worker);

#endif
