// Binary bounding volume hierarchy over the bounded primitives of a scene, built top-down with the
// binned surface area heuristic (Wald 2007, "On fast construction of SAH-based bounding volume
// hierarchies"). The tree is a function of the scene alone: the number of threads that build it
// does not change a byte.
#ifndef RB_ACCEL_BVH_H
#define RB_ACCEL_BVH_H

#include "base/status.h"
#include "scene/scene.h"

#include <stddef.h>
#include <stdint.h>

// An inner node holds the boxes of its two children, so that one cache line decides which of them
// are visited. Child c is a leaf of count[c] primitives, refs[child[c]] onwards, or, where count[c]
// is 0, node child[c]. A missing child has an empty box (low > high), which no ray passes.
struct rb_bvh_node {
    float bounds[3][2][2]; // [axis][0 low, 1 high][child]
    uint32_t child[2];
    uint32_t count[2];
};

// Levels below the root; traversal stacks need one entry each. The builder stops trusting the
// heuristic at depth 48 and halves, which ends 32 levels later at the latest.
enum { RB_BVH_DEPTH_MAX = 80 };

struct rb_bvh {
    struct rb_bvh_node *nodes; // root first, children after their parents; none in an empty scene
    uint32_t *refs;            // primitive ids, each bounded primitive once
    uint32_t node_count, ref_count;
    size_t bytes;
};

// What the leaves of a tree are for: how many primitives, `block`, are tested at once, what that
// costs relative to a visit of an inner node, and whether a leaf must be of one kind. A leaf of
// more than one primitive has at most RB_BVH_LEAF_MAX.
enum { RB_BVH_LEAF_MAX = 8 };
struct rb_bvh_leaves {
    uint32_t block;
    float cost;
    bool one_kind;
};

// rb_bvh_build with leaves of another sort than those of one primitive at a time.
enum rb_status rb_bvh_build_leaves(const struct rb_scene *scene, const struct rb_bvh_leaves *leaves,
                                   int threads, struct rb_bvh *bvh, struct rb_error *error);

// `threads` >= 1 workers. Fails only without memory. Release with rb_bvh_free.
enum rb_status rb_bvh_build(const struct rb_scene *scene, int threads, struct rb_bvh *bvh,
                            struct rb_error *error);
void rb_bvh_free(struct rb_bvh *bvh);

#endif
