// Rays that are meant to break the kernels, by what they aim at, and the scenes made for them.
#ifndef TESTS_SUPPORT_RAY_CLASSES_H
#define TESTS_SUPPORT_RAY_CLASSES_H

#include "tests/support/stage.h"

struct aim {
    double o[3], target[3];
};

// A random aim of a class at a scene.
typedef void aim_fn(struct ref_random *random, const struct rb_scene *scene, struct aim *aim);
aim_fn aim_random, aim_axis;

// Rounds an aim to a ray of the queue, as a camera would.
void aim_push(struct rb_rays *rays, const struct aim *aim, struct ref_random *random);

struct ray_class {
    const char *name;
    aim_fn *aim;
    int batches;
    bool one_sided, children; // children: the secondary rays of these rays instead
};

// What to send through a soup of all kinds, a mesh, spheres, a soup far from the origin, and tiny
// spheres; a class without a name ends each.
extern const struct ray_class ray_classes_soup[], ray_classes_mesh[], ray_classes_spheres[],
    ray_classes_shifted[], ray_classes_tiny[];

// All kinds of primitives, of sizes from 0.01 to 1, within about 3 of `center`.
void stage_soup(struct stage *stage, double center);

// Spheres of radius 0.001, 10 to 1000 away from `center` in all directions.
void stage_tiny(struct stage *stage, double center);

#endif
