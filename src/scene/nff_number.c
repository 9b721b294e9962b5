// Numbers of NFF: decimal, correctly rounded whatever the locale.
//
// A mantissa below 2^53 and a power of ten up to 10^22 are both exact in double precision, so one
// multiplication or division rounds correctly (Clinger 1990, "How to Read Floating Point Numbers
// Accurately"). That covers what programs write with %g; strtod does the rest, ten times slower.
#include "scene/nff_lex.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// A decimal number: digits x 10^exponent. Digits point into the word, which may hold one '.'.
struct decimal {
    bool negative, has_digits, exact; // exact: mantissa holds all digits
    uint64_t mantissa;
    const char *digits, *digits_end;
    long exponent;
};

// The digits and the point; returns the first byte behind them.
static const char *scan_digits(const char *at, const char *end, struct decimal *out)
{
    bool point = false;
    uint64_t mantissa = 0;
    long exponent = 0;
    int significant = 0;
    out->digits = at;
    for (; at < end; at++) {
        unsigned digit = (unsigned char)*at - (unsigned)'0';
        if (digit > 9) {
            if (*at != '.' || point)
                break;
            point = true;
            continue;
        }
        significant += significant > 0 || digit != 0;
        mantissa = mantissa * 10 + digit; // wraps from the 20th digit on, then not exact
        exponent -= point;
        out->has_digits = true;
    }
    out->digits_end = at;
    out->mantissa = mantissa;
    out->exponent = exponent;
    out->exact = significant <= 19;
    return at;
}

// An exponent, if there is one; returns the first byte behind it. Huge ones stop at a million.
static const char *scan_exponent(const char *at, const char *end, struct decimal *out)
{
    if (at == end || (*at != 'e' && *at != 'E'))
        return at;
    const char *e = at++;
    bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    if (at == end || !isdigit((unsigned char)*at))
        return e;
    long value = 0;
    for (; at < end && isdigit((unsigned char)*at); at++)
        value = value < 1000000 ? value * 10 + (*at - '0') : value;
    out->exponent += negative ? -value : value;
    return at;
}

// Through strtod, as an integer with an exponent: without a point there is no locale to ask.
static double slow_value(const struct decimal *number)
{
    char buffer[RB_NFF_WORD_MAX + 32];
    size_t length = 0;
    for (const char *at = number->digits; at < number->digits_end; at++) {
        if (*at != '.')
            buffer[length++] = *at;
    }
    snprintf(buffer + length, sizeof buffer - length, "e%ld", number->exponent);
    return strtod(buffer, NULL);
}

static double value_of(const struct decimal *number)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (number->exact && number->mantissa < (1ULL << 53)) {
        if (number->mantissa == 0)
            return 0.0;
        if (number->exponent >= 0 && number->exponent <= 22)
            return (double)number->mantissa * power[number->exponent];
        if (number->exponent < 0 && number->exponent >= -22)
            return (double)number->mantissa / power[-number->exponent];
    }
    return slow_value(number);
}

// Whether the word, behind a sign, starts with `prefix`, in any case.
static bool starts_with(const struct rb_nff_lexer *lexer, const char *prefix)
{
    const char *at = lexer->text, *end = at + lexer->length;
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    for (; *prefix; prefix++, at++) {
        if (at == end || tolower((unsigned char)*at) != *prefix)
            return false;
    }
    return true;
}

static const char *why_not(const struct rb_nff_lexer *lexer)
{
    if (starts_with(lexer, "nan") || starts_with(lexer, "inf"))
        return "is not finite";
    if (starts_with(lexer, "0x"))
        return "is hexadecimal; write a decimal number";
    if (memchr(lexer->text, ',', lexer->length) && lexer->token == RB_NFF_NUMBER)
        return "is not a number; write a decimal point, and blanks between numbers";
    return "is not a number";
}

const char *rb_nff_lex_number(const struct rb_nff_lexer *lexer, double *value)
{
    const char *at = lexer->text, *end = at + lexer->length;
    if (lexer->token != RB_NFF_NUMBER)
        return why_not(lexer);
    if (lexer->length > RB_NFF_WORD_MAX)
        return "is too long for a number";
    struct decimal number = {.negative = *at == '-'};
    if (*at == '-' || *at == '+')
        at++;
    at = scan_digits(at, end, &number);
    at = scan_exponent(at, end, &number);
    if (at != end || !number.has_digits)
        return why_not(lexer);
    double magnitude = value_of(&number);
    if (!isfinite(magnitude))
        return "is too large";
    *value = number.negative ? -magnitude : magnitude;
    return NULL;
}
