#include "bench/hardware/formula.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NESTED_MAX = 16 };

int rb_values_find(const struct rb_values *values, const char *name)
{
    for (int i = 0; i < values->count; i++)
        if (strcmp(values->names[i], name) == 0)
            return i;
    return -1;
}

static bool in_name(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

enum rb_status rb_values_add(struct rb_values *values, const char *name, struct rb_error *error)
{
    size_t length = 0;
    while (in_name(name[length]))
        length++;
    if (length == 0 || name[length] || length >= RB_VALUE_NAME_MAX ||
        isdigit((unsigned char)name[0]) || strcmp(name, "min") == 0 || strcmp(name, "max") == 0)
        return rb_error_set(error, RB_INVALID,
                            "expected a name of at most %d letters, digits and _, and not min or "
                            "max",
                            RB_VALUE_NAME_MAX - 1);
    if (rb_values_find(values, name) >= 0)
        return rb_error_set(error, RB_INVALID, "there is a %s already", name);
    if (values->count == RB_VALUES_MAX)
        return rb_error_set(error, RB_INVALID, "more than %d names", RB_VALUES_MAX);
    snprintf(values->names[values->count++], RB_VALUE_NAME_MAX, "%s", name);
    return RB_OK;
}

// A recursive descent over the text; `problem` stops it.
struct parser {
    const struct rb_values *values;
    struct rb_formula *formula;
    const char *at;
    int depth; // of parentheses and signs
    char problem[80];
};

static void fail(struct parser *p, const char *problem)
{
    if (!p->problem[0])
        snprintf(p->problem, sizeof p->problem, "%s", problem);
}

static void put(struct parser *p, char operation, int value, double number)
{
    if (p->formula->count == RB_FORMULA_STEPS_MAX)
        fail(p, "the formula is too long");
    else
        p->formula->steps[p->formula->count++] = (struct rb_formula_step){operation, value, number};
}

static void skip_blanks(struct parser *p)
{
    p->at += strspn(p->at, " \t");
}

static bool take(struct parser *p, char c)
{
    skip_blanks(p);
    bool there = *p->at == c && !p->problem[0];
    p->at += there;
    return there;
}

static void expect(struct parser *p, char c)
{
    char problem[] = "expected ?";
    problem[sizeof problem - 2] = c;
    if (!take(p, c))
        fail(p, problem);
}

static void parse_sum(struct parser *p);

static void parse_name(struct parser *p)
{
    char name[RB_VALUE_NAME_MAX];
    const char *start = p->at;
    size_t length = 0;
    while (in_name(start[length]))
        length++;
    snprintf(name, sizeof name, "%.*s", (int)length, start);
    bool least = strcmp(name, "min") == 0;
    if (least || strcmp(name, "max") == 0) {
        p->at += length;
        expect(p, '(');
        parse_sum(p);
        expect(p, ',');
        parse_sum(p);
        expect(p, ')');
        put(p, least ? 'm' : 'M', 0, 0);
        return;
    }
    // The last name is the one that is being defined.
    int value = length < sizeof name ? rb_values_find(p->values, name) : -1;
    if (value < 0 || value == p->values->count - 1)
        fail(p, "no value of this name before it");
    else
        p->at += length;
    put(p, 'v', value, 0);
}

static void parse_factor(struct parser *p)
{
    char *end;
    if (++p->depth > NESTED_MAX)
        fail(p, "too many parentheses");
    skip_blanks(p);
    if (p->problem[0]) {
        // nothing more
    } else if (take(p, '(')) {
        parse_sum(p);
        expect(p, ')');
    } else if (take(p, '-')) {
        parse_factor(p);
        put(p, '~', 0, 0);
    } else if (isdigit((unsigned char)*p->at) || *p->at == '.') {
        put(p, 'n', 0, strtod(p->at, &end));
        if (end == p->at)
            fail(p, "expected a number");
        p->at = end;
    } else if (in_name(*p->at)) {
        parse_name(p);
    } else {
        fail(p, "expected a number, a name or (");
    }
    p->depth--;
}

static void parse_product(struct parser *p)
{
    parse_factor(p);
    for (;;) {
        char operation = take(p, '*') ? '*' : take(p, '/') ? '/' : 0;
        if (!operation)
            return;
        parse_factor(p);
        put(p, operation, 0, 0);
    }
}

static void parse_sum(struct parser *p)
{
    parse_product(p);
    for (;;) {
        char operation = take(p, '+') ? '+' : take(p, '-') ? '-' : 0;
        if (!operation)
            return;
        parse_product(p);
        put(p, operation, 0, 0);
    }
}

enum rb_status rb_values_define(struct rb_values *values, const char *text, struct rb_error *error)
{
    struct rb_formula formula = {.count = 0};
    struct parser p = {.values = values, .formula = &formula, .at = text};
    parse_sum(&p);
    skip_blanks(&p);
    if (*p.at)
        fail(&p, "expected + - * / or the end");
    if (p.problem[0]) {
        error->column += (unsigned long)(p.at - text);
        return rb_error_set(error, RB_INVALID, "%s", p.problem);
    }
    values->formulas[values->count - 1] = formula;
    return RB_OK;
}

static double apply(char operation, double a, double b)
{
    switch (operation) {
    case '+':
        return a + b;
    case '-':
        return a - b;
    case '*':
        return a * b;
    case '/':
        return b != 0 ? a / b : (double)NAN;
    default: // fmin and fmax would forget a NaN
        return isnan(a) || isnan(b) ? (double)NAN : operation == 'm' ? fmin(a, b) : fmax(a, b);
    }
}

// The parser makes no formula that takes more than is there, or that leaves more than one number.
static double evaluate(const struct rb_formula *formula, const double *numbers)
{
    double stack[RB_FORMULA_STEPS_MAX + 2] = {0};
    int top = 0;
    for (int i = 0; i < formula->count; i++) {
        const struct rb_formula_step *step = &formula->steps[i];
        if (step->operation == 'n') {
            stack[top++] = step->number;
        } else if (step->operation == 'v') {
            stack[top++] = numbers[step->value];
        } else if (step->operation == '~') {
            stack[top - 1] = -stack[top - 1];
        } else {
            top--;
            stack[top - 1] = apply(step->operation, stack[top - 1], stack[top]);
        }
    }
    return stack[0];
}

void rb_values_compute(const struct rb_values *values, double numbers[RB_VALUES_MAX])
{
    for (int i = 0; i < values->count; i++)
        if (values->formulas[i].count)
            numbers[i] = evaluate(&values->formulas[i], numbers);
}
