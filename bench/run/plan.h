// What to measure: a text of `key = value` lines, one for each long option of `raybench bench`, and
// the cells that follow from it. A plan is such a text in a file, the command line adds lines to
// it, and later lines win; so one table of options documents, parses and checks all of them. The
// whole text is kept with the results, where --resume finds it.
#ifndef RB_RUN_PLAN_H
#define RB_RUN_PLAN_H

#include "bench/run/cell.h"
#include "cli/options.h"

// The cells of a run. Zero-initialise; release with rb_plan_free.
struct rb_plan {
    char *text;                    // the lines
    char file[256];                // that part of the text was read from; "": none
    struct rb_arguments arguments; // as the text says; its words point into `words`
    char *words;                   // a copy of `text`, cut into words
    struct rb_reference *references;
    int reference_count;
    struct rb_cell *cells;
    int cell_count;
};

// Finds plan NAME: a path that ends in .plan, or one of those that come with the program, in the
// checkout we stand in, the one the program was built in, or where it was installed.
enum { RB_PLAN_PATH_MAX = 1024 };
bool rb_plan_find(const char *name, char path[RB_PLAN_PATH_MAX]);

// Makes the text of a plan from what the user said: the plan file if one was named, else what is
// `defaults`, then the lines of the command line.
enum rb_status rb_plan_compose(const struct rb_arguments *given, const char *defaults,
                               struct rb_plan *plan, struct rb_error *error);

// Parses plan->text into plan->arguments; `command` has the options.
enum rb_status rb_plan_parse(const struct rb_command *command, struct rb_plan *plan,
                             struct rb_error *error);

// Makes references and cells. Loads each scene once, to check it and to learn its default settings.
// Returns the exit code, having reported errors.
int rb_plan_expand(struct rb_plan *plan);

// Empties it.
void rb_plan_free(struct rb_plan *plan);

#endif
