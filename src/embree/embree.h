// Embree, Intel's ray tracing kernels, as a yardstick: its tree over a scene and kernel sets that
// trace through it (https://www.embree.org; version 3). Part of a build that finds the library;
// without it rb_embree_version is NULL and nothing here can be called.
//
// Its answers are not those of the norm (kernel.h): other triangle and sphere tests, no own box,
// ties as they fall. Rays that leave a primitive start `epsilon` ahead instead of excluding it by
// its id; user-geometry spheres do exclude it, native
// ones from shadow rays. Planes are tested outside of its tree, before it.
#ifndef RB_EMBREE_EMBREE_H
#define RB_EMBREE_EMBREE_H

#include "kernels/kernel.h"

#include "base/status.h"

// How a tree is built.
struct rb_embree_tree {
    bool high;       // build quality HIGH, with spatial splits, instead of MEDIUM
    bool native;     // spheres are its own points instead of user geometry with our SIMD test
    const char *isa; // most it may use, "avx2"; NULL: all there is
};

struct rb_embree;

// "3.13.5", of the library linked with; NULL if there is none.
const char *rb_embree_version(void);

// What a build took and what tracing reads: the tree, and arrays of the scene that it refers to.
struct rb_embree_cost {
    uint64_t build_ns; // of committing the scene, without copying the triangles
    size_t bytes;      // as Embree's memory monitor counts them, plus the spheres of the scene
};

// Builds a tree with `threads` threads. The scene must outlive it. RB_FAILED if Embree cannot.
// Release with rb_embree_free. Tracing is thread-safe, building is not.
enum rb_status rb_embree_build(const struct rb_scene *scene, const struct rb_embree_tree *how,
                               int threads, struct rb_embree **embree, struct rb_embree_cost *cost,
                               struct rb_error *error);
void rb_embree_free(struct rb_embree *embree); // accepts NULL

// Ways to trace: single rays; packets as wide as the vectors; streams (rtcIntersect1M). Streams and
// packets may be told that their rays are coherent. Shadow rays may run from the point or from the
// light.
enum rb_embree_way {
    RB_EMBREE_SINGLE,
    RB_EMBREE_PACKET,
    RB_EMBREE_PACKET_COHERENT,
    RB_EMBREE_STREAM,
    RB_EMBREE_STREAM_COHERENT,
    RB_EMBREE_WAY_COUNT
};

// Kernel sets by way and direction of shadow rays: [0] from the point, [1] from the light. One
// source, an object per instruction set: packets of 8 and of 16.
extern const struct rb_kernels rb_embree_avx2[RB_EMBREE_WAY_COUNT][2];
extern const struct rb_kernels rb_embree_avx512[RB_EMBREE_WAY_COUNT][2];

#endif
