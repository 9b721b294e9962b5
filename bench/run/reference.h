// What the image and the hits of a scene must be, and how many rays there are. The row naive says
// so where a whole frame of it can be afforded, or was once: its hashes are kept in a file
// next to the results. Elsewhere bvh says so, after naive agreed with it on a random sample of
// tiles.
#ifndef RB_RUN_REFERENCE_H
#define RB_RUN_REFERENCE_H

#include "bench/run/plan.h"
#include "bench/run/process.h"

// The command line of a worker that measures with these settings; what else it should know comes
// next, and the scene last.
void rb_reference_words(const struct rb_settings *settings, const char *program,
                        const struct rb_variant *variant, struct rb_worker_words *words);
void rb_reference_scene_word(const struct rb_reference *reference, struct rb_worker_words *words);

// Seconds that one thread of naive would take for a frame, roughly; the reference must be made.
double rb_reference_naive_s(const struct rb_reference *reference);

// A cell of naive whose frame would take more than half of `slice_s` is to measure groups of tiles
// that take that long.
void rb_reference_choose_group(struct rb_cell *cell, double slice_s);

// Makes the reference, from `cache_path` if it is there. Naive is rendered in full if that takes no
// more than about `budget_s`, or `full` is set, and then kept in the file. RB_INVALID if naive and
// bvh disagree.
enum rb_status rb_reference_make(struct rb_reference *reference, const char *program,
                                 const char *cache_path, double budget_s, bool full,
                                 struct rb_error *error);

#endif
