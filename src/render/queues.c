#include "render/queues.h"

#include "base/memory.h"

#include <string.h>

#define MEMBER(queue, field)                                                                       \
    {                                                                                              \
#field, &(queue)->field, sizeof *(queue)->field                                            \
    }

// Arrays of a power of two in size would all begin in the same set of the first-level cache, and a
// kernel streams through more of them than a set has ways. Each one is moved on by this many lines.
enum { STAGGER_LINES = 5 };

static struct rb_members copy_members(const struct rb_member *members, size_t count)
{
    struct rb_members copy = {.count = count};
    memcpy(copy.member, members, count * sizeof *members);
    return copy;
}

struct rb_members rb_rays_members(struct rb_rays *r)
{
    const struct rb_member members[] = {
        MEMBER(r, ox),   MEMBER(r, oy),   MEMBER(r, oz),     MEMBER(r, dx),
        MEMBER(r, dy),   MEMBER(r, dz),   MEMBER(r, weight), MEMBER(r, pixel),
        MEMBER(r, path), MEMBER(r, self), MEMBER(r, media),
    };
    return copy_members(members, sizeof members / sizeof *members);
}

struct rb_members rb_hits_members(struct rb_hits *h)
{
    const struct rb_member members[] = {MEMBER(h, t), MEMBER(h, u), MEMBER(h, v), MEMBER(h, prim)};
    return copy_members(members, sizeof members / sizeof *members);
}

static struct rb_members surfaces_members(struct rb_surfaces *s)
{
    const struct rb_member members[] = {
        MEMBER(s, px),   MEMBER(s, py),   MEMBER(s, pz),       MEMBER(s, nx),    MEMBER(s, ny),
        MEMBER(s, nz),   MEMBER(s, vx),   MEMBER(s, vy),       MEMBER(s, vz),    MEMBER(s, weight),
        MEMBER(s, path), MEMBER(s, prim), MEMBER(s, material), MEMBER(s, pixel), MEMBER(s, inside),
    };
    return copy_members(members, sizeof members / sizeof *members);
}

struct rb_members rb_shadows_members(struct rb_shadows *s)
{
    const struct rb_member members[] = {
        MEMBER(s, ox),    MEMBER(s, oy),   MEMBER(s, oz),       MEMBER(s, dx), MEMBER(s, dy),
        MEMBER(s, dz),    MEMBER(s, r),    MEMBER(s, g),        MEMBER(s, b),  MEMBER(s, distance),
        MEMBER(s, pixel), MEMBER(s, self), MEMBER(s, occluded),
    };
    return copy_members(members, sizeof members / sizeof *members);
}

size_t rb_members_place(const struct rb_members *members, char *memory, uint32_t capacity)
{
    size_t used = 0;
    for (size_t i = 0; i < members->count; i++) {
        char *array = memory ? memory + used : NULL;
        // All object pointers look alike here.
        memcpy(members->member[i].pointer, &array, sizeof array);
        size_t bytes = (size_t)capacity * members->member[i].size;
        used += ((bytes + RB_CACHE_LINE - 1) / RB_CACHE_LINE + STAGGER_LINES) * RB_CACHE_LINE;
    }
    return used;
}

char *rb_member_array(const struct rb_member *member)
{
    char *array;
    memcpy(&array, member->pointer, sizeof array);
    return array;
}

static size_t place_all(char *memory, struct rb_queues *queues, int depth)
{
    uint32_t batch = queues->batch;
    struct rb_members members[RB_DEPTH_MAX + 4];
    uint32_t capacities[RB_DEPTH_MAX + 4];
    int count = 0;
    for (int d = 0; d < depth; d++) {
        members[count] = rb_rays_members(&queues->rays[d]);
        capacities[count++] = queues->rays[d].capacity = 2 * batch;
    }
    members[count] = rb_hits_members(&queues->hits);
    capacities[count++] = batch;
    members[count] = surfaces_members(&queues->surfaces);
    capacities[count++] = queues->surfaces.capacity = batch;
    members[count] = rb_shadows_members(&queues->shadows);
    capacities[count++] = queues->shadows.capacity = RB_SHADOW_BATCHES * batch;
    members[count] = (struct rb_members){.member = {MEMBER(queues, cost)}, .count = 1};
    capacities[count++] = RB_SHADOW_BATCHES * batch;
    size_t used = 0;
    for (int i = 0; i < count; i++)
        used += rb_members_place(&members[i], memory ? memory + used : NULL, capacities[i]);
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
