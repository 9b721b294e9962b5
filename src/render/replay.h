// Kernels alone: one kernel run on batches that were recorded, as often as one likes, with the laps
// of the pipeline around each call and nothing else in between (rb_run_options.replay).
// Batches are read where they lie; what comes out goes to the queues of the renderer.
#ifndef RB_RENDER_REPLAY_H
#define RB_RENDER_REPLAY_H

#include "measure/probe.h"
#include "render/batch.h"

struct rb_renderer;

// Work for one kernel: generate and trace take batches of rays, trace_shadow batches of shadow
// rays. shade takes both: after each batch of rays come the shadow rays of its hits, as flushed.
struct rb_replay {
    enum rb_stage kernel; // one of the four
    const struct rb_batch *batches;
    size_t count;
    uint32_t rounds; // how often to go over all of them; together fewer than 2^32 batches
};

// Can the renderer be trusted with these batches? RB_INVALID if they are not of its settings or
// its scene: an index out of range, say. Everything below relies on it.
enum rb_status rb_replay_check(const struct rb_renderer *renderer, const struct rb_replay *replay,
                               struct rb_error *error);

// Runs the kernel once over the batches [first, end) and compares what it gives with what was
// recorded, bit for bit: rays of generate, hits of trace, shadow rays of shade, answers of
// trace_shadow. RB_INVALID with the first difference. The secondary rays that shade makes are not
// compared.
enum rb_status rb_replay_verify(struct rb_renderer *renderer, const struct rb_replay *replay,
                                size_t first, size_t end, struct rb_error *error);

// For rows that are not exact, instead: how many of the rays of trace or trace_shadow are answered
// otherwise than recorded. Hits are alike if both miss, or both hit at distances that differ by no
// more than RB_REPLAY_TOLERANCE of the distance, whatever primitive: where two overlap or touch,
// rounding decides. Other kernels have nothing to compare.
#define RB_REPLAY_TOLERANCE 1e-3f
struct rb_replay_difference {
    uint64_t rays, differ;
};
void rb_replay_difference(struct rb_renderer *renderer, const struct rb_replay *replay,
                          size_t first, size_t end, struct rb_replay_difference *difference);

// The end of what belongs to batch `first`: for shade, its shadow rays come after it.
size_t rb_replay_group_end(const struct rb_replay *replay, size_t first);

// The two kernels that answer rays, on arrays of the caller's.
void rb_renderer_trace(const struct rb_renderer *renderer, const struct rb_rays *rays,
                       struct rb_hits *hits);
void rb_renderer_trace_shadow(const struct rb_renderer *renderer, struct rb_shadows *shadows);

#endif
