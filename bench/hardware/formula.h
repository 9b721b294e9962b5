// Simple arithmetic on named values, as files of events and of energies have it:
//
//     min(stalls, waits + stores) - 3 * misses / 2
//
// Numbers, names, + - * / with their usual precedence, a sign, parentheses, min(a, b), max(a, b).
#ifndef RB_HARDWARE_FORMULA_H
#define RB_HARDWARE_FORMULA_H

#include "base/status.h"

enum { RB_VALUES_MAX = 48, RB_VALUE_NAME_MAX = 32, RB_FORMULA_STEPS_MAX = 48 };

// What a formula is when it is parsed: steps on a stack.
struct rb_formula {
    int count; // 0: there is none
    struct rb_formula_step {
        char operation; // + - * /, ~ sign, m min, M max, n number, v value
        int value;      // index of the name
        double number;
    } steps[RB_FORMULA_STEPS_MAX];
};

// Names of values by index. Some are given; the others have a formula of those before them.
struct rb_values {
    int count;
    char names[RB_VALUES_MAX][RB_VALUE_NAME_MAX];
    struct rb_formula formulas[RB_VALUES_MAX];
};

// The index of a name, or -1.
int rb_values_find(const struct rb_values *values, const char *name);

// Adds a name without a formula. RB_INVALID with the reason if it is none, known already, or one
// too many.
enum rb_status rb_values_add(struct rb_values *values, const char *name, struct rb_error *error);

// Parses `text` as the formula of the value added last. RB_INVALID: `error` says what is wrong, and
// its column, which must be that of `text` before, where.
enum rb_status rb_values_define(struct rb_values *values, const char *text, struct rb_error *error);

// Fills in the values that have formulas. What comes of a value that is not known (NaN), or is
// divided by 0, is not known either.
void rb_values_compute(const struct rb_values *values, double numbers[RB_VALUES_MAX]);

#endif
