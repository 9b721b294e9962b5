// The Test Anything Protocol, as perl's `prove` reads it: one line per check, a plan at the end.
#ifndef TESTS_TAP_H
#define TESTS_TAP_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

static int tap_count, tap_failed;

// One named check; returns `passed`, so that a caller can print details of a failure.
__attribute__((format(printf, 2, 3), unused)) static bool ok(bool passed, const char *format, ...)
{
    printf("%s %d - ", passed ? "ok" : "not ok", ++tap_count);
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
    fflush(stdout);
    tap_failed += !passed;
    return passed;
}

// A remark in the output; `prove -v` shows it.
__attribute__((format(printf, 1, 2), unused)) static void note(const char *format, ...)
{
    printf("# ");
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

// The plan and the exit code; `return done();` ends main.
__attribute__((unused)) static int done(void)
{
    printf("1..%d\n", tap_count);
    return tap_failed != 0;
}

#endif
