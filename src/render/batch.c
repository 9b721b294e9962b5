#include "render/batch.h"

#include "base/memory.h"
#include "render/queues.h"

enum rb_status rb_batch_alloc(struct rb_batch *batch, enum rb_batch_kind kind, uint32_t count,
                              struct rb_error *error)
{
    *batch = (struct rb_batch){.kind = kind};
    uint32_t capacity = (count + RB_LANES_MAX - 1) / RB_LANES_MAX * RB_LANES_MAX;
    struct rb_members members[2] = {rb_rays_members(&batch->rays), rb_hits_members(&batch->hits)};
    size_t queues = 2;
    if (kind == RB_BATCH_SHADOWS) {
        members[0] = rb_shadows_members(&batch->shadows);
        queues = 1;
    }
    size_t bytes = 0, used = 0;
    for (size_t i = 0; i < queues; i++)
        bytes += rb_members_place(&members[i], NULL, capacity);
    batch->memory = rb_alloc(bytes, 1);
    if (!batch->memory)
        return rb_error_memory(error, "the rays");
    for (size_t i = 0; i < queues; i++)
        used += rb_members_place(&members[i], (char *)batch->memory + used, capacity);
    if (kind == RB_BATCH_RAYS)
        batch->rays.count = count, batch->rays.capacity = capacity;
    else
        batch->shadows.count = count, batch->shadows.capacity = capacity;
    return RB_OK;
}

void rb_batch_free(struct rb_batch *batch)
{
    rb_free(batch->memory);
    *batch = (struct rb_batch){0};
}

uint32_t rb_batch_count(const struct rb_batch *batch)
{
    return batch->kind == RB_BATCH_RAYS ? batch->rays.count : batch->shadows.count;
}
