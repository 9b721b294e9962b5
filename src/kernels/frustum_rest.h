// Packets whose rays differ too much for a bundle. They wait for each other and go on as a stream
// (stream.c), the better the more they are.
#ifndef RB_KERNELS_FRUSTUM_REST_H
#define RB_KERNELS_FRUSTUM_REST_H

#include "kernels/packet_trace.h"

enum { REST_MAX = 4096 };

struct rest {
    uint32_t count; // of rays, in whole packets
    uint32_t total; // of rays so far, those that went on already included
    float o[3][REST_MAX], d[3][REST_MAX], distance[REST_MAX];
    uint32_t self[REST_MAX];
    uint32_t place[REST_MAX]; // in the queue they come from
    float t[REST_MAX], u[REST_MAX], v[REST_MAX];
    uint32_t prim[REST_MAX];
    uint8_t occluded[REST_MAX];
};

// `place` is that of the first ray; those that are not wanted get no valid direction.
static inline void rest_add(struct rest *rest, const struct packet *packet, vint wanted,
                            vfloat distance, uint32_t place)
{
    uint32_t i = rest->count;
    vf_store(rest->o[0] + i, packet->o.x), vf_store(rest->o[1] + i, packet->o.y);
    vf_store(rest->o[2] + i, packet->o.z);
    vf_store(rest->d[0] + i, vf_select(wanted, packet->d.x, vf_set(NAN)));
    vf_store(rest->d[1] + i, packet->d.y), vf_store(rest->d[2] + i, packet->d.z);
    vf_store(rest->distance + i, distance);
    vi_store(rest->self + i, packet->self);
    vi_store(rest->place + i, vi_set(place) + vi_lanes());
    rest->count += RB_LANES;
    rest->total += RB_LANES;
}

// Of so many first rays of a queue? Then most of the others would be, too.
static inline bool rest_is_most(const struct rest *rest, uint32_t rays)
{
    return 2 * rest->total > rays;
}

// Traces what is there, and puts the answers where they belong.
static void rest_trace(struct rest *rest, const struct rb_kernels *by, const struct rb_world *world,
                       struct rb_hits *hits)
{
    struct rb_rays rays = {
        .ox = rest->o[0],
        .oy = rest->o[1],
        .oz = rest->o[2],
        .dx = rest->d[0],
        .dy = rest->d[1],
        .dz = rest->d[2],
        .self = rest->self,
        .count = rest->count,
        .capacity = REST_MAX,
    };
    struct rb_hits answers = {rest->t, rest->u, rest->v, rest->prim};
    RB_COUNT_PLACES(rest->place);
    by->trace(world, &rays, &answers);
    RB_COUNT_PLACES(NULL);
    for (uint32_t i = 0; i < rest->count; i += RB_LANES) {
        struct hits some = hits_load(&answers, i);
        hits_store(hits, rest->place[i], &some);
    }
    rest->count = 0;
}

static void rest_trace_shadow(struct rest *rest, const struct rb_kernels *by,
                              const struct rb_world *world, struct rb_shadows *shadows)
{
    struct rb_shadows some = {
        .ox = rest->o[0],
        .oy = rest->o[1],
        .oz = rest->o[2],
        .dx = rest->d[0],
        .dy = rest->d[1],
        .dz = rest->d[2],
        .distance = rest->distance,
        .self = rest->self,
        .occluded = rest->occluded,
        .count = rest->count,
        .capacity = REST_MAX,
    };
    RB_COUNT_PLACES(rest->place);
    by->trace_shadow(world, &some);
    RB_COUNT_PLACES(NULL);
    for (uint32_t i = 0; i < rest->count; i += RB_LANES)
        memcpy(shadows->occluded + rest->place[i], rest->occluded + i, RB_LANES);
    rest->count = 0;
}

// The rays of a queue from `first` on.
static void trace_from(uint32_t first, const struct rb_kernels *by, const struct rb_world *world,
                       const struct rb_rays *rays, struct rb_hits *hits)
{
    struct rb_rays left = {
        .ox = rays->ox + first,
        .oy = rays->oy + first,
        .oz = rays->oz + first,
        .dx = rays->dx + first,
        .dy = rays->dy + first,
        .dz = rays->dz + first,
        .self = rays->self + first,
        .count = rays->count - first,
        .capacity = rays->capacity - first,
    };
    struct rb_hits found = {hits->t + first, hits->u + first, hits->v + first, hits->prim + first};
    RB_COUNT_BASE(first);
    by->trace(world, &left, &found);
    RB_COUNT_BASE(0);
}

static void trace_shadow_from(uint32_t first, const struct rb_kernels *by,
                              const struct rb_world *world, struct rb_shadows *shadows)
{
    struct rb_shadows left = {
        .ox = shadows->ox + first,
        .oy = shadows->oy + first,
        .oz = shadows->oz + first,
        .dx = shadows->dx + first,
        .dy = shadows->dy + first,
        .dz = shadows->dz + first,
        .distance = shadows->distance + first,
        .self = shadows->self + first,
        .occluded = shadows->occluded + first,
        .count = shadows->count - first,
        .capacity = shadows->capacity - first,
    };
    RB_COUNT_BASE(first);
    by->trace_shadow(world, &left);
    RB_COUNT_BASE(0);
}

#endif
