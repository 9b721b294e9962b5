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
// Compiled once per instruction set (Makefile); the object's name of the kernel set comes with it.
#include "kernels/packet_generate.h"
#include "kernels/packet_light.h"
#include "kernels/packet_surface.h"
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
    uint32_t count;
    int backward[3];  // of the octant in work
    uint32_t deepest; // most visits that waited
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

// RB_LANES rays of a queue.
struct lanes {
    struct vvec o, d;
    vint self, valid;
};

// The closest of `best` and the planes. Their ids ascend, so that the first of equals stays.
static inline void meet_planes(const struct stream *stream, const struct lanes *lanes,
                               vfloat *best_t, vint *best_prim)
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
        vint closer = asked & (t > 0.0f) & (t < INFINITY) & (t < *best_t);
        if (front)
            closer &= ~(facing > 0.0f);
        RB_COUNT_STEP(vi_bits(asked), RB_LANES);
        RB_COUNT_RAYS(PLANES, vi_bits(asked), 1);
        RB_COUNT_BYTES(PRIMITIVE_BYTES, sizeof *scene->planes);
        *best_t = vf_select(closer, t, *best_t);
        *best_prim = vi_select(closer, prim, *best_prim);
    }
}

// Appends rays; `best_t` and `best_prim` are what they have to beat.
static inline void add(struct stream *stream, const struct lanes *lanes, vfloat best_t,
                       vint best_prim)
{
    struct vvec inv = {wide_inverse(lanes->d.x), wide_inverse(lanes->d.y),
                       wide_inverse(lanes->d.z)};
    vint octant = ((inv.x < 0.0f) & 1) | ((inv.y < 0.0f) & 2) | ((inv.z < 0.0f) & 4);
    float o[3][RB_LANES], i[3][RB_LANES], d[3][RB_LANES], t[RB_LANES];
    uint32_t self[RB_LANES], prim[RB_LANES];
    vf_store(o[0], lanes->o.x), vf_store(o[1], lanes->o.y), vf_store(o[2], lanes->o.z);
    vf_store(i[0], inv.x), vf_store(i[1], inv.y), vf_store(i[2], inv.z);
    vf_store(d[0], lanes->d.x), vf_store(d[1], lanes->d.y), vf_store(d[2], lanes->d.z);
    vi_store(self, lanes->self), vf_store(t, best_t), vi_store(prim, best_prim);
    vi_store(stream->octant + stream->count, vi_select(lanes->valid, octant, vi_set(OCTANTS)));
    for (int l = 0; l < RB_LANES; l++)
        stream->ray[stream->count + (uint32_t)l] = (struct stream_ray){
            .o = {o[0][l], o[1][l], o[2][l]},
            .inv = {i[0][l], i[1][l], i[2][l]},
            .d = {d[0][l], d[1][l], d[2][l]},
            .self = self[l],
            .best = {t[l], 0.0f, 0.0f, prim[l]},
        };
    stream->count += RB_LANES;
}

// Goes on with the rays of a visit one by one.
static void go_alone(struct stream *stream, const struct visit *visit)
{
    for (uint32_t i = 0; i < visit->count; i++) {
        uint32_t index = stream->pool[visit->list + i];
        struct rb_ray one = ray_of(stream, index);
        struct wide_ray ray;
        wide_ray_make(&one, &ray);
        struct rb_hit *best = &stream->ray[index].best;
        RB_COUNT_BEGIN(index);
        if (stream->sides != RB_SIDES_BOTH)
            *best = single_closest(stream->world, visit->child, &ray, *best);
        else if (single_any(stream->world, visit->child, &ray, best->t))
            *best = OCCLUDED;
    }
}

