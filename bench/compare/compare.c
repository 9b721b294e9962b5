#include "bench/compare/compare.h"

#include "base/file.h"
#include "base/memory.h"
#include "bench/compare/compare_print.h"
#include "bench/data/json_read.h"
#include "bench/data/names.h"
#include "cli/commands.h"
#include "cli/suggest.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double default_level = 0.99;
enum { GATE_CLOSED = 3 };

static int run(const struct rb_arguments *arguments);

#define ARGUMENT(field) offsetof(struct rb_arguments, field)

static const struct rb_option options[] = {
    {"--variants", "VARIANT,VARIANT", RB_OPTION_TEXT, ARGUMENT(bench.variants), 0, 0,
     "two variants of the one run A; X takes the part of A, Y that of B"},
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, ARGUMENT(bench.scenes), 0, 0,
     "only these: names or globs, separated by commas"},
    {"--kernels", "frame|generate|trace|shade|trace_shadow|resolve|other,...", RB_OPTION_TEXT,
     ARGUMENT(bench.kernels), 0, 0, "only these; default: all but resolve and other"},
    {"--bounces", NULL, RB_OPTION_FLAG, ARGUMENT(bench.bounces), 0, 0, "each bounce as well"},
    {"--level", "P", RB_OPTION_NUMBER, ARGUMENT(bench.level), 0.5, 0.999999,
     "probability that all intervals hold at once; default 0.99"},
    {"--gate", NULL, RB_OPTION_FLAG, ARGUMENT(bench.gate), 0, 0,
     "exit code 3 if anything is slower by more than --threshold"},
    {"--threshold", "PCT", RB_OPTION_NUMBER, ARGUMENT(bench.threshold_pct), 0, 1000,
     "per cent that --gate lets pass; default 0"},
    {"--json", NULL, RB_OPTION_FLAG, ARGUMENT(json), 0, 0, "as a JSON object"},
    {.name = NULL},
};

const struct rb_command rb_command_compare = {
    .name = "compare",
    .summary = "compare two runs, or two variants of one run",
    .synopsis = "RESULT [RESULT] [options]",
    .text =
        "A, the first RESULT, and B are folders of results of one machine; a run that has not\n"
        "ended will do. One RESULT alone needs --variants. For each scene, variant and\n"
        "kernel: the ratio of the times, B over A, its interval, and whether B is faster or\n"
        "slower. Where the interval spans 1 that is not resolved.\n"
        "\n"
        "The time of a process is the 10th percentile of its repetitions (the minimum of up to\n"
        "ten): for the frame its wall time, for a kernel the time of all threads. Processes of "
        "one\n"
        "session are compared in pairs. Intervals assume no distribution (sign test) and are\n"
        "widened for the number of rows, so that all of them hold at once with --level.\n"
        "\n"
        "Exit codes: 0 compared; 2 not comparable (other machine, nothing in common); with --gate\n"
        "also 3 if an interval lies above the threshold as a whole, and else 2 if a row of A "
        "could\n"
        "not be decided for lack of processes or of its counterpart.",
    .positional_min = 1,
    .positional_max = 2,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

static enum rb_status load_environment(struct rb_compare_run *side, struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX], *text;
    snprintf(path, sizeof path, "%s/env.json", side->folder);
    enum rb_status status = rb_json_load(path, &text, error);
    if (status)
        return status;
    rb_json_get_text(rb_json_find(text, "session"), side->session, sizeof side->session);
    rb_json_get_text(rb_json_find(text, "host.name"), side->host, sizeof side->host);
    rb_json_get_text(rb_json_find(text, "host.cpu_model"), side->cpu_model, sizeof side->cpu_model);
    rb_json_get_text(rb_json_find(text, "git.commit"), side->commit, sizeof side->commit);
    rb_free(text);
    if (side->host[0])
        return RB_OK;
    return rb_error_set(error, RB_INVALID,
                        "no host.name: times can be compared only with those of "
                        "the same machine");
}

static enum rb_status load_run(const char *folder, struct rb_compare_run *side,
                               struct rb_error *error)
{
    side->folder = folder;
    enum rb_status status = rb_timings_load(folder, &side->samples, error);
    if (status || side->samples.count)
        return status;
    return rb_error_set(error, RB_INVALID, "no whole repetition yet");
}

