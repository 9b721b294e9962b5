// Streams: all rays of a batch go through the wide tree together, from node to node, each of them
// against 8 boxes at once (Tsakok 2009, "Faster incoherent rays: multi-BVH ray stream tracing";
// Barringer and Akenine-Moeller 2014, "Dynamic ray stream traversal"). A node is fetched once for
// all rays that reach it, its planes stay in registers, and rays do not wait for each other: what
// single rays lose to latency and mispredicted branches is hidden, coherent or not.
//
// Rays are kept apart by the octant of their direction, which says for all of them which planes are
// nearer. A visit is a node and the list of its rays. Rays that have found something closer than
// the node drop out when the boxes of its children are tested.
//
// Groups of 16 neighbours in the queue that are of one octant are one entry of a list. A node's
// boxes are held against the intervals of their origins and inverse directions (Boulos, Wald,
// Shirley 2006); only groups that may part at one of them are tested ray by ray, and what does not
// go on as a whole goes on as rays.
//
// A ray that goes into the sphere it starts on has that hit before it begins, and is culled by it.
//
// Against single rays (wide.c), ns a ray on one Zen 4 thread: diffuse rays of balls_high 90 -> 28,
// balls6 190 -> 103, mount9 252 -> 94. What the last steps brought on balls_high, in ns for
// diffuse, reflected, refracted, shadow rays:
//   one step per leaf, rays of 64 bytes                  42.8  38.7  26.0  27.5
//   rays of 32 bytes, hits written where they belong     41.5  37.7  25.1  27.8
//   two steps, own sphere first                          33.4  31.6  17.7  22.1
//   queue to rays by transposing in registers            31.0  29.0  15.2  19.4
//   pairs of rays and spheres                            28.4  25.9  14.0  18.6
//   octants of coherent rays by whole vectors            28.4  25.1  13.1  17.7
//   groups of 16 coherent rays                           27.6  23.2  10.2  14.4
// Two steps for triangles: mount6 diffuse 44 -> 37, mount9 106 -> 94. What bounds a visit now is
// latency: 30 vector operations a ray, of which the scheduler holds those of four or five rays.
//
// Tried and dropped: octants that take turns, to hide misses (mount9 diffuse 10 % slower); streams
// of 1024 rays (the same, or 7 % slower); lists of one ray that go on alone (the same); mask
// registers (the same); 8 rays against one box after the other in long lists (20 to 40 % slower as
// gcc compiled it); rays stored octant by octant (diffuse the same, others 5 to 10 % slower);
// minima and maxima of distances as integers, on other ports (1 to 3 % slower); AVX-512, two rays
// against 8 boxes (5 to 18 % slower); pairs met at the end of each leaf (balls6 diffuse 5 %
// slower); 32 registers and vpcompressd of AVX-512VL (2 % faster, 2 % slower); two rays side by
// side in leaves of spheres (the same); beams made while rays are stored (8 % slower).
//
// Compiled once per instruction set (Makefile); the object's name of the kernel set comes with it.
#include "kernels/wide_lanes.h"

#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
#include "kernels/stream_groups.h"
#include "kernels/stream_leaves.h"
#include "kernels/wide_single.h"

#ifndef RB_STREAM
#ifdef __aarch64__
#define RB_STREAM rb_kernels_stream_neon
#else
#define RB_STREAM rb_kernels_stream_sse2
#endif
#endif

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(RB_STREAM) = {
    .generate = generate,
    .trace = trace,
    .surface = surface,
    .light = light,
    .trace_shadow = trace_shadow,
};

// Goes on with the rays of a visit one by one.
static void go_alone(struct stream *stream, const struct visit *visit)
{
    for (uint32_t i = 0; i < visit->count; i++) {
        uint32_t index = stream->pool[visit->list + i];
        struct rb_ray one = ray_of(stream, index);
        struct wide_ray ray;
        wide_ray_make(&one, &ray);
        RB_COUNT_BEGIN(stream->begin + index);
        if (!stream->occluded) {
            struct rb_hit best = best_of(stream, index);
            best = single_closest(stream->world, visit->child, &ray, best);
            keep(stream, index, &best);
        } else if (single_any(stream->world, visit->child, &ray, stream->ray[index].t)) {
            keep_occluded(stream, index);
        }
    }
}

// Row i of an 8 x 8 bit matrix, a byte, becomes its column i (Warren, "Hacker's Delight").
static inline uint64_t transpose(uint64_t m)
{
    uint64_t swap = (m ^ m >> 7) & 0x00aa00aa00aa00aau;
    m ^= swap ^ swap << 7;
    swap = (m ^ m >> 14) & 0x0000cccc0000ccccu;
    m ^= swap ^ swap << 14;
    swap = (m ^ m >> 28) & 0x00000000f0f0f0f0u;
    return m ^ swap ^ swap << 28;
}

