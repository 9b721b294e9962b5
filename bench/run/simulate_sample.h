// Which tiles of a frame stand for all of it, where all would take the simulator too long.
#ifndef RB_RUN_SIMULATE_SAMPLE_H
#define RB_RUN_SIMULATE_SAMPLE_H

#include "bench/run/cell.h"

// Tiles of one frame differ by a factor of ten in what they cost, so that a few of them chosen
// blindly tell little about the others. Of several hundred samples of `count` tiles this chooses
// the one (its seed for rb_tiles_runs) whose tiles cost most nearly what those of the whole frame
// do on average, as the counting twins of bvh say: nodes and primitives, exact and the same in
// every run. (Balanced sampling; Deville and Tille 2004, "Efficient balanced sampling: the cube
// method", would do the same at more expense.) `settings` are those of the cell with the edge of
// the tiles. Takes about the time of a frame.
enum rb_status rb_simulate_choose_sample(const struct rb_cell *cell,
                                         const struct rb_settings *settings, uint32_t count,
                                         uint64_t *seed, struct rb_error *error);

#endif
