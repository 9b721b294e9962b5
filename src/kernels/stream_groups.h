// Groups of a stream: neighbours that a node's boxes are held against together, by intervals of
// their origins and inverse directions. Rounding is monotone: what no interval meets no ray does.
#ifndef RB_KERNELS_STREAM_GROUPS_H
#define RB_KERNELS_STREAM_GROUPS_H

#include "kernels/stream_rays.h"

// Boxes by the planes that the rays of an octant meet first and last.
struct boxes {
    struct vvec near, far;
};

RB_INLINE struct boxes boxes_of(const struct rb_wide_node *node, const int b[3], int part)
{
    int lane = part * RB_LANES;
    return (struct boxes){
        {vf_load(node->bounds[0][b[0]] + lane), vf_load(node->bounds[1][b[1]] + lane),
         vf_load(node->bounds[2][b[2]] + lane)},
        {vf_load(node->bounds[0][!b[0]] + lane), vf_load(node->bounds[1][!b[1]] + lane),
         vf_load(node->bounds[2][!b[2]] + lane)},
    };
}

// What of a beam is in a box, on one axis.
struct reaches {
    vfloat near_least, near_most, far_least, far_most;
};

RB_INLINE struct reaches beam_slab(vfloat near, vfloat far, const struct beam *beam, int k,
                                   bool backward)
{
    const struct stream_ray *first = backward ? &beam->low : &beam->high;
    const struct stream_ray *last = backward ? &beam->high : &beam->low;
    vfloat inv0 = vf_set(beam->low.inv[k]), inv1 = vf_set(beam->high.inv[k]);
    vfloat o_first = vf_set(first->o[k]), o_last = vf_set(last->o[k]);
    vfloat near_first = near - o_first, near_last = near - o_last;
    vfloat far_first = far - o_first, far_last = far - o_last;
    return (struct reaches){
        vf_min(near_first * inv0, near_first * inv1), vf_max(near_last * inv0, near_last * inv1),
        vf_min(far_first * inv0, far_first * inv1), vf_max(far_last * inv0, far_last * inv1)};
}

// Boxes against a beam: where the first of its rays may enter each, and which of them some or all
// rays pass.
RB_INLINE vfloat beam_slabs(const struct boxes *boxes, const int b[3], const struct beam *beam,
                            vint *some, vint *all)
{
    struct reaches x = beam_slab(boxes->near.x, boxes->far.x, beam, 0, b[0]);
    struct reaches y = beam_slab(boxes->near.y, boxes->far.y, beam, 1, b[1]);
    struct reaches z = beam_slab(boxes->near.z, boxes->far.z, beam, 2, b[2]);
    vfloat zero = vf_set(0.0f);
    vfloat from = vf_max(vf_max(vf_max(x.near_least, y.near_least), z.near_least), zero);
    vfloat to = vf_min(vf_min(x.far_most, y.far_most), z.far_most) * RB_FAR_SCALE;
    vfloat all_from = vf_max(vf_max(vf_max(x.near_most, y.near_most), z.near_most), zero);
    vfloat all_to = vf_min(vf_min(x.far_least, y.far_least), z.far_least) * RB_FAR_SCALE;
    *some = from <= vf_min(to, vf_set(beam->high.t));
    *all = all_from <= all_to;
    return from;
}

// Are the rays of a group of one octant?
static inline bool one_octant(const uint32_t octant[GROUP])
{
    vint differ = vi_set(*octant) == vi_set(OCTANTS);
    for (int i = 0; i < GROUP; i += RB_LANES)
        differ |= vi_load(octant + i) != vi_set(*octant);
    return !vi_any(differ);
}

// Not before all rays are stored: what was stored in pieces is slow to load as a whole.
static inline void store_beam(struct stream *stream, uint32_t group)
{
    const struct stream_ray *first = &stream->ray[group * GROUP];
    struct beam *beam = &stream->beam[group];
    uint32_t differ[RAY_FLOATS];
    for (int part = 0; part < RAY_FLOATS; part += RB_LANES) {
        const float *ray = first->o + part;
        vfloat of_first = vf_load(ray), low = of_first, high = of_first;
        vint changed = vi_set(0);
        for (uint32_t i = 1; i < GROUP; i++) {
            vfloat next = vf_load(ray + i * RAY_FLOATS);
            low = vf_min(low, next), high = vf_max(high, next);
            changed |= (vint)next ^ (vint)of_first;
        }
        vf_store(beam->low.o + part, low);
        vf_store(beam->high.o + part, high);
        vi_store(differ + part, changed);
    }
    beam->low.self = differ[RAY_FLOATS - 1] ? RB_NONE : first->self;
}

// Rays that reach a child, and the sum of the distances at which they do.
struct reach {
    uint32_t counts[RB_WIDE];
    float sums[RB_WIDE];
};

