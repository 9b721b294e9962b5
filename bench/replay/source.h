// What of a record is replayed, opened with everything it takes: the batches of one kernel of a
// class, the scene, a renderer of the row.
#ifndef RB_REPLAY_SOURCE_H
#define RB_REPLAY_SOURCE_H

#include "bench/replay/record_file.h"
#include "cli/options.h"
#include "render/renderer.h"

// What to replay, and by which row: --kernel, --class, --bounce, --variant. Shared by the command
// and its worker processes.
extern const struct rb_option rb_options_choice[];

// The row asked for, or the fastest serial one. NULL after reporting an unknown name.
const struct rb_variant *rb_replay_variant(const struct rb_arguments *arguments);

// Parses the others. *kernel is -1 and *ray_class RB_CLASS_COUNT for all there are; *bounce is -1.
enum rb_status rb_choice_parse(const struct rb_arguments *arguments, int *kernel, int *ray_class,
                               int *bounce, struct rb_error *error);

// The kind of rays that a kernel gets.
enum rb_batch_kind rb_kernel_batch_kind(enum rb_stage kernel);

// Loads the scene of a record and compares its hash; RB_INVALID if it is another one. Returns the
// exit code, having reported what is wrong.
int rb_record_open_scene(const struct rb_record *record, const char *path,
                         const struct rb_arguments *arguments, struct rb_scene *scene);

struct rb_replay_source {
    struct rb_record record;
    struct rb_variant row; // whose kernels are replayed, by --threads of them
    struct rb_scene scene;
    struct rb_renderer *renderer;
    struct rb_replay replay; // one round of the batches, which fit the renderer
};

// Opens what `choice` picks from the record `path` for arguments->variant and settings.threads (0:
// one thread). The source must stay where it is. Returns the exit code,
// having reported what is wrong; nothing is left to close then.
int rb_replay_source_open(const char *path, const struct rb_record_choice *choice,
                          const struct rb_arguments *arguments, struct rb_replay_source *source);
void rb_replay_source_close(struct rb_replay_source *source);

#endif
