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
    SUBTREES = 64,      // shared among the workers; and parts that primitives are bounded in
    SUBTREE_MIN = 1024, // primitives below which a range is not split for sharing
};

// A primitive test includes the test of its own box, half that of a node's two.
static const struct rb_bvh_leaves SINGLE = {.block = 1, .cost = 1.5f};

// A range of items that becomes one child of a node.
struct range {
    uint32_t begin, end;
    struct rb_sah_bounds bounds;
    int depth;
};

struct builder {
    const struct rb_scene *scene;
    const struct rb_bvh_leaves *leaves;
    struct rb_sah_item *items;
    struct rb_bvh_node *nodes;
};

static struct rb_sah_bounds bounds_of(const struct rb_sah_item *items, uint32_t count)
{
    struct rb_sah_bounds bounds = RB_SAH_BOUNDS_EMPTY;
    for (uint32_t i = 0; i < count; i++) {
        rb_box_include(&bounds.box, &items[i].box);
        rb_box_include_point(&bounds.centers, rb_sah_center(&items[i]));
    }
    return bounds;
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
    uint32_t count = range->end - range->begin, middle = 0;
    const struct rb_bvh_leaves *leaves = builder->leaves;
    struct rb_sah_bounds sides[2];
    float area = rb_box_half_area(&range->bounds.box);
    float leaf_cost = leaves->cost * rb_sah_blocks(count, leaves->block) * area;
    bool leaf = count <= RB_BVH_LEAF_MAX;
    if (count < 2)
        return false;
    if (range->depth < DEPTH_HALVE && (!leaf || leaf_cost > area)) { // else no node is cheaper
        struct rb_sah_split split =
            rb_sah_find(items, count, &range->bounds.centers, leaves->block);
        leaf = leaf && !(area + leaves->cost * split.cost < leaf_cost);
        if (!leaf && split.cost < INFINITY)
            middle = rb_sah_partition(items, count, &split, sides);
    }
    if (middle == 0) {
        middle = leaf ? leaf_middle(builder, items, count) : count / 2;
        if (middle == count)
            return false;
        sides[0] = bounds_of(items, middle);
        sides[1] = bounds_of(items + middle, count - middle);
    }
    out[0] = (struct range){range->begin, range->begin + middle, sides[0], range->depth + 1};
    out[1] = (struct range){range->begin + middle, range->end, sides[1], range->depth + 1};
    return true;
}

static void node_set_child(struct rb_bvh_node *node, int child, const struct range *range)
{
    for (int k = 0; k < 3; k++) {
        node->bounds[k][0][child] = range->bounds.box.low[k];
        node->bounds[k][1][child] = range->bounds.box.high[k];
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
    struct rb_sah_bounds bounds[SUBTREES]; // of as many parts of the primitives
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

// Copies a finished subtree from its slots to its place in the tree, and names its primitives.
static void place_subtree(const struct builder *builder, const struct subtree *subtree,
                          struct rb_bvh *bvh)
{
    struct rb_bvh_node *nodes = bvh->nodes;
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
    for (uint32_t i = begin; i < subtree->range.end; i++)
        bvh->refs[i] = rb_sah_item_id(&builder->items[i]);
}

// What the parallel loops below work on.
struct job {
    const struct rb_scene *scene;
    const struct builder *builder;
    struct top *top;
    struct rb_bvh *bvh;
};

static void bound_step(const void *of, uint32_t part)
{
    const struct job *job = of;
    struct rb_sah_item *items = job->builder->items;
    uint64_t count = job->bvh->ref_count;
    uint32_t begin = (uint32_t)(count * part / SUBTREES);
    uint32_t end = (uint32_t)(count * (part + 1) / SUBTREES);
    for (uint32_t i = begin; i < end; i++) {
        float low[3], high[3];
        rb_scene_bounds(job->scene, i, low, high);
        items[i] = rb_sah_item_make(low, high, i);
    }
    job->top->bounds[part] = bounds_of(items + begin, end - begin);
}

static struct range bound_all(const struct job *job, int threads)
{
    struct range root = {0, job->bvh->ref_count, RB_SAH_BOUNDS_EMPTY, 0};
    rb_parallel_for(threads, SUBTREES, bound_step, job);
    for (int part = 0; part < SUBTREES; part++) {
        rb_box_include(&root.bounds.box, &job->top->bounds[part].box);
        rb_box_include(&root.bounds.centers, &job->top->bounds[part].centers);
    }
    return root;
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
    place_subtree(job->builder, &job->top->open[i], job->bvh);
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
    return RB_OK;
}

static enum rb_status build(const struct job *job, int threads)
{
    struct range root = bound_all(job, threads);
    struct range halves[2] = {root, {.bounds = RB_SAH_BOUNDS_EMPTY}};
    range_split(job->builder, &root, halves); // else one leaf and an empty child
    build_top(job, halves, threads);
    return assemble(job, threads);
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
        .nodes = rb_alloc_sparse(bvh->ref_count, sizeof *builder.nodes),
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
