// Vectors in double precision and random numbers, for the reference and its tests.
#include "tests/support/reference.h"

#include <math.h>

double ref_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double ref_length(const double a[3])
{
    return sqrt(ref_dot(a, a));
}

void ref_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void ref_along(const double o[3], double t, const double d[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = o[k] + t * d[k];
}

bool ref_normalize(double a[3])
{
    double length = ref_length(a);
    if (!(length > 0.0))
        return false;
    for (int k = 0; k < 3; k++)
        a[k] /= length;
    return true;
}

void ref_widen(const float a[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k];
}

void ref_subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

void ref_edge(const float a[3], const float b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)b[k] - (double)a[k];
}

double ref_uniform(struct ref_random *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

double ref_between(struct ref_random *random, double low, double high)
{
    return low + (high - low) * ref_uniform(random);
}

uint32_t ref_below(struct ref_random *random, uint32_t limit)
{
    return (uint32_t)(ref_uniform(random) * limit);
}

void ref_direction(struct ref_random *random, double d[3])
{
    double z = ref_between(random, -1.0, 1.0), angle = ref_between(random, 0.0, 2.0 * acos(-1.0));
    double across = sqrt(1.0 - z * z);
    d[0] = across * cos(angle), d[1] = across * sin(angle), d[2] = z;
}
