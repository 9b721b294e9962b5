#include "render/queues.h"

#include "base/memory.h"

#include <string.h>

// Shadow rays wait until this many batches of them are together or the lights are done.
enum { SHADOW_BATCHES = 2 };

// One member array of a queue: where its pointer is stored and the size of an element.
struct member {
    void *pointer;
    size_t size;
};

#define MEMBER(field)                                                                              \
    {                                                                                              \
        &(field), sizeof *(field)                                                                  \
    }

// Arrays of a power of two in size would all begin in the same set of the first-level cache, and a
// kernel streams through more of them than a set has ways. Each one is moved on by this many lines.
enum { STAGGER_LINES = 5 };

// Gives every member room for `count` elements from `memory` on; returns the bytes taken. With
// memory NULL it only counts.
static size_t place(char *memory, const struct member *members, size_t member_count, uint32_t count)
{
    size_t used = 0;
    for (size_t i = 0; i < member_count; i++) {
        char *array = memory ? memory + used : NULL;
        memcpy(members[i].pointer, &array, sizeof array); // all object pointers look alike here
        size_t bytes = (size_t)count * members[i].size;
        used += ((bytes + RB_CACHE_LINE - 1) / RB_CACHE_LINE + STAGGER_LINES) * RB_CACHE_LINE;
    }
    return used;
}

static size_t place_rays(char *memory, struct rb_rays *r, uint32_t capacity)
{
    const struct member members[] = {
        MEMBER(r->ox),   MEMBER(r->oy),   MEMBER(r->oz),     MEMBER(r->dx),
        MEMBER(r->dy),   MEMBER(r->dz),   MEMBER(r->weight), MEMBER(r->pixel),
        MEMBER(r->path), MEMBER(r->self), MEMBER(r->media),
    };
    r->capacity = capacity;
    return place(memory, members, sizeof members / sizeof *members, capacity);
}

static size_t place_hits(char *memory, struct rb_hits *h, uint32_t capacity)
{
    const struct member members[] = {MEMBER(h->t), MEMBER(h->u), MEMBER(h->v), MEMBER(h->prim)};
    return place(memory, members, sizeof members / sizeof *members, capacity);
}

static size_t place_surfaces(char *memory, struct rb_surfaces *s, uint32_t capacity)
{
    const struct member members[] = {
        MEMBER(s->px),   MEMBER(s->py),   MEMBER(s->pz),       MEMBER(s->nx),    MEMBER(s->ny),
        MEMBER(s->nz),   MEMBER(s->vx),   MEMBER(s->vy),       MEMBER(s->vz),    MEMBER(s->weight),
        MEMBER(s->path), MEMBER(s->prim), MEMBER(s->material), MEMBER(s->pixel), MEMBER(s->inside),
    };
    s->capacity = capacity;
    return place(memory, members, sizeof members / sizeof *members, capacity);
}

static size_t place_shadows(char *memory, struct rb_shadows *s, uint32_t capacity)
{
    const struct member members[] = {
        MEMBER(s->ox),    MEMBER(s->oy),   MEMBER(s->oz),       MEMBER(s->dx), MEMBER(s->dy),
        MEMBER(s->dz),    MEMBER(s->r),    MEMBER(s->g),        MEMBER(s->b),  MEMBER(s->distance),
        MEMBER(s->pixel), MEMBER(s->self), MEMBER(s->occluded),
    };
    s->capacity = capacity;
    return place(memory, members, sizeof members / sizeof *members, capacity);
}

static size_t place_all(char *memory, struct rb_queues *queues, int depth)
{
    uint32_t batch = queues->batch;
    size_t used = 0;
    for (int d = 0; d < depth; d++)
        used += place_rays(memory ? memory + used : NULL, &queues->rays[d], 2 * batch);
    used += place_hits(memory ? memory + used : NULL, &queues->hits, batch);
    used += place_surfaces(memory ? memory + used : NULL, &queues->surfaces, batch);
    used += place_shadows(memory ? memory + used : NULL, &queues->shadows, SHADOW_BATCHES * batch);
    const struct member cost[] = {MEMBER(queues->cost)};
    used += place(memory ? memory + used : NULL, cost, 1, SHADOW_BATCHES * batch);
    return used;
}

enum rb_status rb_queues_alloc(struct rb_queues *queues, uint32_t batch, int depth,
                               struct rb_error *error)
{
    *queues = (struct rb_queues){0};
    queues->batch = (batch + RB_LANES_MAX - 1) / RB_LANES_MAX * RB_LANES_MAX;
    queues->bytes = place_all(NULL, queues, depth);
    queues->memory = rb_alloc(queues->bytes, 1);
    if (!queues->memory)
        return rb_error_memory(error, "the ray queues");
    place_all(queues->memory, queues, depth);
    return RB_OK;
}

void rb_queues_free(struct rb_queues *queues)
{
    rb_free(queues->memory);
    *queues = (struct rb_queues){0};
}

struct rb_rays rb_rays_view(const struct rb_rays *r, uint32_t first, uint32_t count,
                            uint32_t capacity)
{
    return (struct rb_rays){
        r->ox + first,   r->oy + first,   r->oz + first,     r->dx + first,
        r->dy + first,   r->dz + first,   r->weight + first, r->pixel + first,
        r->path + first, r->self + first, r->media + first,  count,
        capacity,
    };
}

void rb_rays_move(struct rb_rays *r, uint32_t to, uint32_t from, uint32_t count)
{
    float *const floats[] = {r->ox, r->oy, r->oz, r->dx, r->dy, r->dz, r->weight};
    uint32_t *const words[] = {r->pixel, r->path, r->self};
    if (to == from || count == 0)
        return;
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++)
        memmove(floats[i] + to, floats[i] + from, count * sizeof **floats);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        memmove(words[i] + to, words[i] + from, count * sizeof **words);
    memmove(r->media + to, r->media + from, count * sizeof *r->media);
}
