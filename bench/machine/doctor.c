// `raybench doctor` as a command: the list on the terminal or as JSON.
#define _POSIX_C_SOURCE 200809L
#include "bench/machine/doctor.h"

#include "cli/commands.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--json", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, json), 0, 0, "as a JSON object"},
    {"--root", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, root), 0, 0,
     "judge the copy of a machine's proc and sys in DIR"},
    {.name = NULL},
};

const struct rb_command rb_command_doctor = {
    .name = "doctor",
    .summary = "tell what on this machine spoils timings, and what to do about it",
    .synopsis = "[--json] [--root DIR]",
    .text = "One line per check: its state, what was found, why it matters for timings, and the\n"
            "command that mends it. Nothing is changed, and the exit code is 0 whatever is found.\n"
            "\n"
            "The score is 0 to 100: the share of the scored checks that are well, where ok counts\n"
            "1, warn a half and bad 0. A check whose state is unknown counts neither way, nor do\n"
            "the checks on what else can be measured (isolcpus, counters, energy). It sums up the\n"
            "list and goes into env.json of every run; it is no error bound.\n"
            "\n"
            "Colours are for terminals only; NO_COLOR turns them off.",
    .positional_min = 0,
    .positional_max = 0,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

static const struct {
    const char *name, *colour;
} states[] = {
    [RB_CHECK_OK] = {"ok", "\033[32m"},
    [RB_CHECK_WARN] = {"warn", "\033[33m"},
    [RB_CHECK_BAD] = {"bad", "\033[31m"},
    [RB_CHECK_UNKNOWN] = {"unknown", "\033[2m"},
};

const char *rb_check_state_name(enum rb_check_state state)
{
    return states[state].name;
}

static bool wants_fix(const struct rb_check *check)
{
    return check->state == RB_CHECK_WARN || check->state == RB_CHECK_BAD;
}

void rb_doctor_json(struct rb_json *json, const char *key, const struct rb_doctor *doctor)
{
    rb_json_object(json, key);
    if (doctor->score >= 0)
        rb_json_integer(json, "score", doctor->score);
    else
        rb_json_string(json, "score", NULL);
    rb_json_array(json, "checks");
    for (int i = 0; i < doctor->count; i++) {
        const struct rb_check *check = &doctor->checks[i];
        rb_json_object(json, NULL);
        rb_json_string(json, "name", check->name);
        rb_json_string(json, "state", rb_check_state_name(check->state));
        rb_json_bool(json, "scored", check->scored);
        rb_json_string(json, "found", check->found);
        rb_json_string(json, "why", check->why);
        rb_json_string(json, "fix", wants_fix(check) ? check->fix : NULL);
        rb_json_end_object(json);
    }
    rb_json_end_array(json);
    rb_json_end_object(json);
}

// https://no-color.org: set and not empty.
static bool use_colour(void)
{
    const char *no_color = getenv("NO_COLOR"), *terminal = getenv("TERM");
    return isatty(STDOUT_FILENO) && !(no_color && no_color[0]) &&
           !(terminal && strcmp(terminal, "dumb") == 0);
}

static void print_list(const struct rb_doctor *doctor)
{
    bool colour = use_colour();
    for (int i = 0; i < doctor->count; i++) {
        const struct rb_check *check = &doctor->checks[i];
        printf("%s%-8s%s %-13s  %s - %s", colour ? states[check->state].colour : "",
               rb_check_state_name(check->state), colour ? "\033[0m" : "", check->name,
               check->found, check->why);
        if (wants_fix(check))
            printf("; fix: %s", check->fix);
        printf("\n");
    }
    if (doctor->score >= 0)
        printf("\nscore    %d of 100\n", doctor->score);
    else
        printf("\nscore    unknown: nothing could be read\n");
}

static int refuse_root(const char *root)
{
    struct rb_error error = {0};
    int cause = errno;
    snprintf(error.file, sizeof error.file, "%.255s", root);
    rb_error_set(&error, RB_INVALID, "cannot read the folder: %s", strerror(cause));
    return rb_report(RB_INVALID, &error);
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_machine machine;
    struct rb_doctor doctor;
    if (arguments->root && access(arguments->root, R_OK | X_OK) != 0)
        return refuse_root(arguments->root);
    rb_machine_read(&machine, arguments->root ? arguments->root : "");
    rb_doctor_examine(&doctor, &machine);
    if (arguments->json) {
        struct rb_json json = {.out = stdout};
        rb_doctor_json(&json, NULL, &doctor);
    } else {
        print_list(&doctor);
    }
    return 0;
}
