// The rays of a stream: a piece of a queue, loaded with what every visit of a node needs of them,
// and with what the tree is not needed for met already: planes, which have no boxes, and the sphere
// that a ray starts on.
#ifndef RB_KERNELS_STREAM_RAYS_H
#define RB_KERNELS_STREAM_RAYS_H

#include "kernels/quads.h"
#include "kernels/wide_ray.h"

enum {
    STREAM_MAX = 4096,      // rays at a time
    POOL = 16 * STREAM_MAX, // entries of lists; where they run out rays go on alone
    OCTANTS = 8,
    GROUP = 16, // neighbours in a queue, one entry of a list while they go the same ways
};

// What boxes need of a ray, half a cache line. It ends at t: at what it has found, or before
// everything if it is occluded.
struct stream_ray {
    float o[3], inv[3], t;
    uint32_t self;
};
enum { RAY_FLOATS = sizeof(struct stream_ray) / sizeof(float) };

#define OCCLUDED (-1.0f)

// Least and largest of what the rays of a group have. low.self is the primitive that all of them
// start on, or RB_NONE.
struct beam {
    struct stream_ray low, high;
};

// A node or leaf that is still to be visited. Its list in the pool begins with groups; rays that
// are on their own follow.
struct visit {
    rb_wide_child child;
    uint32_t list, groups, count;
};

// Pairs of a ray and a sphere that it may hit, a pair in every lane.
struct pairs {
    uint32_t count, ray[RB_LANES], prim[RB_LANES];
};

struct stream {
    const struct rb_world *world;
    enum rb_sides sides;
    struct rb_hits found;  // results of these rays, the first of them at 0: closest hits, or
    uint8_t *occluded;     // those of shadow rays, else NULL
    uint32_t begin, count; // rays of the queue
    int backward[3];       // of the octant in work
    struct pairs pairs;    // to be met when they are a vector, or the octant is done
    _Alignas(64) struct stream_ray ray[STREAM_MAX];
    float d[STREAM_MAX][4];      // directions, which only primitives need
    uint32_t pool[POOL];         // lists: indices of rays
    uint32_t some[STREAM_MAX];   // of a list
    uint8_t bits[STREAM_MAX];    // children that the rays of a list reach
    uint32_t octant[STREAM_MAX]; // OCTANTS for rays that are not valid
    _Alignas(64) struct beam beam[STREAM_MAX / GROUP];
    bool alike[STREAM_MAX / GROUP];         // groups of one octant
    uint32_t wholes;                        // groups of a list that go the same ways:
    uint32_t whole[STREAM_MAX / GROUP];     // which,
    uint8_t whole_bits[STREAM_MAX / GROUP]; // and the children that they reach
    struct visit stack[RB_WIDE_STACK];
};

static inline struct rb_ray ray_of(const struct stream *stream, uint32_t index)
{
    const struct stream_ray *ray = &stream->ray[index];
    return (struct rb_ray){rb_vec_of(ray->o), rb_vec_of(stream->d[index]), rb_vec_of(ray->inv),
                           ray->self, stream->sides};
}

static inline struct rb_hit best_of(const struct stream *stream, uint32_t index)
{
    const struct rb_hits *found = &stream->found;
    return (struct rb_hit){stream->ray[index].t, found->u[index], found->v[index],
                           found->prim[index]};
}

static inline void keep(struct stream *stream, uint32_t index, const struct rb_hit *hit)
{
    stream->ray[index].t = hit->t;
    rb_hit_store(&stream->found, index, hit);
}

