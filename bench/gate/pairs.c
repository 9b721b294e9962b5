#include "bench/gate/pairs.h"

#include "bench/run/session.h"

#include <string.h>

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

const struct rb_option rb_options_pairs[] = {
    {"--against", "PROGRAM", RB_OPTION_TEXT, BENCH(against), 0, 0, "the base, built alike"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0,
     "rows, comma-separated names or patterns"},
    {"--size", "WxH", RB_OPTION_SIZE, offsetof(struct rb_arguments, settings), 1, RB_SIZE_MAX,
     "image size"},
    {"--processes", "N", RB_OPTION_INT, BENCH(processes), 1, 1000,
     "processes of either program for a cell, at least"},
    {"--budget", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 0.1, 1e6,
     "time for a set of processes; there are two if something is worse, and one for each A/A "
     "comparison"},
    {.name = NULL},
};

// That all rows of kernels hold with at once, and all rows of single bounces.
static const double LEVEL = 0.95;

// What the session fills.
static struct {
    struct rb_pairs *pairs;
    enum rb_status status;
    struct rb_error error;
} session;

void rb_pairs_free(struct rb_pairs *pairs)
{
    rb_comparison_free(&pairs->median);
    rb_comparison_free(&pairs->low);
    for (int side = 0; side < 2; side++)
        rb_timings_free(&pairs->timings[side]);
    *pairs = (struct rb_pairs){.median = {.cells = NULL}};
}

static enum rb_status compare(struct rb_pairs *pairs, struct rb_error *error)
{
    const struct rb_compare_side sides[2] = {{&pairs->timings[0], NULL},
                                             {&pairs->timings[1], NULL}};
    struct rb_compare_options how = {.level = LEVEL, .bounces = true, .paired = true};
    how.quantile = 0.5;
    enum rb_status status = rb_comparison_make(sides, &how, &pairs->median, error);
    how.quantile = RB_TIME_QUANTILE;
    if (!status)
        status = rb_comparison_make(sides, &how, &pairs->low, error);
    if (status)
        return status;
    const struct rb_comparison *made = &pairs->median;
    bool all = made->cell_count && !made->only_count[0] && !made->only_count[1];
    for (size_t i = 0; i < made->cell_count; i++)
        all = all && made->cells[i].row_count;
    return all ? RB_OK
               : rb_error_set(error, RB_INVALID,
                              "a cell has no times on one side, or another image: this is not the "
                              "same work");
}

// Called when the session has come to its end. Side 0 of a session is this program.
static int take(const struct rb_run *run, bool partial)
{
    struct rb_error *error = &session.error;
    enum rb_status status = partial ? rb_error_set(error, RB_INVALID, "interrupted") : RB_OK;
    for (int side = 0; side < 2 && !status; side++)
        status = rb_timings_load(run->sides[!side].folder, &session.pairs->timings[side], error);
    if (!status) {
        *error = (struct rb_error){0}; // no file is in question any more
        status = compare(session.pairs, error);
    }
    session.status = status;
    return (int)status;
}

static bool is_passed_on(const char *name)
{
    bool found = false;
    for (const struct rb_option *option = rb_options_pairs; option->name; option++)
        found = found || strcmp(option->name, name) == 0;
    return found && strcmp(name, "--against") != 0;
}

// The command line of `raybench bench` that measures this.
static struct rb_arguments session_arguments(const struct rb_arguments *given, const char *program)
{
    struct rb_arguments arguments = {.positional = {"regress"},
                                     .positional_count = 1,
                                     .output = given->output,
                                     .quiet = given->quiet,
                                     .command_line = given->command_line};
    for (int i = 0; i < given->positional_count; i++)
        arguments.positional[i] = given->positional[i];
    if (given->positional_count)
        arguments.positional_count = given->positional_count;
    for (int i = 0; i < given->given_count; i++)
        if (is_passed_on(given->given[i].name))
            arguments.given[arguments.given_count++] = given->given[i];
    arguments.given[arguments.given_count].name = "--against";
    arguments.given[arguments.given_count++].value = program;
    return arguments;
}

enum rb_status rb_pairs_measure(const struct rb_arguments *given, const char *program,
                                struct rb_pairs *pairs, struct rb_error *error)
{
    static const struct rb_session_kind kind = {
        .defaults = "variants = bvh,packet,auto\nsize = 128x128\nprocesses = 32\nbudget = 90s\n",
        .print = take};
    const struct rb_arguments arguments = session_arguments(given, program);
    rb_pairs_free(pairs);
    memset(&session, 0, sizeof session);
    session.pairs = pairs;
    int code = rb_session_run(&kind, &arguments);
    if (code && !session.status)
        session.status = rb_error_set(&session.error, RB_INVALID, "it could not be measured");
    *error = session.error;
    return session.status;
}
