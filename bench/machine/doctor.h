// `raybench doctor`: is this machine fit for timing? A list of checks, each with what was found,
// why it matters and what to do, and a score.
//
// The score is 0 to 100: the share of the scored checks that are well, where ok counts 1, warn 1/2
// and bad 0. A check whose state is unknown counts neither way, and so do the checks on what else
// can be measured here (hardware counters, energy): they do not touch a timing. The score sums up
// the list; it is no error bound.
#ifndef RB_MACHINE_DOCTOR_H
#define RB_MACHINE_DOCTOR_H

#include "bench/data/json.h"
#include "bench/machine/machine.h"
#include "cli/options.h"

enum rb_check_state { RB_CHECK_OK, RB_CHECK_WARN, RB_CHECK_BAD, RB_CHECK_UNKNOWN };

struct rb_check {
    const char *name;
    const char *why; // it matters
    const char *fix; // a command, or that there is none
    bool scored;
    enum rb_check_state state;
    char found[2 * RB_FACT_TEXT_MAX]; // printable ASCII; of an unknown one, why it is
};

enum { RB_CHECKS_MAX = 24 };

struct rb_doctor {
    struct rb_check checks[RB_CHECKS_MAX];
    int count;
    int score; // -1: every check is unknown
};

extern const struct rb_command rb_command_doctor;

// Judges facts; reads nothing.
void rb_doctor_examine(struct rb_doctor *doctor, const struct rb_machine *machine);

// {"score": 0..100 or null, "checks": [{"name", "state", "scored", "found", "why", "fix"}]}; the
// fix is null where none is needed. `key` as in bench/data/json.h.
void rb_doctor_json(struct rb_json *json, const char *key, const struct rb_doctor *doctor);

// "ok", "warn", "bad", "unknown".
const char *rb_check_state_name(enum rb_check_state state);

#endif
