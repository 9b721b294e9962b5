// Private to the triangulation: the polygon as a ring in the plane, and a uniform grid that answers
// whether a triangle is free of reflex vertices.
#ifndef RB_SCENE_POLYGON_GRID_H
#define RB_SCENE_POLYGON_GRID_H

#include "base/memory.h"

#include <stdbool.h>
#include <stdint.h>

// A vertex, and its place in the ring of those not yet cut off.
struct rb_ring_vertex {
    double x, y;
    uint32_t prev, next;
    uint32_t round; // in which a neighbour was last cut off
    bool gone, queued, reflex;
};

// Where a vertex may lie without keeping a triangle from being an ear.
enum rb_ring_rule {
    RB_RING_STRICT,  // not inside and not on its edges
    RB_RING_LENIENT, // not inside
};

// Every reflex vertex in the cell it lies in. Those that become convex are swept out when a
// question meets them.
struct rb_polygon_grid {
    const struct rb_ring_vertex *vertices;
    double low[2], scale[2], slack[2];
    int size[2];
    struct rb_grid_cell {
        uint32_t first, count; // of the blockers
    } * cells;
    uint32_t *blockers; // vertex indices, cell by cell
    uint64_t steps;     // cells and vertices looked at so far
};

// Twice the area of the triangle, positive if counter-clockwise.
static inline double rb_ring_area(const struct rb_ring_vertex *a, const struct rb_ring_vertex *b,
                                  const struct rb_ring_vertex *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

// Sorts the reflex ones among `count` vertices, `reflex_count` of them, into the grid; `cells` and
// `blockers` lend the memory. False without memory.
bool rb_polygon_grid_fill(struct rb_polygon_grid *grid, const struct rb_ring_vertex *vertices,
                          uint32_t count, uint32_t reflex_count, struct rb_array *cells,
                          struct rb_array *blockers);

// Whether some reflex vertex keeps the counter-clockwise triangle from being an ear.
bool rb_polygon_grid_blocks(struct rb_polygon_grid *grid,
                            const struct rb_ring_vertex *const triangle[3], enum rb_ring_rule rule);

#endif
