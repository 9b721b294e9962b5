// A renderer: one scene, one row of the table, one set of settings, all memory taken in advance.
//
//     rb_renderer_create(&scene, variant, &settings, &renderer, &error);
//     rb_renderer_run(renderer, NULL, &result);
//     rb_renderer_pixels(renderer, pixels);
//     rb_renderer_free(renderer);
//
// The same scene, settings and row give the same pixels and hits bit for bit, whatever the tile
// size, the number of threads, the compiler and the row (if it is exact). A renderer is used by one
// thread at a time; the scene must outlive it and may be shared.
#ifndef RB_RENDER_RENDERER_H
#define RB_RENDER_RENDERER_H

#include "base/vec.h"
#include "measure/events.h"
#include "render/counted.h"
#include "render/replay.h"
#include "render/settings.h"
#include "render/variants.h"

struct rb_renderer;

// Builds the accelerator and takes the memory. RB_INVALID for settings out of range or a row that
// is not available here; RB_FAILED without memory.
enum rb_status rb_renderer_create(const struct rb_scene *scene, const struct rb_variant *variant,
                                  const struct rb_settings *settings, struct rb_renderer **renderer,
                                  struct rb_error *error);
void rb_renderer_free(struct rb_renderer *renderer); // accepts NULL

// Goes on with the kernels of another serial row that traces through the very same tree; false,
// and nothing has changed, if `row` needs another one.
bool rb_renderer_take_row(struct rb_renderer *renderer, const struct rb_variant *row);

// Sees the batches of a frame as the kernels get and leave them, in the order in which they come:
// a batch of rays, the shadow rays of its hits, then its children, which are batches of the next
// bounce. `span` is the part of the image that they serve. Called by the worker that has made them,
// so rows with threads call from several at once. What it sees is gone when it returns.
struct rb_observer {
    void *user;
    void (*traced)(void *user, const struct rb_span *span, int bounce, const struct rb_rays *rays,
                   const struct rb_hits *hits);
    void (*shadowed)(void *user, const struct rb_span *span, int bounce,
                     const struct rb_shadows *shadows);
};

struct rb_run_options {
    const uint32_t *tiles; // indices of the tiles to render; NULL for the whole frame
    uint32_t tile_count;
    bool hash_hits;                     // costs time
    const struct rb_observer *observer; // may be NULL; its time is not the frame's
    // Not NULL: instead of tiles run one kernel on recorded batches, which the renderer has checked
    // (replay.h), which the threads of the row share. Pixels and image hash then mean nothing.
    const struct rb_replay *replay;
    // Not NULL: the twins of the row's kernels run, and what they count is added here. Times are
    // meaningless then. The row must have twins (rb_variant.counted).
    struct rb_count_table *counts;
    // With `counts`: not NULL and zeroed by the caller, one element per pixel: what the counters of
    // `heat_of` (bit c: counter c) count is added to the pixel whose ray it was for.
    uint64_t *heat;
    uint32_t heat_of;
    uint64_t *tile_ticks; // not NULL: the time each tile took, by its index
    // A test's wish: the stage takes this share longer, spinning. 0: no.
    enum rb_stage slow_stage;
    double slow_share;
    // For one worker, with `tiles`: from this index on, stages are laps of measure/simulate.h, and
    // hits are not hashed; 0: none. The tiles before it warm the caches.
    uint32_t simulate_from;
    // Not NULL: the events of the group are counted in every thread, and added here. In a replay,
    // whose batches must be of one bounce then, they are read at its end alone.
    struct rb_event_table *events;
    const struct rb_event_group *event_group;
    // Called by one of the workers after each of its tiles; may be NULL.
    void (*progress)(void *user, uint32_t done, uint32_t total);
    void *user;
};

struct rb_run_result {
    uint64_t wall_ns;
    int thread_count;            // that took part
    struct rb_recorder recorder; // sum over the threads
    uint64_t busy_max_ticks;     // of the thread that was busy longest
    uint64_t hits_hash;          // of (sample, pixel, path, primitive, t, u, v) of every ray
    uint64_t image_hash;         // of the linear pixels of the tiles rendered
};

// Renders into the renderer's own film, which starts black. `options` may be NULL. Cannot fail.
void rb_renderer_run(struct rb_renderer *renderer, const struct rb_run_options *options,
                     struct rb_run_result *result);

// Linear pixels, rows from the top, RGB; `pixels` has room for 3 * width * height.
void rb_renderer_pixels(const struct rb_renderer *renderer, float *pixels);

// The settings with all defaults filled in.
const struct rb_settings *rb_renderer_settings(const struct rb_renderer *renderer);
uint32_t rb_renderer_tile_count(const struct rb_renderer *renderer);
uint64_t rb_renderer_build_ns(const struct rb_renderer *renderer);
size_t rb_renderer_tree_bytes(const struct rb_renderer *renderer); // 0 without an accelerator

// One pixel, step by step, through the kernels of the row, as an observer wants to see it.
struct rb_pixel_ray {
    int bounce;
    uint32_t sample, path; // path 1 is the camera ray; 2p reflects, 2p + 1 refracts p
    struct rb_vec o, d, n; // n: shading normal, turned towards the ray
    float weight, t, u, v;
    uint32_t prim, material; // prim RB_NONE: a miss, and the background is its colour
    bool total_reflection;   // transparent and above the depth limit, but nothing is transmitted
};
struct rb_pixel_shadow {
    uint32_t light, sample;
    bool faces, occluded;
    float color[3]; // added to the pixel unless occluded
};
struct rb_pixel_observer {
    void *user;
    // Each ray in depth-first order, followed by one call per light sample.
    void (*ray)(void *user, const struct rb_pixel_ray *ray);
    void (*shadow)(void *user, const struct rb_pixel_ray *ray,
                   const struct rb_pixel_shadow *shadow);
    // Then what the ray itself adds to its sample of the pixel: its weight times background or
    // local colour.
    void (*local)(void *user, const struct rb_pixel_ray *ray, const float added[3]);
};

// `color` gets the linear colour of the pixel, equal to that of a whole frame. The film is cleared.
void rb_renderer_pixel(struct rb_renderer *renderer, int x, int y,
                       const struct rb_pixel_observer *observer, float color[3]);

#endif