// Which children the rays of a list reach: bits by ray, counts and sums of distances by child.
static void test_rays(struct stream *stream, const struct rb_wide_node *node,
                      const struct visit *visit, struct reach *reach)
{
    struct boxes boxes[WIDE_PARTS];
    vint hits[WIDE_PARTS];
    vfloat sum[WIDE_PARTS];
    for (int part = 0; part < WIDE_PARTS; part++) {
        boxes[part] = boxes_of(node, stream->backward, part);
        hits[part] = vi_set(0);
        sum[part] = vf_set(0.0f);
    }
    const uint32_t *list = stream->pool + visit->list + visit->groups;
    for (uint32_t i = 0; i < visit->count; i++) {
        uint32_t index = list[i];
        const struct stream_ray *one = &stream->ray[index];
        struct wide_ray ray;
        ray.o = vv_set(one->o), ray.inv = vv_set(one->inv);
        vfloat limit = vf_set(one->t);
        unsigned bits = 0;
        for (int part = 0; part < WIDE_PARTS; part++) {
            vfloat from, to;
            wide_slabs(boxes[part].near, boxes[part].far, &ray, &from, &to);
            vint hit = from <= vf_min(to, limit);
            bits |= vi_bits(hit) << (part * RB_LANES);
            hits[part] -= hit;
            sum[part] += (vfloat)((vint)from & hit);
        }
        stream->bits[i] = (uint8_t)bits;
        RB_COUNT_BEGIN(stream->begin + index);
        RB_COUNT_STEP((1u << node->count) - 1, RB_WIDE);
        RB_COUNT_RAYS(NODES, 1, 1);
        RB_COUNT_RAYS(BOXES, 1, node->count);
    }
    for (uint32_t i = 0; i < visit->count; i += 8) {
        uint64_t eight;
        memcpy(&eight, stream->bits + i, 8);
        uint32_t rest = visit->count - i;
        if (rest < 8)
            eight &= ((uint64_t)1 << 8 * rest) - 1;
        eight = transpose(eight);
        memcpy(stream->bits + i, &eight, 8);
    }
    reach_add(reach, hits, sum);
}

// The visit of child `lane` by what reaches it, listed from `top` on; whole vectors are written.
// The first rays of the list are those of its groups, which stay together where all of them go.
static struct visit filter(struct stream *stream, const struct visit *list, rb_wide_child child,
                           int lane, uint32_t top)
{
    const uint32_t *groups = stream->pool + list->list, *from = groups + list->groups;
    uint32_t *start = stream->pool + top, *to = start;
    for (uint32_t i = 0; i < stream->wholes; i++) {
        *to = stream->whole[i];
        to += stream->whole_bits[i] >> lane & 1;
    }
    for (uint32_t i = 0; i < list->groups; i++) {
        uint8_t *bits = stream->bits + GROUP * i + lane;
        if ((bits[0] & bits[8]) == 0xff) {
            *to++ = groups[i];
            bits[0] = bits[8] = 0;
        }
    }
    uint32_t *rays = to;
    for (uint32_t i = 0; i < list->count; i += RB_LANES) {
        unsigned eight = stream->bits[i / 8 * 8 + (uint32_t)lane];
        unsigned bits = eight >> i % 8 & VI_ALL_BITS;
        to += vi_pack(to, vi_load(from + i), bits);
    }
    return (struct visit){child, top, (uint32_t)(rays - start), (uint32_t)(to - rays)};
}

// Leaves visits of the children on the stack, the one that is nearest on average on top.
static int visit_node(struct stream *stream, const struct visit *visit, uint32_t top, int depth)
{
    const struct rb_wide_node *node = &stream->world->wide->nodes[visit->child];
    struct reach reach = {0};
    uint64_t order[RB_WIDE];
    int reached = 0;
    struct visit list = {visit->child, visit->list + visit->groups, 0, visit->count};
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    stream->wholes = 0;
    if (visit->groups)
        list.groups = test_groups(stream, node, visit, top, &reach);
    if (list.groups) {
        list.count = list_rays(stream, stream->pool + top, &list, top + list.groups);
        list.list = top, top += list.groups + list.count;
    }
    if (list.count)
        test_rays(stream, node, &list, &reach);
    for (uint32_t lane = 0; lane < RB_WIDE; lane++) {
        if (!reach.counts[lane])
            continue;
        uint64_t key = visit_make(reach.sums[lane] / (float)reach.counts[lane], lane);
        int at = reached++;
        for (; at > 0 && order[at - 1] < key; at--)
            order[at] = order[at - 1];
        order[at] = key;
    }
    for (int i = 0; i < reached; i++) {
        int lane = (int)(uint32_t)order[i];
        struct visit next = filter(stream, &list, node->child[lane], lane, top);
        stream->stack[depth++] = next;
        rb_wide_prefetch(stream->world->wide, node->child[lane]);
        top += next.groups + next.count;
    }
    return depth;
}