// Leaves of what has no vector form.
static void visit_others(struct stream *stream, const struct visit *visit)
{
    const uint32_t *ids = rb_wide_ids(stream->world->wide, visit->child);
    for (uint32_t i = 0; i < visit->count; i++) {
        uint32_t index = stream->pool[visit->list + i];
        struct rb_ray ray = ray_of(stream, index);
        struct rb_hit *best = &stream->ray[index].best;
        RB_COUNT_BEGIN(index);
        if (stream->sides != RB_SIDES_BOTH)
            *best = leaf_one_by_one(stream->world, ids, &ray, *best);
        else if (leaf_one_by_one(stream->world, ids, &ray, RB_MISS).t < best->t)
            *best = OCCLUDED;
    }
}

static inline void splat(const struct stream_ray *ray, struct wide_ray *wide)
{
    wide->o = vv_set(ray->o), wide->inv = vv_set(ray->inv), wide->d = vv_set(ray->d);
}

static inline void take(const struct stream *stream, const struct wide_hits *hits,
                        struct rb_hit *best)
{
    if (stream->sides != RB_SIDES_BOTH)
        *best = keep_closest(hits, *best);
    else if (vi_any(hits->found & (hits->t < best->t)))
        *best = OCCLUDED;
}

// What the two loops over the rays of a leaf have in common.
#define FOR_EACH_RAY(stream, visit, ray, best, test)                                               \
    for (uint32_t i = 0; i < (visit)->count; i++) {                                                \
        uint32_t index = (stream)->pool[(visit)->list + i];                                        \
        struct rb_ray one = {.self = (stream)->ray[index].self, .sides = (stream)->sides};         \
        struct wide_ray ray = {.one = &one};                                                       \
        splat(&(stream)->ray[index], &ray);                                                        \
        struct wide_hits hits = test;                                                              \
        take(stream, &hits, &(stream)->ray[index].best);                                           \
    }

static void visit_spheres(struct stream *stream, const struct visit *visit, int lane)
{
    uint32_t block = rb_wide_index_of(visit->child);
    struct wide_spheres spheres = wide_spheres_load(&stream->world->wide->spheres[block], lane);
    FOR_EACH_RAY(stream, visit, ray, best, wide_spheres_hit(&spheres, &ray))
}

static void visit_triangles(struct stream *stream, const struct visit *visit, int lane)
{
    uint32_t block = rb_wide_index_of(visit->child);
    struct wide_triangles triangles =
        wide_triangles_load(&stream->world->wide->triangles[block], lane);
    FOR_EACH_RAY(stream, visit, ray, best, wide_triangles_hit(&triangles, &ray))
}

static void visit_leaf(struct stream *stream, const struct visit *visit)
{
    enum rb_wide_kind kind = rb_wide_kind_of(visit->child);
    if (kind == RB_WIDE_OTHERS || stream->sides == RB_SIDES_FRONT) {
        visit_others(stream, visit);
        return;
    }
    for (int lane = 0; lane < RB_WIDE; lane += RB_LANES)
        (kind == RB_WIDE_SPHERES ? visit_spheres : visit_triangles)(stream, visit, lane);
    for (uint32_t i = 0; RB_COUNTS && i < visit->count; i++) {
        RB_COUNT_BEGIN(stream->pool[visit->list + i]);
        RB_COUNT(count_leaf(stream->world->wide, visit->child));
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
        vfloat limit = vf_set(one->best.t);
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
        RB_COUNT_BEGIN(index);
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
        unsigned bits = stream->bits[i / 8 * 8 + (uint32_t)lane] >> i % 8 & VI_ALL_BITS;
        to += vi_pack(to, vi_load(stream->pool + visit->list + i), bits);
    }
}

static inline void prefetch(const struct rb_wide *wide, rb_wide_child child)
{
    uint32_t index = rb_wide_index_of(child);
    enum rb_wide_kind kind = rb_wide_kind_of(child);
    const char *at = kind == RB_WIDE_NODE      ? (const char *)&wide->nodes[index]
                     : kind == RB_WIDE_SPHERES ? (const char *)&wide->spheres[index]
                                               : (const char *)&wide->triangles[index];
    for (int i = 0; i < (kind == RB_WIDE_TRIANGLES ? 5 : 4); i++)
        __builtin_prefetch(at + 64 * i);
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
        prefetch(stream->world->wide, node->child[lane]);
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
        else if (visit.count < 1 || POOL - top < RB_WIDE * (visit.count + 1))
            go_alone(stream, &visit);
        else
            depth = visit_node(stream, &visit, top, depth);
        stream->deepest = (uint32_t)depth > stream->deepest ? (uint32_t)depth : stream->deepest;
    }
}

