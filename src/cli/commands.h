// The sub-commands of the program. Each returns the exit code: 0 fine, 1 runtime failure, 2 bad
// usage or input.
#ifndef RB_CLI_COMMANDS_H
#define RB_CLI_COMMANDS_H

#include "cli/options.h"
#include "render/renderer.h"
#include "scene/scene.h"

#define RB_VERSION "0.1.0"

extern const struct rb_command rb_command_render;
extern const struct rb_command rb_command_pixel;
extern const struct rb_command rb_command_info;
extern const struct rb_command rb_command_scene;
extern const struct rb_command rb_command_list;

// What scene names --help should explain.
#define RB_HELP_SCENE                                                                              \
    "SCENE is an NFF file, - for standard input, one of the names of `raybench list scenes`,\n"    \
    "or a generator with a size: balls6, mount9."

// Prints "raybench: file:line:column: text" on standard error; returns `status` as exit code.
int rb_report(enum rb_status status, const struct rb_error *error);

// Loads a scene, reporting warnings (unless --quiet) and errors. Returns the exit code.
int rb_open_scene(const char *name, const struct rb_arguments *arguments, struct rb_scene *scene);

// The row asked for, or the fastest. NULL after reporting an unknown name.
const struct rb_variant *rb_open_variant(const struct rb_arguments *arguments);

// Loads the scene positional[0] and makes a renderer for it as the options ask; on any failure it
// is reported and nothing is left to free. Warns about options that cannot have an effect.
int rb_open_renderer(const struct rb_arguments *arguments, struct rb_scene *scene,
                     struct rb_renderer **renderer);

#endif
