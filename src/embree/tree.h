// What the files of this folder share. Private to embree/.
#ifndef RB_EMBREE_TREE_H
#define RB_EMBREE_TREE_H

#include "embree/embree.h"

#if RB_EMBREE

#include <embree3/rtcore.h>
#include <stdatomic.h>

// The geometries of the scene have the ids of their kinds: RB_SPHERE, RB_TRIANGLE, RB_CONE.
struct rb_embree {
    RTCDevice device;
    RTCScene scene;
    const struct rb_scene *source;
    float epsilon; // where rays that leave a primitive start
    atomic_llong bytes;
};

// User geometry: a scene's spheres, eight rays at a time, and its cones, one by one (callbacks.c).
// The user pointer is the struct rb_scene; RTCRay.id is the primitive a ray starts on.
void rb_embree_spheres_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rb_embree_spheres_occluded(const struct RTCOccludedFunctionNArguments *arguments);
void rb_embree_spheres_filter(const struct RTCFilterFunctionNArguments *arguments); // native ones
void rb_embree_cones_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rb_embree_cones_occluded(const struct RTCOccludedFunctionNArguments *arguments);

#endif
#endif
