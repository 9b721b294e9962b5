// Which scenes and variants the render-time table is about.
#ifndef RB_TIMES_RENDER_SELECT_H
#define RB_TIMES_RENDER_SELECT_H

#include "bench/times/render_plan.h"
#include "bench/times/render_table.h"

enum { RB_AVAILABLE_ROOM = 1024 };

// Lists of names and globs, separated by commas; NULL stands for all there are.
struct rb_render_selection {
    const char *scenes, *variants;
};

// The names of all variants that this machine can run and that are no aliases, by blanks.
void rb_render_available(char names[RB_AVAILABLE_ROOM]);

// Makes the cells that the selection stands for on this machine, by scene; release with rb_free.
// RB_INVALID if an item of a list matches nothing.
enum rb_status rb_render_select(const struct rb_render_selection *selection,
                                struct rb_render_cell **cells, size_t *count,
                                struct rb_error *error);

// Has the table a time for each scene selected and each variant selected of those that were
// available on its machine, and are all rows of one run? RB_INVALID with what is missing.
enum rb_status rb_render_complete(const struct rb_render_selection *selection,
                                  const struct rb_render_table *table, struct rb_error *error);

#endif
