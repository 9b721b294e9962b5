// One row of a report in words.
#ifndef RB_GATE_ROW_H
#define RB_GATE_ROW_H

#include "bench/gate/report.h"

enum { RB_GATE_PLACE_MAX = 640, RB_GATE_COMMAND_MAX = 1536 };

extern const char *const rb_moved_names[RB_MOVED_COUNT];

// "balls_high 64x64, depth 5, bvh, trace at bounce 1".
void rb_gate_row_place(const struct rb_gate_row *row, char text[RB_GATE_PLACE_MAX]);
bool rb_gate_row_same_place(const struct rb_gate_row *a, const struct rb_gate_row *b);

// What shows the figure, of the place alone, for a shell.
void rb_gate_row_command(const struct rb_gate_row *row, char text[RB_GATE_COMMAND_MAX]);

#endif
