// Leaves of a stream, in two steps, since a branch on whether a ray hits is mispredicted half of
// the time: the first finds out which rays of a list may hit something, the second works for those
// alone; on spheres for a vector of pairs of a ray and a sphere, whatever leaf they are from.
#ifndef RB_KERNELS_STREAM_LEAVES_H
#define RB_KERNELS_STREAM_LEAVES_H

#include "kernels/stream_rays.h"
#include "kernels/wide_single.h"

// Leaves of what has no vector form.
static void visit_others(struct stream *stream, const struct visit *visit)
{
    const uint32_t *ids = rb_wide_ids(stream->world->wide, visit->child);
    for (uint32_t i = 0; i < visit->count; i++) {
        uint32_t index = stream->pool[visit->list + i];
        struct rb_ray ray = ray_of(stream, index);
        RB_COUNT_BEGIN(stream->begin + index);
        if (!stream->occluded) {
            struct rb_hit best = best_of(stream, index);
            best = leaf_one_by_one(stream->world, ids, &ray, best);
            keep(stream, index, &best);
        } else if (leaf_one_by_one(stream->world, ids, &ray, RB_MISS).t < stream->ray[index].t) {
            keep_occluded(stream, index);
        }
    }
}

static inline void take(struct stream *stream, uint32_t index, const struct rb_hit *hit)
{
    struct rb_hit best = {.t = stream->ray[index].t};
    if (stream->occluded) {
        if (hit->t < best.t)
            keep_occluded(stream, index);
        return;
    }
    best.prim = stream->found.prim[index];
    if (rb_hit_closer(hit, &best))
        keep(stream, index, hit);
}

RB_INLINE void take_lanes(struct stream *stream, uint32_t index, const struct wide_hits *hits)
{
    if (stream->occluded) {
        if (vi_any(hits->found & (hits->t < stream->ray[index].t)))
            keep_occluded(stream, index);
    } else if (vi_any(hits->found & (hits->t <= stream->ray[index].t))) {
        struct rb_hit best = keep_closest(hits, best_of(stream, index));
        keep(stream, index, &best);
    }
}

RB_INLINE struct wide_ray wide_ray_of(const struct stream *stream, uint32_t index)
{
    const struct stream_ray *ray = &stream->ray[index];
    return (struct wide_ray){.o = vv_set(ray->o),
                             .inv = vv_set(ray->inv),
                             .d = vv_set(stream->d[index]),
                             .self = vi_set(ray->self),
                             .sides = stream->sides};
}

// All pairs there are, at once.
static void meet_pairs(struct stream *stream)
{
    struct pairs *pairs = &stream->pairs;
    struct wide_spheres spheres = spheres_of(stream->world->scene, pairs->prim);
    const float *rays = stream->ray[0].o;
    struct vquads first = vq_load(rays, RAY_FLOATS, pairs->ray);
    struct vquads second = vq_load(rays + 4, RAY_FLOATS, pairs->ray);
    struct vquads d = vq_load(stream->d[0], 4, pairs->ray);
    struct wide_ray ray = {.o = {first.a, first.b, first.c},
                           .d = {d.a, d.b, d.c},
                           .inv = {first.d, second.a, second.b},
                           .self = (vint)second.d,
                           .sides = stream->sides};
    struct wide_hits hits = wide_spheres_hit(&spheres, &ray);
    float t[RB_LANES];
    vf_store(t, hits.t);
    unsigned bits = vi_bits(hits.found & (hits.t <= second.c) & vi_first(pairs->count));
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        struct rb_hit hit = {t[lane], 0.0f, 0.0f, pairs->prim[lane]};
        take(stream, pairs->ray[lane], &hit);
    }
    pairs->count = 0;
}

// The rays of a visit against part of a block, which stays in registers. Those that may hit
// something are put aside without a branch, and are few. They become pairs.
static void visit_spheres(struct stream *stream, const struct visit *visit)
{
    const struct rb_wide_spheres *block =
        &stream->world->wide->spheres[rb_wide_index_of(visit->child)];
    struct pairs *pairs = &stream->pairs;
    for (int lane = 0; lane < RB_WIDE; lane += RB_LANES) {
        struct wide_spheres spheres = wide_spheres_load(block, lane);
        uint32_t count = 0;
        for (uint32_t i = 0; i < visit->count; i++) {
            uint32_t index = stream->pool[visit->list + i];
            struct wide_ray ray = wide_ray_of(stream, index);
            unsigned bits = vi_bits(wide_spheres_ahead(&spheres, &ray));
            stream->some[count] = index;
            stream->bits[count] = (uint8_t)bits;
            count += bits != 0;
        }
        for (uint32_t i = 0; i < count; i++)
            for (unsigned bits = stream->bits[i]; bits; bits &= bits - 1) {
                pairs->ray[pairs->count] = stream->some[i];
                pairs->prim[pairs->count++] = block->id[lane + __builtin_ctz(bits)];
                if (pairs->count == RB_LANES)
                    meet_pairs(stream);
            }
    }
}

// The same; but those that are put aside do hit a triangle, and meet all of its block again.
static void visit_triangles(struct stream *stream, const struct visit *visit)
{
    const struct rb_wide_triangles *block =
        &stream->world->wide->triangles[rb_wide_index_of(visit->child)];
    for (int lane = 0; lane < RB_WIDE; lane += RB_LANES) {
        struct wide_triangles triangles = wide_triangles_load(block, lane);
        uint32_t count = 0;
        for (uint32_t i = 0; i < visit->count; i++) {
            uint32_t index = stream->pool[visit->list + i];
            struct wide_ray ray = wide_ray_of(stream, index);
            stream->some[count] = index;
            count += vi_bits(wide_triangles_edges(&triangles, &ray).found) != 0;
        }
        for (uint32_t i = 0; i < count; i++) {
            struct wide_ray ray = wide_ray_of(stream, stream->some[i]);
            struct wide_hits hits = wide_triangles_hit(&triangles, &ray);
            take_lanes(stream, stream->some[i], &hits);
        }
    }
}

static void visit_leaf(struct stream *stream, const struct visit *visit)
{
    enum rb_wide_kind kind = rb_wide_kind_of(visit->child);
    if (kind == RB_WIDE_OTHERS || stream->sides == RB_SIDES_FRONT) {
        visit_others(stream, visit);
        return;
    }
    if (kind == RB_WIDE_SPHERES)
        visit_spheres(stream, visit);
    else
        visit_triangles(stream, visit);
    for (uint32_t i = 0; RB_COUNTS && i < visit->count; i++) {
        RB_COUNT_BEGIN(stream->begin + stream->pool[visit->list + i]);
        RB_COUNT(count_leaf(stream->world->wide, visit->child));
    }
}

#endif
