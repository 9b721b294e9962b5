// Binned SAH, in two phases. The first splits ranges, round by round, until there are enough
// subtrees to share; the subtrees are then built in parallel, each in node slots of its own, and
// copied behind the top of the tree in a fixed order. Sorting on every axis (full sweep SAH) was
// rejected: binned trees cost nearly the same (Wald 2007) at a fraction of the build time.
#include "accel/bvh.h"

#include "accel/parallel.h"
#include "accel/sah.h"
#include "base/memory.h"

#include <string.h>

enum {
    DEPTH_HALVE = 48,   // from here on ranges are halved, see RB_BVH_DEPTH_MAX
    SUBTREES = 64,      // shared among the workers
    BOUND_CHUNK = 4096, // primitives whose boxes a worker computes at a time
    SUBTREE_MIN = 1024, // primitives below which a range is not split for sharing
};

// A primitive test includes the test of its own box, half that of a node's two.
static const struct rb_bvh_leaves SINGLE = {.block = 1, .cost = 1.5f};

// A range of items that becomes one child of a node.
struct range {
    uint32_t begin, end;
    struct rb_box box;
    int depth;
};

struct builder {
    const struct rb_scene *scene;
    const struct rb_bvh_leaves *leaves;
    struct rb_sah_item *items;
    struct rb_bvh_node *nodes;
};

static struct range range_of(const struct builder *builder, uint32_t begin, uint32_t end, int depth)
{
    struct range range = {begin, end, RB_BOX_EMPTY, depth};
    for (uint32_t i = begin; i < end; i++)
        rb_box_include(&range.box, &builder->items[i].box);
    return range;
}

// Moves the primitives of the same kind as the first one to the front; returns how many there are.
static uint32_t partition_kinds(const struct builder *builder, struct rb_sah_item *items,
                                uint32_t count)
{
    enum rb_kind kind = rb_scene_kind(builder->scene, rb_sah_item_id(&items[0]));
    uint32_t same = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (rb_scene_kind(builder->scene, rb_sah_item_id(&items[i])) == kind) {
            struct rb_sah_item swap = items[same];
            items[same++] = items[i];
            items[i] = swap;
        }
    }
    return same;
}

// Where to split a range that the heuristic, or its depth, would make a leaf; its end if it may be.
static uint32_t leaf_middle(const struct builder *builder, struct rb_sah_item *items,
                            uint32_t count)
{
    return builder->leaves->one_kind ? partition_kinds(builder, items, count) : count;
}

// Splits `range` in two; false if it should be a leaf.
static bool range_split(const struct builder *builder, const struct range *range,
                        struct range out[2])
{
    struct rb_sah_item *items = builder->items + range->begin;
    uint32_t count = range->end - range->begin, middle = count / 2;
    const struct rb_bvh_leaves *leaves = builder->leaves;
    if (count < 2)
        return false;
    if (range->depth < DEPTH_HALVE) {
        struct rb_sah_split split = rb_sah_find(items, count, leaves->block);
        float area = rb_box_half_area(&range->box);
        float leaf_cost = leaves->cost * rb_sah_blocks(count, leaves->block) * area;
        bool pays = area + leaves->cost * split.cost < leaf_cost;
        if (count <= RB_BVH_LEAF_MAX && !pays)
            middle = leaf_middle(builder, items, count);
        else if (split.cost < INFINITY)
            middle = rb_sah_partition(items, count, &split);
    } else if (count <= RB_BVH_LEAF_MAX) {
        middle = leaf_middle(builder, items, count);
    }
    if (middle == count)
        return false;
    out[0] = range_of(builder, range->begin, range->begin + middle, range->depth + 1);
    out[1] = range_of(builder, range->begin + middle, range->end, range->depth + 1);
    return true;
}

static void node_set_child(struct rb_bvh_node *node, int child, const struct range *range)
{
    for (int k = 0; k < 3; k++) {
        node->bounds[k][0][child] = range->box.low[k];
        node->bounds[k][1][child] = range->box.high[k];
    }
    node->child[child] = range->begin;
    node->count[child] = range->end - range->begin;
}

