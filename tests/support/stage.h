// A scene with everything that traces it, for tests that compare the kernels with the reference.
#ifndef TESTS_SUPPORT_STAGE_H
#define TESTS_SUPPORT_STAGE_H

#include "accel/bvh.h"
#include "accel/wide.h"
#include "base/vec.h"
#include "kernels/kernel.h"
#include "scene/load.h"
#include "tests/support/reference.h"

struct stage {
    struct rb_scene scene;
    struct rb_bvh bvh;
    struct rb_wide wide;
    struct rb_world world; // all of them, two-sided; the stage must not move
    struct ref_world reference;
};

// From what was added to the builder, or by name. Release with stage_close.
void stage_build(struct stage *stage, struct rb_scene_builder *builder);
void stage_load(struct stage *stage, const char *name);
void stage_close(struct stage *stage);

// Ends the test program.
_Noreturn void stage_give_up(const char *what);

// Gives up unless RB_OK; for calls that report to stage_failure.
void stage_check(enum rb_status status);
extern struct rb_error stage_failure;

// Appends a ray as a camera would.
void stage_push(struct rb_rays *rays, struct rb_vec o, struct rb_vec d);

// Ray i of the queue, for the reference.
struct ref_ray stage_ray(const struct rb_rays *rays, uint32_t i);

#endif
