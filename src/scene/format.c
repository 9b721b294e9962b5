// "%g" by way of a six-digit integer.
//
// Where "%g" means fixed notation, x is brought to s = x * 10^k in [1e5, 1e6]; the integer nearest
// to it holds the six digits. Why this is exact, with t the true product:
//   - 10^k is a double for k <= 22, so s is t rounded once: |s - t| <= 2^-34, as s < 2^20.
//   - s - floor(s) - 1/2 is exact. Further than 2^-34 from 0, its sign is the sign for t as well.
//     Nearer, t - s is added: a fused multiply-add gives it without error, and a sum of two doubles
//     never rounds to 0 or across it. What is 0 then is a true tie, and goes to the even digit.
//   - k is the least with s >= 1e5. Rounding is monotonic and 1e5 a double, so t is in [1e5, 1e6),
//     or else so near to 1e5 that either choice of k ends in the digits 100000.
// Everything else (scientific notation, infinities, NaN) goes to snprintf. The shortest-digits
// algorithms (Ryu, Grisu) solve another problem: they find how many digits to write.
#include "scene/format.h"

#include <math.h>
#include <stdio.h>

char *rb_format_number(char *out, double x)
{
    static const double power[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
    enum { DIGITS = 6 };

    if (signbit(x))
        *out++ = '-';
    x = fabs(x);
    if (x == 0.0) {
        *out++ = '0';
        return out;
    }
    // From 999999.5 on, the six digits round to 1e+06.
    if (!(x >= 1e-4 && x < 999999.5))
        return out + snprintf(out, RB_FORMAT_ROOM - 1, "%g", x);

    int k = x < 1.0 ? DIGITS : 0;
    double scaled = x * power[k];
    while (scaled < 1e5)
        scaled = x * power[++k];
    int number = (int)scaled;
    double rest = scaled - number - 0.5;
    if (fabs(rest) < 0x1p-30)
        rest += fma(x, power[k], -scaled);
    number += rest > 0.0 || (rest == 0.0 && number % 2 != 0);
    if (number == 1000000) {
        number = 100000;
        k--;
    }

    char digits[DIGITS];
    for (int i = DIGITS - 1; i >= 0; i--) {
        digits[i] = (char)('0' + number % 10);
        number /= 10;
    }
    int end = DIGITS;
    while (digits[end - 1] == '0')
        end--;

    int point = DIGITS - k; // digits before the point
    int i = 0;
    if (point <= 0) {
        *out++ = '0';
    } else {
        while (i < point)
            *out++ = digits[i++];
    }
    if (i < end) {
        *out++ = '.';
        for (int zeros = point; zeros < 0; zeros++)
            *out++ = '0';
        while (i < end)
            *out++ = digits[i++];
    }
    return out;
}