// Builds the inner node of a range that splits into `halves`, and everything below it, at
// nodes[*next] onwards; returns its index.
static uint32_t build_node(const struct builder *builder, const struct range halves[2],
                           uint32_t *next)
{
    uint32_t index = (*next)++;
    for (int c = 0; c < 2; c++) {
        struct range quarters[2];
        node_set_child(&builder->nodes[index], c, &halves[c]);
        if (range_split(builder, &halves[c], quarters)) {
            builder->nodes[index].count[c] = 0;
            builder->nodes[index].child[c] = build_node(builder, quarters, next);
        }
    }
    return index;
}

// A range that one worker builds: a child of a node of the top tree.
struct subtree {
    struct range range;
    uint32_t parent;
    int child;
    bool splits; // into these
    struct range halves[2];
    uint32_t node_count; // nodes made, in slots range.begin onwards
    uint32_t place;      // where they end up
};

// The top of the tree: nodes and the open ends below them, both in order of creation.
struct top {
    struct rb_bvh_node nodes[SUBTREES];
    struct subtree open[SUBTREES];
    uint32_t node_count, open_count;
};

static void top_open(struct top *top, const struct range halves[2], uint32_t first_slot)
{
    uint32_t index = top->node_count++;
    for (int c = 0; c < 2; c++) {
        node_set_child(&top->nodes[index], c, &halves[c]);
        uint32_t slot = c == 0 ? first_slot : top->open_count++;
        top->open[slot] = (struct subtree){.range = halves[c], .parent = index, .child = c};
    }
}

static void build_subtree(const struct builder *builder, struct subtree *subtree)
{
    struct range halves[2];
    uint32_t next = subtree->range.begin;
    if (range_split(builder, &subtree->range, halves))
        build_node(builder, halves, &next);
    subtree->node_count = next - subtree->range.begin;
}

// Copies a finished subtree from its slots to its place in the tree.
static void place_subtree(const struct builder *builder, const struct subtree *subtree,
                          struct rb_bvh_node *nodes)
{
    uint32_t begin = subtree->range.begin;
    for (uint32_t i = 0; i < subtree->node_count; i++) {
        struct rb_bvh_node node = builder->nodes[begin + i];
        for (int c = 0; c < 2; c++)
            if (node.count[c] == 0)
                node.child[c] += subtree->place - begin;
        nodes[subtree->place + i] = node;
    }
    if (subtree->node_count) {
        nodes[subtree->parent].count[subtree->child] = 0;
        nodes[subtree->parent].child[subtree->child] = subtree->place;
    }
}

static double node_cost(const struct rb_bvh_leaves *leaves, const struct rb_bvh_node *node)
{
    double cost = 0;
    for (int c = 0; c < 2; c++) {
        struct rb_box box;
        for (int k = 0; k < 3; k++) {
            box.low[k] = node->bounds[k][0][c];
            box.high[k] = node->bounds[k][1][c];
        }
        float blocks = rb_sah_blocks(node->count[c], leaves->block);
        double weight = node->count[c] ? (double)(leaves->cost * blocks) : 1.0;
        cost += box.low[0] <= box.high[0] ? (double)rb_box_half_area(&box) * weight : 0.0;
    }
    return cost;
}

// What the parallel loops below work on.
struct job {
    const struct rb_scene *scene;
    const struct builder *builder;
    struct top *top;
    struct rb_bvh *bvh;
};

static void bound_step(const void *of, uint32_t chunk)
{
    const struct job *job = of;
    uint32_t begin = chunk * BOUND_CHUNK, rest = job->bvh->ref_count - begin;
    uint32_t end = begin + (rest < BOUND_CHUNK ? rest : BOUND_CHUNK);
    for (uint32_t i = begin; i < end; i++) {
        float low[3], high[3];
        rb_scene_bounds(job->scene, i, low, high);
        job->builder->items[i] = rb_sah_item_make(low, high, i);
    }
}

static void split_step(const void *of, uint32_t i)
{
    const struct job *job = of;
    struct subtree *open = &job->top->open[i];
    open->splits = open->range.end - open->range.begin >= SUBTREE_MIN &&
                   range_split(job->builder, &open->range, open->halves);
}

