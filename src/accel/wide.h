// Bounding volume hierarchy with up to 8 children a node, whose boxes one vector operation tests,
// and leaves whose primitives lie side by side for the same purpose. Collapsed from the binary
// tree (Wald, Benthin, Boulos 2008, "Getting rid of packets"; Dammertz, Hanika, Keller 2008,
// "Shallow bounding volume hierarchies"). A function of the scene alone, as the binary tree is.
#ifndef RB_ACCEL_WIDE_H
#define RB_ACCEL_WIDE_H

#include "accel/bvh.h"
#include "base/status.h"
#include "scene/scene.h"

#include <stddef.h>
#include <stdint.h>

enum { RB_WIDE = 8 };

// What a child is; a leaf is one block of primitives.
enum rb_wide_kind {
    RB_WIDE_NODE,
    RB_WIDE_SPHERES,
    RB_WIDE_TRIANGLES,
    RB_WIDE_OTHERS, // cones
    RB_WIDE_KIND_COUNT,
};

// Kind of a child and its index in the array of that kind.
typedef uint32_t rb_wide_child;
enum { RB_WIDE_KIND_SHIFT = 30 };

// Children fill the lanes from 0 on; missing ones have empty boxes, which no ray passes, and are
// node 0. 256 bytes, four cache lines.
struct rb_wide_node {
    float bounds[3][2][RB_WIDE]; // [axis][0 low, 1 high][child]
    rb_wide_child child[RB_WIDE];
    uint32_t count; // of children
    uint32_t unused[RB_WIDE - 1];
};

// Blocks: primitives as the scene has them, lane by lane; missing ones have the id RB_NONE, a
// radius that is NaN, and corners that are NaN, so that no test of theirs comes true.
struct rb_wide_spheres {
    float center[3][RB_WIDE], radius[RB_WIDE];
    uint32_t id[RB_WIDE];
};

struct rb_wide_triangles {
    float v[3][3][RB_WIDE]; // [vertex][axis][lane]
    uint32_t id[RB_WIDE];
};

struct rb_wide_others {
    uint32_t id[RB_WIDE];
};

struct rb_wide {
    struct rb_wide_node *nodes; // root first, children after their parents; none in an empty scene
    struct rb_wide_spheres *spheres;
    struct rb_wide_triangles *triangles;
    struct rb_wide_others *others;
    uint32_t count[RB_WIDE_KIND_COUNT]; // nodes, and blocks of each kind
    size_t bytes;
};

// Entries that the stack of a traversal needs at most: a level leaves all children but one on it.
enum { RB_WIDE_STACK = (RB_WIDE - 1) * RB_BVH_DEPTH_MAX + 2 };

static inline enum rb_wide_kind rb_wide_kind_of(rb_wide_child child)
{
    return (enum rb_wide_kind)(child >> RB_WIDE_KIND_SHIFT);
}

static inline uint32_t rb_wide_index_of(rb_wide_child child)
{
    return child & ((1u << RB_WIDE_KIND_SHIFT) - 1);
}

// The primitives of a leaf.
static inline const uint32_t *rb_wide_ids(const struct rb_wide *wide, rb_wide_child leaf)
{
    uint32_t index = rb_wide_index_of(leaf);
    enum rb_wide_kind kind = rb_wide_kind_of(leaf);
    return kind == RB_WIDE_SPHERES     ? wide->spheres[index].id
           : kind == RB_WIDE_TRIANGLES ? wide->triangles[index].id
                                       : wide->others[index].id;
}

// Asks the caches for a child that will be visited.
static inline void rb_wide_prefetch(const struct rb_wide *wide, rb_wide_child child)
{
    uint32_t index = rb_wide_index_of(child);
    enum rb_wide_kind kind = rb_wide_kind_of(child);
    const char *at = kind == RB_WIDE_NODE      ? (const char *)&wide->nodes[index]
                     : kind == RB_WIDE_SPHERES ? (const char *)&wide->spheres[index]
                                               : (const char *)&wide->triangles[index];
    for (int i = 0; i < (kind == RB_WIDE_TRIANGLES ? 5 : 4); i++)
        __builtin_prefetch(at + 64 * i);
}

// `threads` >= 1 workers. Fails only without memory. Release with rb_wide_free.
enum rb_status rb_wide_build(const struct rb_scene *scene, int threads, struct rb_wide *wide,
                             struct rb_error *error);
void rb_wide_free(struct rb_wide *wide);

#endif
