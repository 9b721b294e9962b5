// Packets whose rays differ too much for a bundle. They wait for each other and go on as a stream
// (stream.c), the better the more they are.
#ifndef RB_KERNELS_FRUSTUM_REST_H
#define RB_KERNELS_FRUSTUM_REST_H

#include "kernels/packet_trace.h"

enum { REST_MAX = 4096 };

struct rest {
    uint32_t count; // of rays, in whole packets
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

#endif
