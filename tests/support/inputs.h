// Random inputs of the kernels: everything a kernel may meet, most of it more often than in images.
#ifndef TESTS_SUPPORT_INPUTS_H
#define TESTS_SUPPORT_INPUTS_H

#include "tests/support/guard.h"
#include "tests/support/ray_classes.h"

// Pixels of the test film; pixels of rays are below, those of shadow rays are not.
enum { FILM_EDGE = 16, FILM_PIXELS = FILM_EDGE * FILM_EDGE };

// Most elements of a batch. The lowest bits of the path of a ray, and of the pixel of a surface,
// are its index, so that what became of it can be told.
enum { INPUT_MAX = 1024 };

// A batch of `count` rays: camera rays of one class, of all classes mixed, or close to each other;
// with `twist` some have zeros, denormals, NaNs, infinities, and start on any primitive. Without
// classes (NULL) from anywhere to anywhere. Counts from 0 on.
const char *input_rays(struct ref_random *random, const struct rb_scene *scene,
                       const struct ray_class *classes, uint32_t count, struct rb_rays *rays);

// New weights, pixels, paths and media.
void input_stamp_rays(struct ref_random *random, const struct rb_scene *scene,
                      struct rb_rays *rays);

// Turns some hits into misses or into hits on any primitive.
void input_twist_hits(struct ref_random *random, const struct rb_scene *scene,
                      const struct rb_rays *rays, struct rb_hits *hits);

// Gives all surfaces a pixel of their own, and turns some towards or away from the light.
void input_twist_surfaces(struct ref_random *random, const struct rb_light *light,
                          struct rb_surfaces *surfaces);

// Shadow rays along `rays` that end about where these hit something.
void input_shadows(struct ref_random *random, const struct rb_rays *rays,
                   const struct rb_hits *hits, struct rb_shadows *shadows);

// An image and a piece of it of `width` columns and at most INPUT_MAX pixels.
void input_view(struct ref_random *random, int width, struct rb_view *view, struct rb_span *span);

struct rb_shading input_shading(struct ref_random *random, const struct rb_scene *scene,
                                struct rb_light_sample *sample);

#endif