// Splits all open ranges, in rounds, as long as there is room for twice as many.
static void build_top(const struct job *job, const struct range halves[2], int threads)
{
    struct top *top = job->top;
    uint32_t before = 0;
    top->open_count = 1;
    top_open(top, halves, 0);
    while (top->open_count > before && top->open_count <= SUBTREES / 2) {
        before = top->open_count;
        rb_parallel_for(threads, before, split_step, job);
        for (uint32_t i = 0; i < before; i++) {
            struct subtree open = top->open[i];
            if (!open.splits)
                continue;
            top->nodes[open.parent].count[open.child] = 0;
            top->nodes[open.parent].child[open.child] = top->node_count;
            top_open(top, open.halves, i);
        }
    }
}

static void build_step(const void *of, uint32_t i)
{
    const struct job *job = of;
    build_subtree(job->builder, &job->top->open[i]);
}

static void place_step(const void *of, uint32_t i)
{
    const struct job *job = of;
    place_subtree(job->builder, &job->top->open[i], job->bvh->nodes);
}

static enum rb_status assemble(const struct job *job, int threads)
{
    struct top *top = job->top;
    struct rb_bvh *bvh = job->bvh;
    rb_parallel_for(threads, top->open_count, build_step, job);
    bvh->node_count = top->node_count;
    for (uint32_t i = 0; i < top->open_count; i++) {
        top->open[i].place = bvh->node_count;
        bvh->node_count += top->open[i].node_count;
    }
    bvh->nodes = rb_alloc(bvh->node_count, sizeof *bvh->nodes);
    if (!bvh->nodes)
        return RB_FAILED;
    memcpy(bvh->nodes, top->nodes, top->node_count * sizeof *bvh->nodes);
    rb_parallel_for(threads, top->open_count, place_step, job);
    for (uint32_t i = 0; i < bvh->ref_count; i++)
        bvh->refs[i] = rb_sah_item_id(&job->builder->items[i]);
    return RB_OK;
}

static enum rb_status build(const struct job *job, int threads)
{
    struct rb_bvh *bvh = job->bvh;
    rb_parallel_for(threads, (bvh->ref_count - 1) / BOUND_CHUNK + 1, bound_step, job);
    struct range root = range_of(job->builder, 0, bvh->ref_count, 0);
    struct range halves[2] = {root, {.box = RB_BOX_EMPTY}};
    range_split(job->builder, &root, halves); // else one leaf and an empty child
    build_top(job, halves, threads);
    enum rb_status status = assemble(job, threads);
    double area = (double)rb_box_half_area(&root.box), cost = 0;
    for (uint32_t i = 0; status == RB_OK && i < bvh->node_count; i++)
        cost += node_cost(job->builder->leaves, &bvh->nodes[i]);
    bvh->sah_cost = area > 0 ? 1.0 + cost / area : 1.0;
    return status;
}

enum rb_status rb_bvh_build_leaves(const struct rb_scene *scene, const struct rb_bvh_leaves *leaves,
                                   int threads, struct rb_bvh *bvh, struct rb_error *error)
{
    *bvh = (struct rb_bvh){.ref_count = scene->bounded_count};
    if (bvh->ref_count == 0)
        return RB_OK;
    enum rb_status status = RB_FAILED;
    struct builder builder = {
        .scene = scene,
        .leaves = leaves,
        .items = rb_alloc(bvh->ref_count, sizeof *builder.items),
        .nodes = rb_alloc(bvh->ref_count, sizeof *builder.nodes),
    };
    struct top *top = rb_alloc(1, sizeof *top);
    bvh->refs = rb_alloc(bvh->ref_count, sizeof *bvh->refs);
    if (builder.items && builder.nodes && top && bvh->refs)
        status = build(&(struct job){scene, &builder, top, bvh}, threads);
    if (status == RB_OK)
        bvh->bytes = bvh->node_count * sizeof *bvh->nodes + bvh->ref_count * sizeof *bvh->refs;
    else
        rb_bvh_free(bvh), rb_error_memory(error, "the bounding volume hierarchy");
    rb_free(builder.items);
    rb_free(builder.nodes);
    rb_free(top);
    return status;
}

enum rb_status rb_bvh_build(const struct rb_scene *scene, int threads, struct rb_bvh *bvh,
                            struct rb_error *error)
{
    return rb_bvh_build_leaves(scene, &SINGLE, threads, bvh, error);
}

void rb_bvh_free(struct rb_bvh *bvh)
{
    rb_free(bvh->nodes);
    rb_free(bvh->refs);
    *bvh = (struct rb_bvh){0};
}