static enum rb_status check_same_machine(const struct rb_compare_run *a,
                                         const struct rb_compare_run *b, struct rb_error *error)
{
    if (strcmp(a->host, b->host) != 0)
        return rb_error_set(error, RB_INVALID,
                            "measured on different hosts, %.80s and %.80s: their times cannot be "
                            "compared; measure both on one",
                            a->host, b->host);
    if (strcmp(a->cpu_model, b->cpu_model) != 0)
        return rb_error_set(error, RB_INVALID,
                            "measured on different processors, %.80s and %.80s: their times cannot "
                            "be compared; measure both on one",
                            a->cpu_model[0] ? a->cpu_model : "an unknown one",
                            b->cpu_model[0] ? b->cpu_model : "an unknown one");
    return RB_OK;
}

// Does any cell of the sides have this text, or match this glob, in a column of its key?
static bool has_key(const struct rb_compare_side sides[2], enum rb_key key, const char *text)
{
    bool found = false;
    for (int s = 0; s < 2; s++)
        for (size_t i = 0; i < sides[s].samples->cell_count; i++)
            found |= rb_names_match(text, sides[s].samples->cells[i].key[key]);
    return found;
}

static enum rb_status refuse_name(const struct rb_compare_side sides[2], enum rb_key key,
                                  const char *name, struct rb_error *error)
{
    struct rb_suggestion suggestion = {.typed = name, .length = strlen(name)};
    char nearest[RB_SUGGESTION_TEXT];
    for (int s = 0; s < 2; s++) {
        for (size_t i = 0; i < sides[s].samples->cell_count; i++) {
            const char *word = sides[s].samples->cells[i].key[key];
            if (!suggestion.word || strcmp(word, suggestion.word) != 0)
                rb_suggestion_offer(&suggestion, word);
        }
    }
    return rb_error_set(error, RB_INVALID, "no samples of the %s '%.80s'%s", rb_key_names[key],
                        name, rb_suggestion_text(&suggestion, nearest));
}

// A name that fits nothing is a mistake, and would make a gate that never closes.
static enum rb_status check_lists(const struct rb_compare_side sides[2], const char *scenes,
                                  const char *kernels, struct rb_error *error)
{
    char item[RB_NAME_MAX];
    while (scenes && rb_names_next(&scenes, item))
        if (!has_key(sides, RB_KEY_SCENE, item))
            return refuse_name(sides, RB_KEY_SCENE, item, error);
    while (kernels && rb_names_next(&kernels, item)) {
        struct rb_suggestion suggestion = {.typed = item, .length = strlen(item)};
        char nearest[RB_SUGGESTION_TEXT];
        bool found = false;
        for (int i = 0; i < RB_TIMED_KERNELS; i++) {
            found |= rb_names_match(item, rb_timed_kernels[i].name);
            rb_suggestion_offer(&suggestion, rb_timed_kernels[i].name);
        }
        if (!found)
            return rb_error_set(error, RB_INVALID, "there is no kernel '%.80s'%s", item,
                                rb_suggestion_text(&suggestion, nearest));
    }
    return RB_OK;
}

// "X,Y" apart, into names that sides can point to.
static enum rb_status split_variants(const char *list, char names[2][RB_NAME_MAX],
                                     struct rb_compare_side sides[2], struct rb_error *error)
{
    char third[RB_NAME_MAX];
    if (!rb_names_next(&list, names[0]) || !rb_names_next(&list, names[1]) ||
        rb_names_next(&list, third) || strcmp(names[0], names[1]) == 0)
        return rb_error_set(error, RB_INVALID, "--variants: expected two names, X,Y");
    for (int s = 0; s < 2; s++) {
        sides[s].variant = names[s];
        if (!has_key(sides, RB_KEY_VARIANT, names[s]))
            return refuse_name(sides, RB_KEY_VARIANT, names[s], error);
    }
    return RB_OK;
}

static enum rb_status check_common(const struct rb_comparison *comparison, struct rb_error *error)
{
    char a[RB_CELL_LABEL_MAX] = "nothing", b[RB_CELL_LABEL_MAX] = "nothing";
    if (comparison->row_count)
        return RB_OK;
    if (comparison->only_count[0])
        rb_compare_label(comparison->only[0][0], 0, a);
    if (comparison->only_count[1])
        rb_compare_label(comparison->only[1][0], 0, b);
    if (comparison->cell_count == 0)
        return rb_error_set(error, RB_INVALID,
                            "no cell in common; only in A, %zu: %.100s; only in B, %zu: %.100s",
                            comparison->only_count[0], a, comparison->only_count[1], b);
    bool images = false;
    for (size_t i = 0; i < comparison->cell_count; i++)
        images |= !comparison->cells[i].same_image;
    return rb_error_set(error, RB_INVALID,
                        images ? "the images differ: this is not the same work"
                               : "no kernel was measured on both sides");
}

