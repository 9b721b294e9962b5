// Private to the triangulation: the polygon as a ring in the plane, and a tree that answers whether
// a triangle is free of reflex vertices.
#ifndef RB_SCENE_POLYGON_TREE_H
#define RB_SCENE_POLYGON_TREE_H

#include "base/memory.h"

#include <stdbool.h>
#include <stdint.h>

// A vertex, and its place in the ring of those not yet cut off.
struct rb_ring_vertex {
    double x, y;
    uint32_t prev, next;
    uint32_t round; // in which a neighbour was last cut off
    uint32_t slot;  // in the tree, if reflex
    bool gone, queued, reflex;
};

// Where a vertex may lie without keeping a triangle from being an ear.
enum rb_ring_rule {
    RB_RING_STRICT,  // not inside and not on its edges
    RB_RING_LENIENT, // not inside
};

// Bounding boxes over runs of reflex vertices that are neighbours on a space-filling curve.
struct rb_polygon_tree {
    const struct rb_ring_vertex *vertices;
    const struct rb_tree_slot *slots; // the reflex vertices along the curve
    struct rb_tree_node *nodes;       // the children of i are 2i + 1 and 2i + 2
    uint32_t slot_count, leaf_count;  // leaf_count is a power of two; node leaf_count - 1 is first
    uint64_t steps;                   // nodes and vertices looked at so far
};

// Twice the area of the triangle, positive if counter-clockwise.
static inline double rb_ring_area(const struct rb_ring_vertex *a, const struct rb_ring_vertex *b,
                                  const struct rb_ring_vertex *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

// Builds the tree over the reflex ones among `count` vertices, `reflex_count` > 0 of them, and sets
// their slots; `slots` and `nodes` lend the memory. False without memory.
bool rb_polygon_tree_build(struct rb_polygon_tree *tree, struct rb_ring_vertex *vertices,
                           uint32_t count, uint32_t reflex_count, struct rb_array *slots,
                           struct rb_array *nodes);

// The vertex in `slot` is reflex no longer.
void rb_polygon_tree_remove(struct rb_polygon_tree *tree, uint32_t slot);

// Whether some reflex vertex keeps the counter-clockwise triangle from being an ear.
bool rb_polygon_tree_blocks(struct rb_polygon_tree *tree,
                            const struct rb_ring_vertex *const triangle[3], enum rb_ring_rule rule);

#endif
