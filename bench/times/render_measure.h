// Measures the render-time table.
#ifndef RB_TIMES_RENDER_MEASURE_H
#define RB_TIMES_RENDER_MEASURE_H

#include "bench/times/render_session.h"
#include "bench/times/render_table.h"

// Edge in pixels of the images of all scenes of the report: their generators say so. The two small
// ones are what estimates are made of.
enum { RB_RENDER_EDGE = 512, RB_RENDER_MEDIUM_EDGE = 64, RB_RENDER_SMALL_EDGE = 16 };

// Estimates the time of every cell from small images, that of short ones by a run in full, and
// compares the images within each scene.
enum rb_status rb_render_estimate(struct rb_render_session *session, struct rb_error *error);

// Measures what the plan has, scene by scene, into a row for each cell; what is left of the budget
// is planned anew before each scene. Rows of one scene take turns if our own clock is used. Fills
// all of a row but its speed-ups and where it comes from.
enum rb_status rb_render_measure(struct rb_render_session *session, int runs, double budget_s,
                                 struct rb_render_row *rows, struct rb_error *error);

#endif
