// What a gate found, for a person, for a pull request and for a program. Both tiers of the gate,
// `raybench gate` and `raybench regress`, report alike.
#ifndef RB_GATE_REPORT_H
#define RB_GATE_REPORT_H

#include "base/memory.h"
#include "bench/compare/timings.h"

// Exit codes. A failure of the machine gives no verdict, which is invalid.
enum {
    RB_GATE_FINE = 0,
    RB_GATE_REGRESSED = 1,
    RB_GATE_INVALID = 2,
    RB_GATE_INCONCLUSIVE = 3,
    RB_GATE_UNFIT = 4,
};

enum rb_moved {
    RB_MOVED_WORSE,
    RB_MOVED_UNDECIDED,
    RB_MOVED_BETTER,
    RB_MOVED_WAIVED,
    RB_MOVED_NOT,
    RB_MOVED_COUNT,
};

// One figure at one place, or a time. Texts belong to the files that were compared, which must
// outlive the report.
struct rb_gate_row {
    struct rb_timed_cell cell; // its key alone
    const char *kernel;
    int bounce; // -1: all of them
    const char *figure;
    const char *mode; // of the replay that shows it: "count"
    double base, head;
    double ratio, low, high; // head over base; low, high: NaN where it is exact
    double floor;            // ratios from 1 / floor to floor are noise; NaN where there is none
    enum rb_moved moved;
    char reason[128]; // of a waiver; "" else
};

enum { RB_GATE_TEXT_MAX = 512 };

// Zero-initialise; release with rb_gate_report_free.
struct rb_gate_report {
    const char *name; // of the command
    int code;
    char verdict[RB_GATE_TEXT_MAX];
    size_t counts[RB_MOVED_COUNT]; // of what was compared, rows or not
    struct rb_array rows;          // struct rb_gate_row, those worth showing
    struct rb_array notes;         // char[RB_GATE_TEXT_MAX]
    bool incomplete;               // for lack of memory
};

// Appends a row and counts it, or only counts it unless `shown`.
void rb_gate_report_add(struct rb_gate_report *report, const struct rb_gate_row *row, bool shown);
void rb_gate_report_note(struct rb_gate_report *report, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Sets the code and the line that says it.
void rb_gate_report_judge(struct rb_gate_report *report, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// "balls_high 64x64, depth 5, bvh, trace at bounce 1: nodes +3.1 %": the worst row, for a verdict.
void rb_gate_report_worst(const struct rb_gate_report *report, char text[RB_GATE_TEXT_MAX]);

// On standard output; and to files, where a path is not NULL. Returns the exit code: that of the
// report, or RB_GATE_INVALID if a file cannot be written, which is reported.
int rb_gate_report_put(const struct rb_gate_report *report, const char *markdown, const char *json);

void rb_gate_report_free(struct rb_gate_report *report);

#endif
