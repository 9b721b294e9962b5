// Cuts a planar polygon with any number of vertices, concave or not, into triangles.
#ifndef RB_SCENE_POLYGON_H
#define RB_SCENE_POLYGON_H

#include "base/memory.h"
#include "base/status.h"

#include <stdint.h>

// Result and working memory, kept from one polygon to the next. Zero-initialise before the first.
struct rb_polygon {
    struct rb_array triangles; // uint32_t[3]: indices of vertices, oriented like the polygon
    struct rb_array vertices, queue, slots, nodes; // working memory
    uint64_t steps;                                // of work, over all polygons so far
};

// Triangulates the polygon through `vertex` into polygon->triangles, at most count - 2 of them;
// none if it has no area. A polygon that crosses itself gives some triangles over roughly its area.
//
// Takes O(n log n) steps for what programs draw, O(n sqrt n) for a million random spikes, and up to
// O(n^2) for tangles: RB_INVALID with a text once all polygons together have taken
// RB_POLYGON_STEPS_MAX. RB_FAILED without memory.
enum rb_status rb_polygon_triangulate(struct rb_polygon *polygon, const double (*vertex)[3],
                                      uint32_t count, struct rb_error *error);

void rb_polygon_release(struct rb_polygon *polygon);

// Under a minute at the 11 ns a step was measured to take in a polygon of a million vertices.
#define RB_POLYGON_STEPS_MAX (UINT64_C(1) << 32)

#endif
