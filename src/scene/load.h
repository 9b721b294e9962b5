// One way in for every scene: a file, standard input, a preset or a generator name.
#ifndef RB_SCENE_LOAD_H
#define RB_SCENE_LOAD_H

#include "scene/nff.h"

// SCENE is a path, "-" for standard input, a preset ("balls_high") or a generated size ("mount7").
// A name wins over a file of the same name; write "./balls_high" for the file.
enum rb_status rb_scene_load(const char *scene_name, const struct rb_nff_options *options,
                             struct rb_scene *scene, struct rb_error *error);

#endif