static void run(struct stream *stream)
{
    uint32_t first[OCTANTS + 2] = {0}; // of each octant, in the pool
    if (stream->world->wide->count[RB_WIDE_NODE] == 0)
        return;
    for (uint32_t i = 0; i < stream->count; i++)
        first[stream->octant[i] + 1]++;
    for (int octant = 0; octant < OCTANTS; octant++)
        first[octant + 1] += first[octant];
    uint32_t next[OCTANTS + 1];
    memcpy(next, first, sizeof next);
    for (uint32_t i = 0; i < stream->count; i++)
        stream->pool[next[stream->octant[i]]++] = i;
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
    struct stream stream;
    stream.world = world;
    stream.sides = world->one_sided ? RB_SIDES_FRONT : RB_SIDES_VISIBLE;
    for (uint32_t begin = 0; begin < rays->count; begin += STREAM_MAX) {
        uint32_t count = rays->count - begin < STREAM_MAX ? rays->count - begin : STREAM_MAX;
        stream.count = 0;
        for (uint32_t i = begin; i < begin + count; i += RB_LANES) {
            struct lanes lanes = {
                .o = {vf_load(rays->ox + i), vf_load(rays->oy + i), vf_load(rays->oz + i)},
                .d = {vf_load(rays->dx + i), vf_load(rays->dy + i), vf_load(rays->dz + i)},
                .self = vi_load(rays->self + i),
            };
            lanes.valid = vi_first(rays->count - i) & vv_finite(lanes.o) & vv_finite(lanes.d);
            vfloat t = vf_set(INFINITY);
            vint prim = vi_set(RB_NONE);
            RB_COUNT_BEGIN(i);
            meet_planes(&stream, &lanes, &t, &prim);
            add(&stream, &lanes, t, prim);
        }
        run(&stream);
        for (uint32_t i = 0; i < count; i++) {
            rb_hit_store(hits, begin + i, &stream.ray[i].best);
            RB_COUNT_BEGIN(begin + i);
            RB_COUNT_RAYS(HITS, stream.ray[i].best.prim != RB_NONE, 1);
        }
    }
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    struct stream stream;
    stream.world = world;
    stream.sides = RB_SIDES_BOTH;
    for (uint32_t begin = 0; begin < shadows->count; begin += STREAM_MAX) {
        uint32_t count = shadows->count - begin < STREAM_MAX ? shadows->count - begin : STREAM_MAX;
        stream.count = 0;
        for (uint32_t i = begin; i < begin + count; i += RB_LANES) {
            struct lanes lanes = {
                .o = {vf_load(shadows->ox + i), vf_load(shadows->oy + i), vf_load(shadows->oz + i)},
                .d = {vf_load(shadows->dx + i), vf_load(shadows->dy + i), vf_load(shadows->dz + i)},
                .self = vi_load(shadows->self + i),
            };
            lanes.valid = vi_first(shadows->count - i) & vv_finite(lanes.o) & vv_finite(lanes.d);
            vfloat t = vf_load(shadows->distance + i);
            vint prim = vi_set(RB_NONE);
            RB_COUNT_BEGIN(i);
            meet_planes(&stream, &lanes, &t, &prim);
            add(&stream, &lanes, vf_select(prim == vi_set(RB_NONE), t, vf_set(-1.0f)), prim);
        }
        run(&stream);
        for (uint32_t i = 0; i < count; i++) {
            shadows->occluded[begin + i] = stream.ray[i].best.prim != RB_NONE;
            RB_COUNT_BEGIN(begin + i);
            RB_COUNT_RAYS(OCCLUDED, shadows->occluded[begin + i], 1);
        }
    }
}
