#include "bench/history/history.h"

#include "bench/data/changes.h"
#include "bench/data/names.h"
#include "bench/data/stats.h"
#include "bench/history/log.h"
#include "cli/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"--file", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "the history; default results/history.ndjson"},
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, BENCH(scenes), 0, 0,
     "show only these: names or globs, separated by commas"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0, "only these"},
    {"--kernels", "frame|generate|trace|shade|trace_shadow,...", RB_OPTION_TEXT, BENCH(kernels), 0,
     0, "only these; default frame"},
    {.name = NULL},
};

const struct rb_command rb_command_history = {
    .name = "history",
    .summary = "add runs to a history, and show the course of every cell with its changes",
    .synopsis = "[RESULT...] [options]",
    .text = "RESULT is a folder of results that have come to their end; each is added once. FILE\n"
            "is NDJSON: an object a line for each kernel of each cell of each run.\n\n"
            "  raybench history results/latest\n"
            "  raybench history --scenes balls_high --kernels '*'\n\n"
            "A course is a cell on one machine: times in ms, medians over processes, with their\n"
            "95 % intervals. A change point is where its level has moved and stayed, by the ranks\n"
            "of the times and a test that assumes nothing else (bench/data/changes.h); it takes\n"
            "ten runs or so to be sure of one. Separate runs have the drift of the machine in\n"
            "them: raybench regress tells whether a commit is to blame.",
    .positional_min = 0,
    .positional_max = 16,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

// Of a level, from `first` on up to the next one.
static double level(const double *ms, const bool *starts, size_t count, size_t first,
                    double *scratch)
{
    size_t used = 0;
    for (size_t i = first; i < count && (i == first || !starts[i]); i++)
        scratch[used++] = ms[i];
    return rb_stats_quantile(scratch, used, 0.5);
}

static enum rb_status put_course(const struct rb_log_entry *entries, size_t count,
                                 struct rb_error *error)
{
    double *ms = rb_alloc(2 * count, sizeof *ms), before = 0;
    bool *starts = rb_alloc(count, sizeof *starts);
    for (size_t i = 0; i < count && ms; i++)
        ms[i] = entries[i].ms;
    bool enough = ms && starts && rb_changes_find(ms, count, starts);
    printf("\n%s\n", entries->course);
    for (size_t i = 0; i < count && enough; i++) {
        double now = i == 0 || starts[i] ? level(ms, starts, count, i, ms + count) : before;
        printf("  %-40s %-9.9s %11.5g", entries[i].session,
               entries[i].commit[0] ? entries[i].commit : "-", entries[i].ms);
        if (!isnan(entries[i].low))
            printf("  %.5g to %.5g", entries[i].low, entries[i].high);
        if (starts[i])
            printf("  <- changed by %+.1f %%: %.5g to %.5g", 100 * (now / before - 1), before, now);
        printf("\n");
        before = now;
    }
    rb_free(ms);
    rb_free(starts);
    return enough ? RB_OK : rb_error_memory(error, "the history");
}

static bool is_shown(const struct rb_bench_arguments *chosen, const struct rb_log_entry *entry)
{
    return rb_names_match(chosen->scenes, entry->scene) &&
           rb_names_match(chosen->variants, entry->variant) &&
           rb_names_match(chosen->kernels ? chosen->kernels : "frame", entry->kernel);
}

static enum rb_status show(const struct rb_arguments *arguments, const struct rb_array *entries,
                           struct rb_error *error)
{
    const struct rb_log_entry *all = entries->data;
    enum rb_status status = RB_OK;
    bool any = false;
    for (size_t i = 0, end; i < entries->count && !status; i = end) {
        for (end = i + 1; end < entries->count && strcmp(all[i].course, all[end].course) == 0;)
            end++;
        if (!is_shown(&arguments->bench, &all[i]))
            continue;
        any = true;
        status = put_course(&all[i], end - i, error);
    }
    if (!status && !any)
        status = rb_error_set(error, RB_INVALID, "the history has nothing of what is asked for");
    return status;
}

static int run(const struct rb_arguments *arguments)
{
    const char *path = arguments->output ? arguments->output : "results/history.ndjson";
    struct rb_array entries = {0};
    struct rb_error error = {0};
    enum rb_status status = rb_log_read(path, &entries, &error);
    for (int i = 0; i < arguments->positional_count && !status; i++) {
        bool added;
        status = rb_log_append(path, &entries, arguments->positional[i], &added, &error);
        if (!status)
            printf("%s: %s\n", arguments->positional[i],
                   added ? "added" : "is in the history already");
        rb_array_release(&entries);
        if (!status)
            status = rb_log_read(path, &entries, &error);
    }
    if (!status)
        status = show(arguments, &entries, &error);
    rb_array_release(&entries);
    return status ? rb_report(status, &error) : RB_OK;
}
