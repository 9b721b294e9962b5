// Collapse: which nodes of the binary tree remain is chosen so that a ray visits the fewest, after
// the surface area heuristic: for each binary node, from the leaves up, the least that what is
// below it costs if it takes one child of a wide node, or at most 2, 3, ... 8 (Ylitie, Karras,
// Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"). To
// replace the child with the largest surface by its own two until there are 8 was rejected: 4 to 13
// % more visits expected (mount10 9.08 and not 8.67, balls_high 4.81 and not 4.32).
//
// The top of the tree, breadth first, is made serially; the subtrees below it are first counted,
// then written to where they belong, in parallel both times. Counting costs a tenth of writing and
// saves copying a tree that was built in slots large enough for the worst case.
#include "accel/wide.h"

#include "accel/parallel.h"
#include "accel/sah.h"
#include "base/memory.h"

#include <math.h>

enum {
    SUBTREES = 64,  // shared among the workers, when there are that many
    TOP_NODES = 64, // made serially at most
};

// A block is one operation, like a visit of a node. Splitting what fits one block pays only where
// boxes without anything in between come out.
static const struct rb_bvh_leaves BLOCKS = {.block = RB_WIDE, .cost = 1.0f, .one_kind = true};

// Child `c` of a binary node.
struct slot {
    uint32_t node;
    int c;
};

// The next free index of each kind.
struct place {
    uint32_t next[RB_WIDE_KIND_COUNT];
};

// Wide nodes that a ray visits, times the surface of the root, at and below a binary node that
// takes at most 1, 2, ... children of the wide node above it.
struct visits {
    float of[RB_WIDE];
};

// A binary node that is still to be collapsed, into child `lane` of wide node `parent`.
struct open {
    uint32_t node, parent;
    int lane;
    struct place begin, end; // where it and all below it goes
};

struct job {
    const struct rb_scene *scene;
    const struct rb_bvh *bvh;
    struct visits *visits; // by binary node
    struct rb_wide *wide;  // without nodes while counting
    struct open open[1 + TOP_NODES * RB_WIDE];
    uint32_t first, last; // the open ones that are left for the workers
};

// The root of a tree of one leaf has but one child.
static bool is_there(const struct rb_bvh *bvh, struct slot slot)
{
    const struct rb_bvh_node *node = &bvh->nodes[slot.node];
    return node->bounds[0][0][slot.c] <= node->bounds[0][1][slot.c];
}

static bool is_inner(const struct rb_bvh *bvh, struct slot slot)
{
    return bvh->nodes[slot.node].count[slot.c] == 0 && is_there(bvh, slot);
}

static uint32_t inner_child(const struct rb_bvh *bvh, struct slot slot)
{
    return bvh->nodes[slot.node].child[slot.c];
}

static struct rb_box slot_box(const struct rb_bvh *bvh, struct slot slot)
{
    struct rb_box box;
    for (int k = 0; k < 3; k++) {
        box.low[k] = bvh->nodes[slot.node].bounds[k][0][slot.c];
        box.high[k] = bvh->nodes[slot.node].bounds[k][1][slot.c];
    }
    return box;
}

// Leaves are visited whatever is above them.
static float slot_visits(const struct job *job, struct slot slot, int room)
{
    return is_inner(job->bvh, slot) ? job->visits[inner_child(job->bvh, slot)].of[room - 1] : 0.0f;
}

// How many of `room` >= 2 children the first one of a binary node had best take, and what it costs.
static int share_room(const struct job *job, uint32_t node, int room, float *visits)
{
    int best = 1;
    *visits = INFINITY;
    for (int first = 1; first < room; first++) {
        float sum = slot_visits(job, (struct slot){node, 0}, first) +
                    slot_visits(job, (struct slot){node, 1}, room - first);
        if (sum < *visits)
            *visits = sum, best = first;
    }
    return best;
}

// Children come after their parents.
static void find_visits(const struct job *job)
{
    for (uint32_t node = job->bvh->node_count; node-- > 0;) {
        float *of = job->visits[node].of, below;
        struct rb_box box = slot_box(job->bvh, (struct slot){node, 0});
        struct rb_box other = slot_box(job->bvh, (struct slot){node, 1});
        rb_box_include(&box, &other);
        share_room(job, node, RB_WIDE, &below);
        of[0] = rb_box_half_area(&box) + below;
        for (int room = 2; room <= RB_WIDE; room++) {
            share_room(job, node, room, &below);
            of[room - 1] = rb_min(below, of[room - 2]);
        }
    }
}

