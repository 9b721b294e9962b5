#include "scene/polygon_tree.h"

#include <math.h>
#include <stdlib.h>

enum { LEAF_SIZE = 8 };

struct rb_tree_slot {
    uint64_t key; // place along the curve
    uint32_t vertex;
};

struct rb_tree_node {
    double low[2], high[2];
    uint32_t live; // vertices below that are still reflex
};

// Spreads the bits of x to the even places of the result.
static uint64_t spread(uint32_t x)
{
    uint64_t y = x;
    y = (y | y << 16) & 0x0000ffff0000ffffu;
    y = (y | y << 8) & 0x00ff00ff00ff00ffu;
    y = (y | y << 4) & 0x0f0f0f0f0f0f0f0fu;
    y = (y | y << 2) & 0x3333333333333333u;
    return (y | y << 1) & 0x5555555555555555u;
}

// Where x is between low and high, in 2^32 steps. What is not a number goes to 0.
static uint32_t quantize(double x, double low, double high)
{
    double part = (x - low) / (high - low) * 4294967295.0;
    return part > 0.0 ? (uint32_t)(part < 4294967295.0 ? part : 4294967295.0) : 0;
}

static int compare_slots(const void *a, const void *b)
{
    const struct rb_tree_slot *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

// Lists the reflex vertices along a Z curve (Morton 1966) through their bounding box.
static void sort_slots(struct rb_tree_slot *slots, struct rb_ring_vertex *v, uint32_t count)
{
    double low[2] = {v[0].x, v[0].y}, high[2] = {v[0].x, v[0].y};
    for (uint32_t i = 1; i < count; i++) {
        low[0] = fmin(low[0], v[i].x);
        low[1] = fmin(low[1], v[i].y);
        high[0] = fmax(high[0], v[i].x);
        high[1] = fmax(high[1], v[i].y);
    }
    uint32_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (v[i].reflex)
            slots[used++] = (struct rb_tree_slot){
                .key = spread(quantize(v[i].x, low[0], high[0])) |
                       spread(quantize(v[i].y, low[1], high[1])) << 1,
                .vertex = i,
            };
    }
    qsort(slots, used, sizeof *slots, compare_slots);
    for (uint32_t i = 0; i < used; i++)
        v[slots[i].vertex].slot = i;
}

static struct rb_tree_node make_leaf(const struct rb_polygon_tree *tree, uint32_t leaf)
{
    struct rb_tree_node node = {.low = {HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL}};
    for (uint32_t i = leaf * LEAF_SIZE; i < tree->slot_count && i < (leaf + 1) * LEAF_SIZE; i++) {
        const struct rb_ring_vertex *v = &tree->vertices[tree->slots[i].vertex];
        node.low[0] = fmin(node.low[0], v->x);
        node.low[1] = fmin(node.low[1], v->y);
        node.high[0] = fmax(node.high[0], v->x);
        node.high[1] = fmax(node.high[1], v->y);
        node.live++;
    }
    return node;
}

static struct rb_tree_node join(const struct rb_tree_node *a, const struct rb_tree_node *b)
{
    struct rb_tree_node node = {.live = a->live + b->live};
    for (int k = 0; k < 2; k++) {
        node.low[k] = fmin(a->low[k], b->low[k]);
        node.high[k] = fmax(a->high[k], b->high[k]);
    }
    return node;
}

bool rb_polygon_tree_build(struct rb_polygon_tree *tree, struct rb_ring_vertex *vertices,
                           uint32_t count, uint32_t reflex_count, struct rb_array *slots,
                           struct rb_array *nodes)
{
    tree->vertices = vertices;
    tree->slot_count = reflex_count;
    tree->leaf_count = 1;
    while ((uint64_t)tree->leaf_count * LEAF_SIZE < reflex_count)
        tree->leaf_count *= 2;
    size_t node_count = 2 * (size_t)tree->leaf_count - 1;
    if (!rb_array_reserve(slots, reflex_count, sizeof *tree->slots) ||
        !rb_array_reserve(nodes, node_count, sizeof *tree->nodes))
        return false;
    sort_slots(slots->data, vertices, count);
    tree->slots = slots->data;
    tree->nodes = nodes->data;
    for (uint32_t i = 0; i < tree->leaf_count; i++)
        tree->nodes[tree->leaf_count - 1 + i] = make_leaf(tree, i);
    for (uint32_t i = tree->leaf_count - 1; i-- > 0;)
        tree->nodes[i] = join(&tree->nodes[2 * i + 1], &tree->nodes[2 * i + 2]);
    return true;
}

