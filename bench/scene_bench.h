// All rows on one scene: verified against each other, then timed in turn.
#ifndef RB_BENCH_SCENE_BENCH_H
#define RB_BENCH_SCENE_BENCH_H

#include "bench/row.h"
#include "bench/tiles.h"

enum { RB_ROWS_MAX = 64 };

struct rb_scene_bench {
    const char *name;
    const struct rb_scene *scene;
    struct rb_settings settings; // complete
    struct rb_row rows[RB_ROWS_MAX];
    int row_count;
    struct rb_tiles tiles;    // what the rows were verified on
    struct rb_recorder frame; // ray counts of a whole frame, the same for every row
    double frame_rays;        // rays of trace and trace_shadow in it
    bool mismatch;            // some row disagreed with the reference
};

// Measures every row of the table within about `budget_s` seconds; the least it does is one small
// tile with the reference and one frame with every other row. Release with rb_scene_bench_free.
enum rb_status rb_scene_bench_run(struct rb_scene_bench *bench, const char *name,
                                  const struct rb_scene *scene, const struct rb_settings *settings,
                                  double budget_s, struct rb_error *error);
void rb_scene_bench_free(struct rb_scene_bench *bench);

// The row of that name, or NULL.
const struct rb_row *rb_scene_bench_row(const struct rb_scene_bench *bench, const char *name);

#endif
