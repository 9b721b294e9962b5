// Reader of NFF, the Neutral File Format (Eric Haines, 1987; document 3.9 of 1996), with the plane
// `pl` (old spelling `gpl`) of the Lisbon course files. Streams: time and memory are linear in the
// file, and memory is that of the scene plus one polygon.
#ifndef RB_SCENE_NFF_H
#define RB_SCENE_NFF_H

#include "base/status.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdio.h>

struct rb_nff_options {
    bool strict; // an unknown keyword is an error instead of a warning
    // Called for each warning, with its place and text; may be NULL.
    void (*warn)(void *user, const struct rb_error *warning);
    void *user;
};

// Reads a whole scene from `stream`; `name` is for messages. On failure `error` holds the place and
// the reason and `scene` is empty. A malformed file gives RB_INVALID.
enum rb_status rb_nff_read(FILE *stream, const char *name, const struct rb_nff_options *options,
                           struct rb_scene *scene, struct rb_error *error);

#endif
