// The rays of a stream: a piece of a queue, loaded with what every visit of a node needs of them
// and with the planes, which have no boxes, met already.
#ifndef RB_KERNELS_STREAM_RAYS_H
#define RB_KERNELS_STREAM_RAYS_H

#include "kernels/wide_ray.h"

enum {
    STREAM_MAX = 4096,      // rays at a time
    POOL = 16 * STREAM_MAX, // entries of lists; where they run out rays go on alone
    OCTANTS = 8,
};

// A ray with what it has found, a cache line.
struct stream_ray {
    float o[3], inv[3], d[3];
    uint32_t self;
    struct rb_hit best; // shadow rays: t is where they end, prim RB_NONE unless they are occluded
    uint32_t unused[2];
};

// What a shadow ray has found: nothing is closer.
#define OCCLUDED ((struct rb_hit){.t = -1.0f, .prim = 0})

// A node or leaf that is still to be visited by `count` rays.
struct visit {
    rb_wide_child child;
    uint32_t list, count; // in the pool
};

struct stream {
    const struct rb_world *world;
    enum rb_sides sides;
    uint32_t begin, count; // rays of the queue
    int backward[3];       // of the octant in work
    struct stream_ray ray[STREAM_MAX];
    uint32_t pool[POOL];         // lists: indices of rays
    uint8_t bits[STREAM_MAX];    // children that the rays of a list reach
    uint32_t octant[STREAM_MAX]; // OCTANTS for rays that are not valid
    struct visit stack[RB_WIDE_STACK];
};

static inline struct rb_ray ray_of(const struct stream *stream, uint32_t index)
{
    const struct stream_ray *ray = &stream->ray[index];
    return (struct rb_ray){rb_vec_of(ray->o), rb_vec_of(ray->d), rb_vec_of(ray->inv), ray->self,
                           stream->sides};
}

// Where rays come from: arrays of a queue, and which of its elements.
struct source {
    const float *ox, *oy, *oz, *dx, *dy, *dz;
    const float *distance; // NULL where rays have no end
    const uint32_t *self;
    uint32_t begin, end;
};

// RB_LANES rays, and what they have to beat.
struct lanes {
    struct vvec o, d;
    vint self, valid;
    vfloat best_t;
    vint best_prim;
};

// rb_planes_closest. Their ids ascend, so that the first of equals stays.
static inline void meet_planes(const struct stream *stream, struct lanes *lanes)
{
    const struct rb_scene *scene = stream->world->scene;
    for (uint32_t i = 0; i < scene->count[RB_PLANE]; i++) {
        struct vvec n = vv_set(scene->planes[i].normal);
        vint prim = vi_set(scene->first[RB_PLANE] + i);
        struct rb_ray any = {.sides = stream->sides};
        bool front = rb_sides_of(scene, &any, scene->first[RB_PLANE] + i) == RB_SIDES_FRONT;
        vfloat facing = vv_dot(n, lanes->d);
        vfloat t = (scene->planes[i].distance - vv_dot(n, lanes->o)) / facing;
        vint asked = lanes->valid & (lanes->self != prim);
        vint closer = asked & (t > 0.0f) & (t < INFINITY) & (t < lanes->best_t);
        if (front)
            closer &= ~(facing > 0.0f);
        RB_COUNT_STEP(vi_bits(asked), RB_LANES);
        RB_COUNT_RAYS(PLANES, vi_bits(asked), 1);
        RB_COUNT_BYTES(PRIMITIVE_BYTES, sizeof *scene->planes);
        lanes->best_t = vf_select(closer, t, lanes->best_t);
        lanes->best_prim = vi_select(closer, prim, lanes->best_prim);
    }
}

static inline void load_lanes(const struct source *from, uint32_t i, struct lanes *lanes)
{
    lanes->o = (struct vvec){vf_load(from->ox + i), vf_load(from->oy + i), vf_load(from->oz + i)};
    lanes->d = (struct vvec){vf_load(from->dx + i), vf_load(from->dy + i), vf_load(from->dz + i)};
    lanes->self = vi_load(from->self + i);
    lanes->valid = vi_first(from->end - i) & vv_finite(lanes->o) & vv_finite(lanes->d);
    lanes->best_t = from->distance ? vf_load(from->distance + i) : vf_set(INFINITY);
    lanes->best_prim = vi_set(RB_NONE);
}

// Writes rays from `index` on.
static inline void store_lanes(struct stream *stream, uint32_t index, const struct lanes *lanes)
{
    struct vvec inv = {wide_inverse(lanes->d.x), wide_inverse(lanes->d.y),
                       wide_inverse(lanes->d.z)};
    vint octant = ((inv.x < 0.0f) & 1) | ((inv.y < 0.0f) & 2) | ((inv.z < 0.0f) & 4);
    float o[3][RB_LANES], i[3][RB_LANES], d[3][RB_LANES], t[RB_LANES];
    uint32_t self[RB_LANES], prim[RB_LANES];
    vf_store(o[0], lanes->o.x), vf_store(o[1], lanes->o.y), vf_store(o[2], lanes->o.z);
    vf_store(i[0], inv.x), vf_store(i[1], inv.y), vf_store(i[2], inv.z);
    vf_store(d[0], lanes->d.x), vf_store(d[1], lanes->d.y), vf_store(d[2], lanes->d.z);
    vi_store(self, lanes->self), vf_store(t, lanes->best_t), vi_store(prim, lanes->best_prim);
    vi_store(stream->octant + index, vi_select(lanes->valid, octant, vi_set(OCTANTS)));
    for (int l = 0; l < RB_LANES; l++)
        stream->ray[index + (uint32_t)l] = (struct stream_ray){
            .o = {o[0][l], o[1][l], o[2][l]},
            .inv = {i[0][l], i[1][l], i[2][l]},
            .d = {d[0][l], d[1][l], d[2][l]},
            .self = self[l],
            .best = {t[l], 0.0f, 0.0f, prim[l]},
        };
}

// The next STREAM_MAX rays, or as many as there are.
static void stream_fill(struct stream *stream, const struct source *from)
{
    uint32_t rest = from->end - from->begin;
    stream->begin = from->begin;
    stream->count = rest < STREAM_MAX ? rest : STREAM_MAX;
    for (uint32_t i = 0; i < stream->count; i += RB_LANES) {
        struct lanes lanes;
        load_lanes(from, from->begin + i, &lanes);
        RB_COUNT_BEGIN(from->begin + i);
        meet_planes(stream, &lanes);
        if (from->distance) // a plane in between ends the search
            lanes.best_t =
                vf_select(lanes.best_prim == vi_set(RB_NONE), lanes.best_t, vf_set(OCCLUDED.t));
        store_lanes(stream, i, &lanes);
    }
}

#endif
