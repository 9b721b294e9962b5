// What the render-time table times: `raybench render SCENE --variant V -o FILE.ppm --quiet` at
// default settings, as a process of its own. Not thread-safe.
#ifndef RB_TIMES_RENDER_SESSION_H
#define RB_TIMES_RENDER_SESSION_H

#include "bench/times/hyperfine.h"
#include "bench/times/render_plan.h"
#include "bench/times/timed.h"

#include <stdint.h>

enum { RB_RENDER_FOLDER_MAX = 4000, RB_RENDER_PATH_MAX = 4096 };

struct rb_render_session {
    char program[RB_RENDER_PATH_MAX];          // ourselves
    char hyperfine[RB_HYPERFINE_VERSION_ROOM]; // "" if our own clock has to do
    char folder[RB_RENDER_FOLDER_MAX];         // temporary; what is in it:
    char image[RB_RENDER_PATH_MAX], log[RB_RENDER_PATH_MAX], json[RB_RENDER_PATH_MAX];
    struct rb_render_cell *cells;
    size_t count;
    bool *disagrees; // of each cell: it made another image than the first
    bool has_reference;
    uint64_t reference; // hash of the first image
};

// `cells` (the caller's, sorted by scene) must outlive the session. RB_FAILED without a temporary
// folder or memory; there is nothing to close then.
enum rb_status rb_render_session_open(struct rb_render_session *session,
                                      struct rb_render_cell *cells, size_t count,
                                      struct rb_error *error);
void rb_render_session_close(struct rb_render_session *session); // removes the folder

// One run of a cell, by our own clock, into `session->image`; `edge`: of a square image in pixels,
// 0 for the scene's own size.
enum rb_status rb_render_session_time(const struct rb_render_session *session,
                                      const struct rb_render_cell *cell, int edge,
                                      struct rb_timed_result *time, struct rb_error *error);

// The cell's warm-ups and runs, by hyperfine. On RB_OK release `times`.
enum rb_status rb_render_session_hyperfine(const struct rb_render_session *session,
                                           const struct rb_render_cell *cell,
                                           struct rb_run_times *times, struct rb_error *error);

// Holds the image that cell `index` just made against the first one since `has_reference` was
// false, and remembers in `disagrees` if they differ.
enum rb_status rb_render_session_compare(struct rb_render_session *session, size_t index,
                                         struct rb_error *error);

#endif