// Entries of the pool that a visit of a node may take, and those of its children one by one after.
static inline uint32_t room_for(const struct visit *visit)
{
    return (RB_WIDE + 2) * ((GROUP + 1) * visit->groups + visit->count + 1);
}

// Sends the rays of one octant through the tree. What is above `floor` in the pool is free.
static void traverse(struct stream *stream, struct visit first, uint32_t floor)
{
    int depth = 0;
    stream->stack[depth++] = first;
    while (depth > 0) {
        struct visit visit = stream->stack[--depth];
        uint32_t end = visit.list + visit.groups + visit.count, top = end > floor ? end : floor;
        bool node = rb_wide_kind_of(visit.child) == RB_WIDE_NODE;
        if (node && POOL - top >= room_for(&visit)) {
            depth = visit_node(stream, &visit, top, depth);
            continue;
        }
        if (visit.groups) {
            uint32_t *groups = stream->pool + visit.list;
            struct visit rays = {visit.child, visit.list + visit.groups, visit.groups, visit.count};
            if (!node)
                rays.groups = cull_groups(stream, visit.child, groups, visit.groups);
            rays.count = list_rays(stream, groups, &rays, top);
            visit = (struct visit){visit.child, top, 0, rays.count};
        }
        if (!node)
            visit_leaf(stream, &visit);
        else
            go_alone(stream, &visit);
    }
    if (stream->pairs.count)
        meet_pairs(stream);
}

// Lists the groups and rays octant by octant, from the start of the pool; returns the end.
static uint32_t sort_octants(struct stream *stream, struct visit first[OCTANTS])
{
    uint32_t groups[OCTANTS + 1] = {0}, rays[OCTANTS + 1] = {0}, top = 0;
    for (uint32_t i = 0; i < stream->count; i += GROUP) {
        const uint32_t *octant = stream->octant + i;
        stream->alike[i / GROUP] = one_octant(octant);
        if (stream->alike[i / GROUP])
            groups[*octant]++, store_beam(stream, i / GROUP);
        else
            for (uint32_t lane = 0; lane < GROUP; lane++)
                rays[octant[lane]]++;
    }
    for (int octant = 0; octant < OCTANTS; octant++) {
        first[octant] = (struct visit){0, top, groups[octant], rays[octant]};
        groups[octant] = top, top += first[octant].groups;
        rays[octant] = top, top += first[octant].count;
    }
    groups[OCTANTS] = rays[OCTANTS] = top;
    for (uint32_t i = 0; i < stream->count; i += GROUP) {
        const uint32_t *octant = stream->octant + i;
        if (stream->alike[i / GROUP])
            stream->pool[groups[*octant]++] = i / GROUP;
        else
            for (uint32_t lane = 0; lane < GROUP; lane++)
                stream->pool[rays[octant[lane]]++] = i + lane;
    }
    return top;
}

static void run(struct stream *stream)
{
    struct visit first[OCTANTS];
    if (stream->world->wide->count[RB_WIDE_NODE] == 0)
        return;
    uint32_t floor = sort_octants(stream, first);
    for (int octant = 0; octant < OCTANTS; octant++) {
        for (int k = 0; k < 3; k++)
            stream->backward[k] = octant >> k & 1;
        if (first[octant].groups + first[octant].count)
            traverse(stream, first[octant], floor);
    }
}

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    struct source source = {rays->ox, rays->oy, rays->oz,   rays->dx, rays->dy,
                            rays->dz, NULL,     rays->self, 0,        rays->count};
    struct stream stream;
    stream.pairs = (struct pairs){0};
    stream.world = world;
    stream.sides = world->one_sided ? RB_SIDES_FRONT : RB_SIDES_VISIBLE;
    stream.occluded = NULL;
    for (; source.begin < source.end; source.begin += STREAM_MAX) {
        stream.found = (struct rb_hits){hits->t + source.begin, hits->u + source.begin,
                                        hits->v + source.begin, hits->prim + source.begin};
        stream_fill(&stream, &source);
        run(&stream);
    }
    for (uint32_t i = 0; RB_COUNTS && i < rays->count; i++) {
        RB_COUNT_BEGIN(i);
        RB_COUNT_RAYS(HITS, hits->prim[i] != RB_NONE, 1);
    }
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    struct source source = {shadows->ox, shadows->oy,   shadows->oz,       shadows->dx,
                            shadows->dy, shadows->dz,   shadows->distance, shadows->self,
                            0,           shadows->count};
    struct stream stream;
    stream.pairs = (struct pairs){0};
    stream.world = world;
    stream.sides = RB_SIDES_BOTH;
    for (; source.begin < source.end; source.begin += STREAM_MAX) {
        stream.occluded = shadows->occluded + source.begin;
        stream_fill(&stream, &source);
        run(&stream);
    }
    for (uint32_t i = 0; RB_COUNTS && i < shadows->count; i++) {
        RB_COUNT_BEGIN(i);
        RB_COUNT_RAYS(OCCLUDED, shadows->occluded[i], 1);
    }
}
