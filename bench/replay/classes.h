// Rays beyond the image's own, one from every primary hit, for comparing tracers on the same rays:
//
//   diffuse     cosine-random directions around the shading normal (Malley's method: up from a
//               random point of the unit disc), random numbers hashed from seed, pixel and sample
//   reflection  mirrored, whatever the material
//   refraction  into a medium of index 1.2, or out of one; on total reflection there is no ray
//   shadow      to the centre of light 0, from the side of the surface that faces it; none in a
//               scene without lights
//
// They start where secondary rays do, off the surface by the offsets of kernels/shade.h, and their
// own primitive is the one that was hit. Batches hold the rays of one batch of camera rays, in its
// order. Bounce 1, but for shadow rays: bounce 0.
#ifndef RB_REPLAY_CLASSES_H
#define RB_REPLAY_CLASSES_H

#include "bench/replay/record_file.h"

// Empty batches of the kinds of the classes, with room for the children of `count` rays; those of
// classes that are not wanted have no memory.
struct rb_class_batches {
    struct rb_batch of[RB_CLASS_COUNT];
};

// `wanted` by class; the image has none. Release with rb_class_batches_free, whatever the outcome.
enum rb_status rb_class_batches_alloc(struct rb_class_batches *batches,
                                      const bool wanted[RB_CLASS_COUNT], uint32_t count,
                                      struct rb_error *error);
void rb_class_batches_free(struct rb_class_batches *batches);

// Fills the batch of a class from a batch of camera rays with hits. Hits of the new rays, and
// answers of shadow rays, are not known yet.
void rb_class_spawn(enum rb_ray_class ray_class, const struct rb_scene *scene, uint64_t seed,
                    const struct rb_batch *camera, struct rb_batch *out);

#endif
