// The independent reference: hits, occlusion and normals in double precision from the textbook, for
// tests only. It reads the scene's arrays and shares no code with the kernels.
//
// Beside the exact answer it says how wrong another answer is, as a distance in the scene: how far
// a claimed hit point lies off the surface, or how deep a ray would have had to be moved to miss
// what it hits. Single precision displaces a ray by some ulps of the coordinates; a kernel whose
// answer needs a larger displacement is wrong, however rarely. All lengths are world units.
#ifndef TESTS_SUPPORT_REFERENCE_H
#define TESTS_SUPPORT_REFERENCE_H

#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

// A ray. `d` need not be a unit vector: t counts in lengths of d.
struct ref_ray {
    double o[3], d[3];
    uint32_t self;  // primitive it starts on, or RB_NONE
    bool shadow;    // sides do not matter, and the primitive it starts on does not exist
    bool one_sided; // opaque surfaces are hit from their front only
};

// A place where a ray crosses a primitive.
struct ref_hit {
    double t;         // HUGE_VAL for a miss
    double normal[3]; // geometric, unit, outward
    double cosine;    // |normal . d| / |d|
    double clearance; // distance from the crossing to a line that would miss the primitive
    uint32_t prim;    // RB_NONE for a miss
};

// A scene with a tree of its own (median splits, double boxes), which a test compares with brute
// force. Release with ref_world_free.
struct ref_node {
    double low[3], high[3];
    uint32_t first, count; // count > 0: leaf of refs[first ..]; else children first and first + 1
};
struct ref_world {
    const struct rb_scene *scene;
    struct ref_node *nodes;
    uint32_t *refs;
    uint32_t node_count;
};
bool ref_world_build(const struct rb_scene *scene, struct ref_world *world);
void ref_world_free(struct ref_world *world);

// Crossings of one primitive at t > 0 that the ray can see, at most two, unordered.
int ref_crossings(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                  struct ref_hit hits[2]);

// Closest crossing; ties go to the lowest primitive id. The second one uses the tree.
struct ref_hit ref_closest_brute(const struct rb_scene *scene, const struct ref_ray *ray);
struct ref_hit ref_closest(const struct ref_world *world, const struct ref_ray *ray);

// Is anything crossed at 0 < t < distance?
bool ref_occluded(const struct ref_world *world, const struct ref_ray *ray, double distance);

// Does the curved opaque primitive that the ray starts on stand in its own light? One of its
// crossings is the start; is the other one at 0 < t < distance? By the norm glass never does.
bool ref_shadows_itself(const struct rb_scene *scene, const struct ref_ray *ray, double distance);

// How deep the ray crosses something it should not cross if nothing lies before `distance`: the
// largest over all crossings of the smallest displacement that would undo it. 0 if there is none.
double ref_depth_before(const struct rb_scene *scene, const struct ref_ray *ray, double distance);

// Distance of point `p` from the surface of a primitive.
double ref_distance(const struct rb_scene *scene, uint32_t prim, const double p[3]);

// How far ray and surface would have to be moved for a hit on `prim` at `t` to be exact: the
// distance of the point from the surface; of a triangle, the distance of the point from its plane
// or of the line from its inside, whichever is larger (so a triangle seen edge-on may be hit
// anywhere).
double ref_off(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray, double t);

// Smallest distance between any primitive (but the ray's own) and the piece 0 <= t <= distance of
// the ray: how far the ray must be moved for an occlusion to be true.
double ref_gap_before(const struct rb_scene *scene, const struct ref_ray *ray, double distance);

// Outward unit shading normal at point `p` of a primitive, interpolated on smooth triangles.
void ref_normal(const struct rb_scene *scene, uint32_t prim, const double p[3], double normal[3]);

// Largest coordinate of a primitive's box (of the point nearest to the origin for a plane): the
// unit of its rounding errors, times 2^-24.
double ref_reach(const struct rb_scene *scene, uint32_t prim);

// Vectors.
double ref_dot(const double a[3], const double b[3]);
double ref_length(const double a[3]);
void ref_cross(const double a[3], const double b[3], double out[3]);
void ref_along(const double o[3], double t, const double d[3], double out[3]); // o + t d
bool ref_normalize(double a[3]);
void ref_subtract(const double a[3], const double b[3], double out[3]);
void ref_widen(const float a[3], double out[3]);
void ref_edge(const float a[3], const float b[3], double out[3]); // b - a

// Random numbers: splitmix64.
struct ref_random {
    uint64_t state;
};
double ref_uniform(struct ref_random *random); // [0, 1)
double ref_between(struct ref_random *random, double low, double high);
uint32_t ref_below(struct ref_random *random, uint32_t limit);
void ref_direction(struct ref_random *random, double d[3]); // uniform on the sphere

#endif
