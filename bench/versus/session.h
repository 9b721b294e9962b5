// One run of `raybench versus`: its contests, and how they are measured. Private to versus/.
#ifndef RB_VERSUS_SESSION_H
#define RB_VERSUS_SESSION_H

#include "bench/run/folder.h"
#include "bench/versus/versus.h"

enum { RB_VERSUS_SCENES_MAX = 16, RB_VERSUS_THREAD_COUNTS = 2 }; // threads: one, and all

struct rb_versus_session {
    const struct rb_arguments *arguments;
    char program[RB_OUTPUT_PATH_MAX];
    char folder[RB_PATH_MAX];
    const char *const *scenes;
    int scene_count;
    uint64_t start_ns;
    struct rb_reference reference[RB_VERSUS_SCENES_MAX];
    struct rb_versus_trees trees[RB_VERSUS_SCENES_MAX][RB_VERSUS_THREAD_COUNTS];
    struct rb_contest
        contests[RB_VERSUS_SCENES_MAX * RB_VERSUS_THREAD_COUNTS * RB_VERSUS_CLASS_COUNT];
    size_t contest_count;
    int thread_counts[RB_VERSUS_THREAD_COUNTS],
        scene_contests; // contests of a scene: classes by threads
    bool failed;
};

// Tells on a terminal what happens.
void rb_versus_tell(const struct rb_versus_session *session, const char *scene, const char *what);

// Measures the contests of a scene, whose rays are in the record `path`, in processes: of both
// sides in turn, round after round. Problems are reported and noted in the session.
void rb_versus_measure(struct rb_versus_session *session, struct rb_contest *contests, int scene,
                       const char *path);

#endif
