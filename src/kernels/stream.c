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
// Two steps for triangles: mount6 diffuse 44 -> 37, mount9 106 -> 94. What bounds a visit now is
// latency: 30 vector operations a ray, of which the scheduler holds those of four or five rays.
//
// Tried and dropped: octants that take turns, to hide misses (mount9 diffuse 10 % slower); streams
// of 1024 rays (the same, or 7 % slower); lists of one ray that go on alone (the same); mask
// registers (the same); 8 rays against one box after the other in long lists (20 to 40 % slower as
// gcc compiled it); rays stored octant by octant (diffuse the same, others 5 to 10 % slower);
// minima and maxima of distances as integers, on other ports (1 to 3 % slower); AVX-512, two rays
// against 8 boxes (5 to 18 % slower); pairs met at the end of each leaf (balls6 diffuse 5 %
// slower).
//
// Compiled once per instruction set (Makefile); the object's name of the kernel set comes with it.
#include "kernels/wide_lanes.h"

#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
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
static void test_node(struct stream *stream, const struct rb_wide_node *node,
                      const struct visit *visit, uint32_t counts[RB_WIDE], float sums[RB_WIDE])
{
    const int *b = stream->backward;
    struct vvec near[WIDE_PARTS], far[WIDE_PARTS];
    vint hits[WIDE_PARTS];
    vfloat sum[WIDE_PARTS];
    for (int part = 0; part < WIDE_PARTS; part++) {
        near[part] = (struct vvec){vf_load(node->bounds[0][b[0]] + part * RB_LANES),
                                   vf_load(node->bounds[1][b[1]] + part * RB_LANES),
                                   vf_load(node->bounds[2][b[2]] + part * RB_LANES)};
        far[part] = (struct vvec){vf_load(node->bounds[0][!b[0]] + part * RB_LANES),
                                  vf_load(node->bounds[1][!b[1]] + part * RB_LANES),
                                  vf_load(node->bounds[2][!b[2]] + part * RB_LANES)};
        hits[part] = vi_set(0);
        sum[part] = vf_set(0.0f);
    }
    for (uint32_t i = 0; i < visit->count; i++) {
        uint32_t index = stream->pool[visit->list + i];
        const struct stream_ray *one = &stream->ray[index];
        struct wide_ray ray;
        ray.o = vv_set(one->o), ray.inv = vv_set(one->inv);
        vfloat limit = vf_set(one->t);
        unsigned bits = 0;
        for (int part = 0; part < WIDE_PARTS; part++) {
            vfloat from, to;
            wide_slabs(near[part], far[part], &ray, &from, &to);
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
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    for (uint32_t i = 0; i < visit->count; i += 8) {
        uint64_t eight;
        memcpy(&eight, stream->bits + i, 8);
        uint32_t rest = visit->count - i;
        if (rest < 8)
            eight &= ((uint64_t)1 << 8 * rest) - 1;
        eight = transpose(eight);
        memcpy(stream->bits + i, &eight, 8);
    }
    for (int part = 0; part < WIDE_PARTS; part++) {
        vi_store(counts + part * RB_LANES, hits[part]);
        vf_store(sums + part * RB_LANES, sum[part]);
    }
}

// The rays of a list that reach child `lane`; whole vectors are written.
static inline void filter(const struct stream *stream, const struct visit *visit, int lane,
                          uint32_t *to)
{
    for (uint32_t i = 0; i < visit->count; i += RB_LANES) {
        unsigned eight = stream->bits[i / 8 * 8 + (uint32_t)lane];
        unsigned bits = eight >> i % 8 & VI_ALL_BITS;
        to += vi_pack(to, vi_load(stream->pool + visit->list + i), bits);
    }
}

// Leaves visits of the children on the stack, the one that is nearest on average on top.
static int visit_node(struct stream *stream, const struct visit *visit, uint32_t top, int depth)
{
    const struct rb_wide_node *node = &stream->world->wide->nodes[visit->child];
    uint32_t counts[RB_WIDE];
    float sums[RB_WIDE];
    uint64_t order[RB_WIDE];
    int reached = 0;
    test_node(stream, node, visit, counts, sums);
    for (uint32_t lane = 0; lane < RB_WIDE; lane++) {
        if (!counts[lane])
            continue;
        uint64_t key = visit_make(sums[lane] / (float)counts[lane], lane);
        int at = reached++;
        for (; at > 0 && order[at - 1] < key; at--)
            order[at] = order[at - 1];
        order[at] = key;
    }
    for (int i = 0; i < reached; i++) {
        int lane = (int)(uint32_t)order[i];
        stream->stack[depth++] = (struct visit){node->child[lane], top, counts[lane]};
        filter(stream, visit, lane, stream->pool + top);
        rb_wide_prefetch(stream->world->wide, node->child[lane]);
        top += counts[lane];
    }
    return depth;
}

// Sends the rays of one octant, a list in the pool, through the tree. What is above `floor` in the
// pool is free.
static void traverse(struct stream *stream, uint32_t list, uint32_t count, uint32_t floor)
{
    int depth = 0;
    stream->stack[depth++] = (struct visit){0, list, count};
    while (depth > 0) {
        struct visit visit = stream->stack[--depth];
        uint32_t end = visit.list + visit.count, top = end > floor ? end : floor;
        if (rb_wide_kind_of(visit.child) != RB_WIDE_NODE)
            visit_leaf(stream, &visit);
        else if (POOL - top < RB_WIDE * (visit.count + 1))
            go_alone(stream, &visit);
        else
            depth = visit_node(stream, &visit, top, depth);
    }
    if (stream->pairs.count)
        meet_pairs(stream);
}

// Lists the rays octant by octant, from the start of the pool; first[i] is where octant i begins.
// Coherent rays are dealt with by whole vectors.
static void sort_octants(struct stream *stream, uint32_t first[OCTANTS + 2])
{
    uint32_t next[OCTANTS + 1];
    memset(first, 0, (OCTANTS + 2) * sizeof *first);
    for (uint32_t i = 0; i < stream->count; i += RB_LANES) {
        const uint32_t *octant = stream->octant + i;
        if (!vi_any(vi_load(octant) != vi_set(*octant)))
            first[*octant + 1] += RB_LANES;
        else
            for (uint32_t lane = 0; lane < RB_LANES; lane++)
                first[octant[lane] + 1]++;
    }
    for (int octant = 0; octant < OCTANTS; octant++)
        first[octant + 1] += first[octant];
    memcpy(next, first, sizeof next);
    for (uint32_t i = 0; i < stream->count; i += RB_LANES) {
        const uint32_t *octant = stream->octant + i;
        if (!vi_any(vi_load(octant) != vi_set(*octant))) {
            vi_store(stream->pool + next[*octant], vi_set(i) + vi_lanes());
            next[*octant] += RB_LANES;
        } else {
            for (uint32_t lane = 0; lane < RB_LANES; lane++)
                stream->pool[next[octant[lane]]++] = i + lane;
        }
    }
}

static void run(struct stream *stream)
{
    uint32_t first[OCTANTS + 2];
    if (stream->world->wide->count[RB_WIDE_NODE] == 0)
        return;
    sort_octants(stream, first);
    for (int octant = 0; octant < OCTANTS; octant++) {
        uint32_t count = first[octant + 1] - first[octant];
        for (int k = 0; k < 3; k++)
            stream->backward[k] = octant >> k & 1;
        if (count)
            traverse(stream, first[octant], count, first[OCTANTS]);
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