static inline void keep_occluded(struct stream *stream, uint32_t index)
{
    stream->ray[index].t = OCCLUDED;
    stream->occluded[index] = 1;
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
    struct vvec o, d, inv;
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

// A sphere in every lane.
static inline struct wide_spheres spheres_of(const struct rb_scene *scene,
                                             const uint32_t index[RB_LANES])
{
    struct vquads of = vq_load(scene->spheres[0].center, 4, index);
    return (struct wide_spheres){{of.a, of.b, of.c}, of.d, vi_load(index)};
}

// The sphere that rays start on, for those that go into it: it ends their search, and leaves need
// not look for it.
static inline void meet_own(const struct stream *stream, struct lanes *lanes)
{
    const struct rb_scene *scene = stream->world->scene;
    if (scene->count[RB_SPHERE] == 0)
        return;
    vint starts = lanes->valid & ((vuint)lanes->self < scene->count[RB_SPHERE]);
    uint32_t self[RB_LANES];
    vi_store(self, lanes->self & starts);
    struct wide_spheres own = spheres_of(scene, self);
    starts &= vv_dot(vv_sub(own.center, lanes->o), lanes->d) > 0.0f;
    if (!vi_any(starts))
        return;
    RB_COUNT_STEP(vi_bits(starts), RB_LANES);
    RB_COUNT_RAYS(BOXES, vi_bits(starts), 1);
    RB_COUNT_RAYS(SPHERES, vi_bits(starts), 1);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, sizeof *scene->spheres);
    struct wide_ray ray = {
        .o = lanes->o, .d = lanes->d, .inv = lanes->inv, .self = own.prim, .sides = stream->sides};
    struct wide_hits hits = wide_spheres_hit(&own, &ray);
    vint closer = starts & hits.found & (hits.t <= lanes->best_t);
    lanes->best_t = vf_select(closer, hits.t, lanes->best_t);
    lanes->best_prim = vi_select(closer, lanes->self, lanes->best_prim);
}

static inline void load_lanes(const struct source *from, uint32_t i, struct lanes *lanes)
{
    lanes->o = (struct vvec){vf_load(from->ox + i), vf_load(from->oy + i), vf_load(from->oz + i)};
    lanes->d = (struct vvec){vf_load(from->dx + i), vf_load(from->dy + i), vf_load(from->dz + i)};
    lanes->inv =
        (struct vvec){wide_inverse(lanes->d.x), wide_inverse(lanes->d.y), wide_inverse(lanes->d.z)};
    lanes->self = vi_load(from->self + i);
    lanes->best_t = from->distance ? vf_load(from->distance + i) : vf_set(INFINITY);
    lanes->valid = vi_first(from->end - i) & vv_finite(lanes->o) & vv_finite(lanes->d) &
                   (lanes->best_t == lanes->best_t);
    lanes->best_prim = vi_set(RB_NONE);
}

// Writes rays from `index` on.
static inline void store_lanes(struct stream *stream, uint32_t index, const struct lanes *lanes)
{
    struct vvec inv = lanes->inv;
    vint octant = ((inv.x < 0.0f) & 1) | ((inv.y < 0.0f) & 2) | ((inv.z < 0.0f) & 4);
    vi_store(stream->octant + index, vi_select(lanes->valid, octant, vi_set(OCTANTS)));
    float *ray = stream->ray[index].o, *d = stream->d[index];
    vq_store(ray, RAY_FLOATS, (struct vquads){lanes->o.x, lanes->o.y, lanes->o.z, inv.x});
    vq_store(ray + 4, RAY_FLOATS,
             (struct vquads){inv.y, inv.z, lanes->best_t, (vfloat)lanes->self});
    vq_store(d, 4, (struct vquads){lanes->d.x, lanes->d.y, lanes->d.z, vf_set(0.0f)});
}

// What has been found when the traversal begins.
static inline void store_found(struct stream *stream, uint32_t index, const struct lanes *lanes)
{
    vint found = lanes->best_prim != vi_set(RB_NONE);
    if (stream->occluded) {
        for (int lane = 0; lane < RB_LANES; lane++)
            stream->occluded[index + (uint32_t)lane] = found[lane] != 0;
        return;
    }
    vf_store(stream->found.t + index, lanes->best_t);
    vf_store(stream->found.u + index, vf_set(0.0f));
    vf_store(stream->found.v + index, vf_set(0.0f));
    vi_store(stream->found.prim + index, lanes->best_prim);
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
                vf_select(lanes.best_prim == vi_set(RB_NONE), lanes.best_t, vf_set(OCCLUDED));
        if (stream->sides == RB_SIDES_VISIBLE)
            meet_own(stream, &lanes);
        store_lanes(stream, i, &lanes);
        store_found(stream, i, &lanes);
    }
    for (uint32_t i = stream->count; i % GROUP; i++)
        stream->octant[i] = OCTANTS;
}

#endif