// What takes the place of a binary node in `room` children of a wide node; returns the new count.
static int gather(const struct job *job, uint32_t node, int room, struct slot slots[RB_WIDE],
                  int count)
{
    float visits;
    int first = share_room(job, node, room, &visits);
    for (int c = 0; c < 2; c++) {
        struct slot slot = {node, c};
        int rest = c == 0 ? first : room - first;
        while (rest > 1 && slot_visits(job, slot, rest - 1) == slot_visits(job, slot, rest))
            rest--;
        if (rest > 1)
            count = gather(job, inner_child(job->bvh, slot), rest, slots, count);
        else if (is_there(job->bvh, slot))
            slots[count++] = slot;
    }
    return count;
}

static void write_spheres(const struct job *job, const uint32_t *ids, uint32_t count,
                          struct rb_wide_spheres *block)
{
    for (uint32_t lane = 0; lane < RB_WIDE; lane++) {
        const struct rb_sphere *sphere = lane < count ? &job->scene->spheres[ids[lane]] : NULL;
        for (int k = 0; k < 3; k++)
            block->center[k][lane] = sphere ? sphere->center[k] : NAN;
        block->radius[lane] = sphere ? sphere->radius : NAN;
    }
}

static void write_triangles(const struct job *job, const uint32_t *ids, uint32_t count,
                            struct rb_wide_triangles *block)
{
    uint32_t first = job->scene->first[RB_TRIANGLE];
    for (uint32_t lane = 0; lane < RB_WIDE; lane++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                block->v[i][k][lane] =
                    lane < count ? job->scene->triangles[ids[lane] - first].v[i][k] : NAN;
}

static void write_ids(const uint32_t *ids, uint32_t count, uint32_t to[RB_WIDE])
{
    for (uint32_t lane = 0; lane < RB_WIDE; lane++)
        to[lane] = lane < count ? ids[lane] : RB_NONE;
}

// Makes a leaf of a slot.
static rb_wide_child make_leaf(const struct job *job, struct slot slot, struct place *place)
{
    const struct rb_bvh_node *node = &job->bvh->nodes[slot.node];
    const uint32_t *ids = job->bvh->refs + node->child[slot.c];
    uint32_t count = node->count[slot.c];
    enum rb_kind of = rb_scene_kind(job->scene, ids[0]);
    enum rb_wide_kind kind = of == RB_SPHERE     ? RB_WIDE_SPHERES
                             : of == RB_TRIANGLE ? RB_WIDE_TRIANGLES
                                                 : RB_WIDE_OTHERS;
    uint32_t index = place->next[kind]++;
    if (job->wide->nodes && kind == RB_WIDE_SPHERES) {
        write_spheres(job, ids, count, &job->wide->spheres[index]);
        write_ids(ids, count, job->wide->spheres[index].id);
    } else if (job->wide->nodes && kind == RB_WIDE_TRIANGLES) {
        write_triangles(job, ids, count, &job->wide->triangles[index]);
        write_ids(ids, count, job->wide->triangles[index].id);
    } else if (job->wide->nodes) {
        write_ids(ids, count, job->wide->others[index].id);
    }
    return (uint32_t)kind << RB_WIDE_KIND_SHIFT | index;
}

// Boxes and leaves of node `index`; its inner children come later.
static void make_node(const struct job *job, uint32_t index, const struct slot slots[RB_WIDE],
                      int count, struct place *place)
{
    struct rb_wide_node node = {.count = (uint32_t)count};
    for (int lane = 0; lane < RB_WIDE; lane++) {
        struct rb_box box = lane < count ? slot_box(job->bvh, slots[lane]) : RB_BOX_EMPTY;
        for (int k = 0; k < 3; k++) {
            node.bounds[k][0][lane] = box.low[k];
            node.bounds[k][1][lane] = box.high[k];
        }
        if (lane < count && !is_inner(job->bvh, slots[lane]))
            node.child[lane] = make_leaf(job, slots[lane], place);
    }
    if (job->wide->nodes)
        job->wide->nodes[index] = node;
}

// Everything from binary node `from` on down, depth first; returns the index of its wide node.
static uint32_t make_subtree(const struct job *job, uint32_t from, struct place *place)
{
    struct slot slots[RB_WIDE];
    int count = gather(job, from, RB_WIDE, slots, 0);
    uint32_t index = place->next[RB_WIDE_NODE]++;
    make_node(job, index, slots, count, place);
    for (int lane = 0; lane < count; lane++) {
        if (!is_inner(job->bvh, slots[lane]))
            continue;
        uint32_t child = make_subtree(job, inner_child(job->bvh, slots[lane]), place);
        if (job->wide->nodes)
            job->wide->nodes[index].child[lane] = child;
    }
    return index;
}

static void link_parent(const struct job *job, const struct open *open, uint32_t index)
{
    if (job->wide->nodes && index > 0)
        job->wide->nodes[open->parent].child[open->lane] = index;
}

// The top of the tree; what stays open has the places that it got when it was counted.
static void make_top(struct job *job, struct place *place)
{
    uint32_t first = 0, last = 1;
    job->open[0].node = 0;
    while (first < last && last - first < SUBTREES && first < TOP_NODES) {
        struct slot slots[RB_WIDE];
        int count = gather(job, job->open[first].node, RB_WIDE, slots, 0);
        uint32_t index = place->next[RB_WIDE_NODE]++;
        make_node(job, index, slots, count, place);
        link_parent(job, &job->open[first++], index);
        for (int lane = 0; lane < count; lane++)
            if (is_inner(job->bvh, slots[lane])) {
                struct open *open = &job->open[last++];
                open->node = inner_child(job->bvh, slots[lane]);
                open->parent = index;
                open->lane = lane;
            }
    }
    job->first = first, job->last = last;
}

static void subtree_step(const void *of, uint32_t i)
{
    const struct job *job = of;
    struct open *open = (struct open *)&job->open[job->first + i];
    open->end = open->begin;
    link_parent(job, open, make_subtree(job, open->node, &open->end));
}

// Numbers of everything, from the number that each subtree has of it.
static void assign_places(struct job *job, const struct place *top)
{
    struct place place = *top;
    for (uint32_t i = job->first; i < job->last; i++) {
        struct open *open = &job->open[i];
        for (int kind = 0; kind < RB_WIDE_KIND_COUNT; kind++) {
            open->begin.next[kind] = place.next[kind];
            place.next[kind] += open->end.next[kind];
        }
    }
    for (int kind = 0; kind < RB_WIDE_KIND_COUNT; kind++)
        job->wide->count[kind] = place.next[kind];
}

static enum rb_status allocate(struct rb_wide *wide)
{
    wide->nodes = rb_alloc(wide->count[RB_WIDE_NODE], sizeof *wide->nodes);
    wide->spheres = rb_alloc(wide->count[RB_WIDE_SPHERES], sizeof *wide->spheres);
    wide->triangles = rb_alloc(wide->count[RB_WIDE_TRIANGLES], sizeof *wide->triangles);
    wide->others = rb_alloc(wide->count[RB_WIDE_OTHERS], sizeof *wide->others);
    wide->bytes = wide->count[RB_WIDE_NODE] * sizeof *wide->nodes +
                  wide->count[RB_WIDE_SPHERES] * sizeof *wide->spheres +
                  wide->count[RB_WIDE_TRIANGLES] * sizeof *wide->triangles +
                  wide->count[RB_WIDE_OTHERS] * sizeof *wide->others;
    bool all = wide->nodes && wide->spheres && wide->triangles && wide->others;
    return all ? RB_OK : RB_FAILED;
}

static enum rb_status build(struct job *job, int threads)
{
    for (int pass = 0; pass < 2; pass++) {
        struct place top = {{0}};
        make_top(job, &top);
        rb_parallel_for(threads, job->last - job->first, subtree_step, job);
        if (pass == 0) {
            assign_places(job, &top);
            if (allocate(job->wide))
                return RB_FAILED;
        }
    }
    return RB_OK;
}

enum rb_status rb_wide_build(const struct rb_scene *scene, int threads, struct rb_wide *wide,
                             struct rb_error *error)
{
    *wide = (struct rb_wide){0};
    struct rb_bvh bvh;
    enum rb_status status = rb_bvh_build_leaves(scene, &BLOCKS, threads, &bvh, error);
    if (status || bvh.node_count == 0)
        return status;
    struct job *job = rb_alloc(1, sizeof *job);
    struct visits *visits = rb_alloc(bvh.node_count, sizeof *visits);
    status = RB_FAILED;
    if (job && visits) {
        job->scene = scene, job->bvh = &bvh, job->visits = visits, job->wide = wide;
        find_visits(job);
        status = build(job, threads);
    }
    if (status)
        rb_wide_free(wide), rb_error_memory(error, "the wide bounding volume hierarchy");
    rb_free(job);
    rb_free(visits);
    rb_bvh_free(&bvh);
    return status;
}

void rb_wide_free(struct rb_wide *wide)
{
    rb_free(wide->nodes);
    rb_free(wide->spheres);
    rb_free(wide->triangles);
    rb_free(wide->others);
    *wide = (struct rb_wide){0};
}
