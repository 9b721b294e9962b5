// What one call of a kernel got and what came of it, apart from any renderer. Batches may be shared
// by threads as long as nobody writes.
#ifndef RB_RENDER_BATCH_H
#define RB_RENDER_BATCH_H

#include "base/status.h"
#include "kernels/kernel.h"

enum rb_batch_kind { RB_BATCH_RAYS, RB_BATCH_SHADOWS, RB_BATCH_KIND_COUNT };

// Rays with their hits, or shadow rays with their answers.
struct rb_batch {
    enum rb_batch_kind kind;
    int bounce;
    struct rb_span span; // part of the image they serve
    struct rb_rays rays;
    struct rb_hits hits;
    struct rb_shadows shadows;
    void *memory; // of the arrays
};

// Room for `count` rays, which the batch then claims to have, all zero; padded as kernels want it.
// Release with rb_batch_free.
enum rb_status rb_batch_alloc(struct rb_batch *batch, enum rb_batch_kind kind, uint32_t count,
                              struct rb_error *error);
void rb_batch_free(struct rb_batch *batch);
uint32_t rb_batch_count(const struct rb_batch *batch);

#endif
