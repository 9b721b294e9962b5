// Meshes whose edges and vertices are known, and rays that aim at them: grids of vertices bent into
// rough surfaces.
#ifndef TESTS_SUPPORT_MESHES_H
#define TESTS_SUPPORT_MESHES_H

#include "kernels/intersect.h"
#include "tests/support/reference.h"

enum { MESH_COUNT = 5, GRID = 48, SIDE = GRID + 1 };

// A grid of vertices; cell (x, y) is split along the diagonal from (x, y) to (x + 1, y + 1).
struct mesh {
    const char *name;
    double stretch, shift; // scales y; moves everything
    double roughness;      // of the heights, in edges
    bool ball;             // wrapped around a sphere
    float v[SIDE][SIDE][3];
};

// Mesh number 0 .. MESH_COUNT - 1.
const struct mesh *mesh_make(int which);

// Triangle 0 (lower right) or 1 (upper left) of a cell, counter-clockwise from above.
struct rb_triangle mesh_triangle(const struct mesh *mesh, int x, int y, int which);

// Triangles around an edge or a vertex, and the point aimed at.
struct joint {
    struct rb_triangle triangles[6];
    int count;
    double target[3];
};

// Where rays come from.
enum origin { EYE, LIGHT, NEAR, ORIGIN_COUNT };
extern const char *const mesh_origins[ORIGIN_COUNT];

// A ray at a vertex or an edge, rounded to single precision, around which all triangles face it the
// same way: it must hit one of them.
struct rb_ray mesh_aim(const struct mesh *mesh, struct ref_random *random, enum origin origin,
                       bool vertices, struct joint *joint);

#endif
