// The render-time table for readers: report/table1.md and the block in README.md. Both are pure
// functions of the table, so that they can be held against it (make table CHECK=1).
#ifndef RB_TIMES_RENDER_REPORT_H
#define RB_TIMES_RENDER_REPORT_H

#include "bench/times/render_table.h"

#define RB_README_BEGIN "<!-- table1 begin: make table -->"
#define RB_README_END   "<!-- table1 end -->"

// All rows, scene by scene.
void rb_render_report_markdown(FILE *out, const struct rb_render_table *table);

// The few columns that fit a README, without the lines of the markers.
void rb_render_report_compact(FILE *out, const struct rb_render_table *table);

// Writes `text`, a README of `length` bytes, with the lines between its markers replaced by those
// of the table. RB_INVALID with a line number unless each marker stands once, on a line of its own,
// in this order.
enum rb_status rb_render_report_readme(FILE *out, const char *text, size_t length,
                                       const struct rb_render_table *table, struct rb_error *error);

#endif
