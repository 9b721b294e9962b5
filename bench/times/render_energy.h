// The energy of the rows of the render-time table.
#ifndef RB_TIMES_RENDER_ENERGY_H
#define RB_TIMES_RENDER_ENERGY_H

#include "bench/times/render_session.h"
#include "bench/times/render_table.h"

// Runs every cell that was run in full again, for a second or more, with a meter around it, and
// fills in what a run takes, net of the idle machine. `root` as in rb_meter_open. Where nothing can
// be measured the rows keep none, and a line on standard output says why; that is no failure.
// RB_FAILED without memory, or if a signal ends it.
enum rb_status rb_render_measure_energy(const struct rb_render_session *session, const char *root,
                                        struct rb_render_row *rows, struct rb_error *error);

#endif