void rb_polygon_tree_remove(struct rb_polygon_tree *tree, uint32_t slot)
{
    uint32_t node = tree->leaf_count - 1 + slot / LEAF_SIZE;
    for (; node > 0; node = (node - 1) / 2)
        tree->nodes[node].live--;
    tree->nodes[0].live--;
}

// Whether the box lies beyond one edge of the triangle, and so outside. The corner that is farthest
// to the left of the edge decides; since rounding is monotone, no vertex in the box can compute as
// farther left than that corner does.
static bool outside(const struct rb_tree_node *node, const struct rb_ring_vertex *const t[3])
{
    for (int i = 0; i < 3; i++) {
        const struct rb_ring_vertex *a = t[i], *b = t[(i + 1) % 3];
        struct rb_ring_vertex corner = {
            .x = b->y > a->y ? node->low[0] : node->high[0],
            .y = b->x > a->x ? node->high[1] : node->low[1],
        };
        if (rb_ring_area(a, b, &corner) < 0.0)
            return true;
    }
    return node->high[0] < fmin(t[0]->x, fmin(t[1]->x, t[2]->x)) ||
           node->low[0] > fmax(t[0]->x, fmax(t[1]->x, t[2]->x)) ||
           node->high[1] < fmin(t[0]->y, fmin(t[1]->y, t[2]->y)) ||
           node->low[1] > fmax(t[0]->y, fmax(t[1]->y, t[2]->y));
}

static bool same(const struct rb_ring_vertex *a, const struct rb_ring_vertex *b)
{
    return a->x == b->x && a->y == b->y;
}

// A vertex in the same place as a corner does not block: it belongs to an outline that touches
// itself there, or to a hole that a doubled edge joins to it.
static bool vertex_blocks(const struct rb_ring_vertex *p, const struct rb_ring_vertex *const t[3],
                          enum rb_ring_rule rule)
{
    if (!p->reflex || p == t[0] || p == t[1] || p == t[2])
        return false;
    double ab = rb_ring_area(t[0], t[1], p);
    double bc = rb_ring_area(t[1], t[2], p);
    double ca = rb_ring_area(t[2], t[0], p);
    if (rule != RB_RING_STRICT)
        return ab > 0.0 && bc > 0.0 && ca > 0.0;
    return ab >= 0.0 && bc >= 0.0 && ca >= 0.0 && !same(p, t[0]) && !same(p, t[1]) &&
           !same(p, t[2]);
}

static bool leaf_blocks(struct rb_polygon_tree *tree, uint32_t leaf,
                        const struct rb_ring_vertex *const t[3], enum rb_ring_rule rule)
{
    uint32_t first = leaf * LEAF_SIZE, end = first + LEAF_SIZE;
    for (uint32_t i = first; i < end && i < tree->slot_count; i++) {
        tree->steps++;
        if (vertex_blocks(&tree->vertices[tree->slots[i].vertex], t, rule))
            return true;
    }
    return false;
}

static bool node_blocks(struct rb_polygon_tree *tree, uint32_t node,
                        const struct rb_ring_vertex *const t[3], enum rb_ring_rule rule)
{
    tree->steps++;
    if (tree->nodes[node].live == 0 || outside(&tree->nodes[node], t))
        return false;
    if (node >= tree->leaf_count - 1)
        return leaf_blocks(tree, node - (tree->leaf_count - 1), t, rule);
    return node_blocks(tree, 2 * node + 1, t, rule) || node_blocks(tree, 2 * node + 2, t, rule);
}

bool rb_polygon_tree_blocks(struct rb_polygon_tree *tree,
                            const struct rb_ring_vertex *const triangle[3], enum rb_ring_rule rule)
{
    return node_blocks(tree, 0, triangle, rule);
}
