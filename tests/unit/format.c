// rb_format_number against snprintf, byte for byte.
#include "scene/format.h"

#include "base/hash.h"
#include "tests/unit/tap.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static long tried, wrong;

static void try(double x)
{
    char expected[64], actual[RB_FORMAT_ROOM + 8];
    memset(actual, '#', sizeof actual);
    snprintf(expected, sizeof expected, "%g", x);
    size_t length = (size_t)(rb_format_number(actual, x) - actual);
    bool overrun = false;
    for (size_t i = RB_FORMAT_ROOM; i < sizeof actual; i++)
        overrun |= actual[i] != '#';
    bool same = length == strlen(expected) && memcmp(actual, expected, length) == 0;
    tried++;
    if (same && !overrun)
        return;
    if (wrong++ < 5)
        note("%a: expected \"%s\", got \"%.*s\"%s", x, expected, RB_FORMAT_ROOM, actual,
             overrun ? " and bytes past the room" : "");
}

static void try_around(double x)
{
    try(x);
    try(-x);
    try(nextafter(x, 0.0));
    try(nextafter(x, HUGE_VAL));
}

static void report(const char *what)
{
    ok(wrong == 0, "%s: %ld numbers", what, tried);
    tried = wrong = 0;
}

static uint64_t state;

static uint64_t next(void)
{
    return rb_mix(state += 0x9e3779b97f4a7c15u);
}

static double uniform(void)
{
    return (double)(next() >> 11) * 0x1p-53;
}

static double from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

int main(void)
{
    static const double special[] = {0.0,    DBL_MIN, DBL_TRUE_MIN, DBL_MAX,  HUGE_VAL, (double)NAN,
                                     1e-4,   1e-5,    999999.0,     999999.5, 1e6,      100000.0,
                                     1e22,   1e23,    0.5,          1.0 / 3,  0.1,      0.3,
                                     123456, 1234567, 0.000123456,  1e-16,    1e100,    -1e-308};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
        try_around(special[i]);
    report("special values");

    for (int exponent = -330; exponent <= 310; exponent++) {
        char text[32];
        static const char *const mantissas[] = {
            "1",        "9.99999", "9.999994999", "9.999995", "9.9999950001", "9.9999999",
            "1.000005", "5"};
        for (size_t i = 0; i < sizeof mantissas / sizeof *mantissas; i++) {
            snprintf(text, sizeof text, "%se%d", mantissas[i], exponent);
            try_around(strtod(text, NULL));
        }
    }
    report("powers of ten and their neighbours");

    // True ties are dyadic fractions whose seventh digit is a last 5.
    for (int bits = 0; bits <= 14; bits++) {
        for (int i = 0; i <= 16384; i++)
            try_around(ldexp(i, -bits));
    }
    for (long i = 0; i < 200000; i++)
        try(((double)(next() % 2000000) + 0.5) * (i % 2 ? 1.0 : 0.5));
    report("dyadic fractions, ties among them");

    // Seven digits ending in 5: as near to a tie as a double can be.
    state = 1;
    for (long i = 0; i < 300000; i++) {
        char text[32];
        snprintf(text, sizeof text, "%lu5e%d", (unsigned long)(100000 + next() % 900000),
                 (int)(next() % 14) - 12);
        try_around(strtod(text, NULL));
    }
    report("nearest doubles to decimal ties");

    for (long i = 0; i < 1000000; i++) {
        try(2.0 * uniform() - 1.0);
        try(ldexp(uniform() - 0.5, (int)(next() % 40) - 18));
    }
    report("random values of the usual sizes");

    for (long i = 0; i < 500000; i++)
        try(from_bits(next()));
    report("random bit patterns");

    return done();
}