static void judge_gate(const struct rb_comparison *comparison, struct rb_compare_gate *gate)
{
    gate->undecided = comparison->only_count[0];
    for (size_t i = 0; i < comparison->cell_count; i++)
        gate->undecided += comparison->cells[i].row_count == 0;
    for (size_t i = 0; i < comparison->row_count; i++) {
        const struct rb_compare_row *row = &comparison->rows[i];
        gate->slower += row->ratio.low > 1 + gate->threshold_pct / 100;
        gate->undecided += row->verdict == RB_VERDICT_TOO_FEW;
    }
}

static int gate_code(const struct rb_compare_gate *gate)
{
    struct rb_error error = {0};
    if (!gate->asked || (!gate->slower && !gate->undecided))
        return RB_OK;
    if (gate->slower)
        return GATE_CLOSED;
    rb_error_set(&error, RB_INVALID,
                 "the gate cannot decide: %zu rows have too few processes or no counterpart",
                 gate->undecided);
    return rb_report(RB_INVALID, &error);
}

// Compares what has been loaded and prints it. The exit code goes to `code`.
static enum rb_status compare(const struct rb_arguments *arguments,
                              const struct rb_compare_run *runs[2], int *code,
                              struct rb_error *error)
{
    char variants[2][RB_NAME_MAX];
    struct rb_compare_side sides[2] = {{&runs[0]->samples, NULL}, {&runs[1]->samples, NULL}};
    struct rb_compare_options chosen = {arguments->bench.scenes,
                                        arguments->bench.kernels,
                                        arguments->bench.level > 0 ? arguments->bench.level
                                                                   : default_level,
                                        arguments->bench.bounces,
                                        false,
                                        0};
    chosen.paired = runs[0] == runs[1] ||
                    (runs[0]->session[0] && strcmp(runs[0]->session, runs[1]->session) == 0);
    enum rb_status status = RB_OK;
    if (arguments->bench.variants)
        status = split_variants(arguments->bench.variants, variants, sides, error);
    if (!status)
        status = check_lists(sides, arguments->bench.scenes, arguments->bench.kernels, error);
    if (status)
        return status;
    struct rb_comparison comparison;
    status = rb_comparison_make(sides, &chosen, &comparison, error);
    if (!status)
        status = check_common(&comparison, error);
    if (!status) {
        struct rb_compare_report report = {
            {runs[0], runs[1]},
            {sides[0].variant, sides[1].variant},
            &chosen,
            &comparison,
            {arguments->bench.gate, arguments->bench.threshold_pct, 0, 0}};
        judge_gate(&comparison, &report.gate);
        (arguments->json ? rb_compare_print_json : rb_compare_print)(&report);
        *code = gate_code(&report.gate);
    }
    rb_comparison_free(&comparison);
    return status;
}

static enum rb_status check_usage(const struct rb_arguments *arguments, struct rb_error *error)
{
    bool two = arguments->positional_count == 2;
    if (two && arguments->bench.variants)
        return rb_error_set(error, RB_INVALID, "--variants compares within one run; give one");
    if (!two && !arguments->bench.variants)
        return rb_error_set(error, RB_INVALID, "give two runs, or one and --variants X,Y");
    if (arguments->bench.threshold_pct > 0 && !arguments->bench.gate)
        return rb_error_set(error, RB_INVALID, "--threshold is what --gate goes by; add --gate");
    return RB_OK;
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    static const struct rb_compare_run nothing;
    struct rb_compare_run loaded[2] = {nothing, nothing};
    const struct rb_compare_run *runs[2] = {&loaded[0], &loaded[arguments->bench.variants ? 0 : 1]};
    int code = RB_OK;
    enum rb_status status = check_usage(arguments, &error);
    for (int i = 0; i < arguments->positional_count && !status; i++)
        status = load_run(arguments->positional[i], &loaded[i], &error);
    for (int i = 0; i < 2 && !arguments->bench.variants && !status; i++)
        status = load_environment(&loaded[i], &error);
    if (!status) // from here on no file is in question
        error = (struct rb_error){0};
    if (!status)
        status = check_same_machine(runs[0], runs[1], &error);
    if (!status)
        status = compare(arguments, runs, &code, &error);
    rb_timings_free(&loaded[0].samples);
    rb_timings_free(&loaded[1].samples);
    return status ? rb_report(status, &error) : code;
}
