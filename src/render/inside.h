// The renderer from inside. Private to render/.
#ifndef RB_RENDER_INSIDE_H
#define RB_RENDER_INSIDE_H

#include "accel/bvh.h"
#include "accel/wide.h"
#include "render/frame.h"

struct rb_renderer {
    const struct rb_variant *variant;
    struct rb_frame frame;
    struct rb_worker *workers;
    struct rb_bvh bvh; // one of these three, or none
    struct rb_wide wide;
    struct rb_embree *embree;
    size_t embree_bytes;
    uint64_t build_ns;
};

void rb_film_clear(struct rb_film *film);

// Linear value of component `index` of the film, averaged over the AA samples.
float rb_film_value(const struct rb_frame *frame, size_t index);

#endif