static inline void reach_add(struct reach *reach, const vint hits[WIDE_PARTS],
                             const vfloat sum[WIDE_PARTS])
{
    for (int part = 0; part < WIDE_PARTS; part++) {
        uint32_t *counts = reach->counts + part * RB_LANES;
        float *sums = reach->sums + part * RB_LANES;
        vi_store(counts, vi_load(counts) + hits[part]);
        vf_store(sums, vf_load(sums) + sum[part]);
    }
}

// Which children the groups of a list reach. Those whose rays go the same ways are kept in `whole`;
// the others are listed in the pool from `to` on, and their number returned.
static uint32_t test_groups(struct stream *stream, const struct rb_wide_node *node,
                            const struct visit *visit, uint32_t to, struct reach *reach)
{
    vint hits[WIDE_PARTS], some[WIDE_PARTS], all[WIDE_PARTS];
    vfloat sum[WIDE_PARTS], least[WIDE_PARTS];
    struct boxes boxes[WIDE_PARTS];
    uint32_t mixed = 0;
    for (int part = 0; part < WIDE_PARTS; part++) {
        boxes[part] = boxes_of(node, stream->backward, part);
        hits[part] = vi_set(0), sum[part] = vf_set(0.0f);
    }
    for (uint32_t i = 0; i < visit->groups; i++) {
        uint32_t group = stream->pool[visit->list + i];
        unsigned bits = 0, parted = 0;
        for (int part = 0; part < WIDE_PARTS; part++) {
            least[part] = beam_slabs(&boxes[part], stream->backward, &stream->beam[group],
                                     &some[part], &all[part]);
            bits |= vi_bits(some[part]) << (part * RB_LANES);
            parted |= vi_bits(some[part] & ~all[part]) << (part * RB_LANES);
        }
        if (parted) {
            stream->pool[to + mixed++] = group;
            continue;
        }
        RB_COUNT_BEGIN(stream->begin + group * GROUP);
        RB_COUNT_STEP((1u << node->count) - 1, RB_WIDE);
        RB_COUNT_RAYS(NODES, (1u << GROUP) - 1, 1);
        stream->whole[stream->wholes] = group;
        stream->whole_bits[stream->wholes++] = (uint8_t)bits;
        for (int part = 0; part < WIDE_PARTS; part++) {
            hits[part] -= some[part] * GROUP;
            sum[part] += (vfloat)((vint)least[part] & some[part]) * GROUP;
        }
    }
    reach_add(reach, hits, sum);
    return mixed;
}

// Lists the rays of list->groups groups, and those of the list after them, in the pool from `to`
// on; returns how many they are.
static uint32_t list_rays(struct stream *stream, const uint32_t *groups, const struct visit *list,
                          uint32_t to)
{
    uint32_t *pool = stream->pool;
    for (uint32_t i = 0; i < list->groups; i++, to += GROUP)
        for (uint32_t j = 0; j < GROUP; j += RB_LANES)
            vi_store(pool + to + j, vi_set(groups[i] * GROUP + j) + vi_lanes());
    memcpy(pool + to, pool + list->list, list->count * sizeof *pool);
    return list->groups * GROUP + list->count;
}

// Keeps of a list of groups those whose rays may pass the box of a sphere of a leaf, their own one
// excepted.
static uint32_t cull_groups(const struct stream *stream, rb_wide_child leaf, uint32_t *groups,
                            uint32_t count)
{
    if (rb_wide_kind_of(leaf) != RB_WIDE_SPHERES || stream->sides == RB_SIDES_FRONT)
        return count;
    const struct rb_wide_spheres *block = &stream->world->wide->spheres[rb_wide_index_of(leaf)];
    const int *b = stream->backward;
    struct boxes boxes[WIDE_PARTS];
    vint prim[WIDE_PARTS];
    for (int part = 0; part < WIDE_PARTS; part++) {
        struct wide_spheres spheres = wide_spheres_load(block, part * RB_LANES);
        vfloat r = vf_abs(spheres.radius);
        struct vvec toward = {b[0] ? -r : r, b[1] ? -r : r, b[2] ? -r : r};
        boxes[part].near = vv_sub(spheres.center, toward);
        boxes[part].far = vv_sub(spheres.center, (struct vvec){-toward.x, -toward.y, -toward.z});
        prim[part] = spheres.prim;
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct beam *beam = &stream->beam[groups[i]];
        vint any = vi_set(0);
        for (int part = 0; part < WIDE_PARTS; part++) {
            vint some, all;
            beam_slabs(&boxes[part], b, beam, &some, &all);
            any |= some & (prim[part] != vi_set(beam->low.self)) & (prim[part] != vi_set(RB_NONE));
        }
        groups[kept] = groups[i];
        kept += vi_any(any) != 0;
    }
    return kept;
}

#endif
