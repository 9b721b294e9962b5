// Small scenes with everything that makes two ways to the same answer differ: coincident
// primitives, shared edges, boxes without volume, every kind of material.
#ifndef TESTS_SUPPORT_ZOO_H
#define TESTS_SUPPORT_ZOO_H

#include "tests/support/ray_classes.h"

void stage_zoo(struct stage *stage);    // all kinds of primitives
void stage_planes(struct stage *stage); // no tree
void stage_empty(struct stage *stage);  // nothing at all

// These and those of ray_classes.h, with the rays to send through them: NULL for any.
struct zoo_scene {
    const char *name;
    const struct ray_class *classes;
    struct stage stage;
    uint32_t weight; // how often it is worth a look
};
enum { ZOO_COUNT = 7, ZOO_WEIGHTS = 16 };
void zoo_open(struct zoo_scene scenes[ZOO_COUNT]);
void zoo_close(struct zoo_scene scenes[ZOO_COUNT]);

#endif
