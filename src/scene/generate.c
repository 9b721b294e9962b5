// The tables of generators and presets, and what the generators share.
//
// The generators follow the Standard Procedural Databases (Eric Haines, "A Proposal for Standard
// Graphics Environments", IEEE Computer Graphics and Applications 7(11), 1987).
#include "scene/generate.h"

#include "scene/format.h"
#include "scene/spd.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <string.h>

// The largest sizes are those that still make a file of a few gigabytes: 48 million spheres, 34
// million triangles.
const struct rb_generator rb_generators[] = {
    {"balls", "sphereflake: each sphere carries nine of a third its radius", 0, 8, rb_balls_write,
     rb_balls_count},
    {"mount", "fractal mountain under four glass spheres", 0, 12, rb_mount_write, rb_mount_count},
    {0},
};

const struct rb_preset rb_presets[] = {
    {"balls_low", "balls", 1, 3.0},
    {"balls_medium", "balls", 2, 14.0},
    {"balls_high", "balls", 4, 1005.0},
    {"mount_low", "mount", 1, 2.0},
    {"mount_high", "mount", 5, 272.0},
    {"mount_very_high", "mount", 7, 4183.0},
    {0},
};

const struct rb_generator *rb_generator_find(const char *name)
{
    for (const struct rb_generator *g = rb_generators; g->name; g++) {
        if (strcmp(g->name, name) == 0)
            return g;
    }
    return NULL;
}

// Decimal digits alone, without leading zeros, so that a scene has one name. Numbers beyond int
// become INT_MAX, which no generator can make either.
static bool parse_size(const char *text, int *size)
{
    if (*text == '\0' || (text[0] == '0' && text[1] != '\0'))
        return false;
    int value = 0;
    for (; *text; text++) {
        if (*text < '0' || *text > '9')
            return false;
        int digit = *text - '0';
        value = value > (INT_MAX - digit) / 10 ? INT_MAX : value * 10 + digit;
    }
    *size = value;
    return true;
}

bool rb_scene_name_parse(const char *name, const struct rb_generator **generator, int *size)
{
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++) {
        if (strcmp(preset->name, name) == 0) {
            *generator = rb_generator_find(preset->generator);
            *size = preset->size;
            return true;
        }
    }
    for (const struct rb_generator *g = rb_generators; g->name; g++) {
        size_t length = strlen(g->name);
        if (strncmp(g->name, name, length) == 0 && parse_size(name + length, size)) {
            *generator = g;
            return true;
        }
    }
    return false;
}

enum rb_status rb_spd_begin(const char *generator, int size, struct rb_error *error)
{
    const struct rb_generator *g = rb_generator_find(generator);
    if (size < g->size_min || size > g->size_max)
        return rb_error_set(error, RB_INVALID, "the size of %s must be from %d to %d", g->name,
                            g->size_min, g->size_max);
    errno = 0;
    return RB_OK;
}

enum rb_status rb_spd_end(FILE *out, struct rb_error *error)
{
    if (fflush(out) == 0 && !ferror(out))
        return RB_OK;
    return rb_error_set(error, RB_FAILED, "cannot write the scene: %s",
                        errno ? strerror(errno) : "output error");
}

void rb_spd_rotation(double matrix[3][3], const double axis[3], double angle)
{
    double x = axis[0], y = axis[1], z = axis[2];
    double c = cos(angle), s = sin(angle), k = 1.0 - c;
    matrix[0][0] = x * x + (1.0 - x * x) * c;
    matrix[0][1] = x * y * k + z * s;
    matrix[0][2] = x * z * k - y * s;
    matrix[1][0] = x * y * k - z * s;
    matrix[1][1] = y * y + (1.0 - y * y) * c;
    matrix[1][2] = y * z * k + x * s;
    matrix[2][0] = x * z * k + y * s;
    matrix[2][1] = y * z * k - x * s;
    matrix[2][2] = z * z + (1.0 - z * z) * c;
}

void rb_spd_transform(double result[3], const double v[3], double matrix[3][3])
{
    for (int i = 0; i < 3; i++)
        result[i] = v[0] * matrix[0][i] + v[1] * matrix[1][i] + v[2] * matrix[2][i];
}

_Static_assert(RB_SPD_POINT_ROOM >= 2 + 3 * RB_FORMAT_ROOM, "two spaces and three numbers");

char *rb_spd_format_point(char *out, const double point[3])
{
    out = rb_format_number(out, point[0]);
    *out++ = ' ';
    out = rb_format_number(out, point[1]);
    *out++ = ' ';
    return rb_format_number(out, point[2]);
}

void rb_spd_write_sphere(FILE *out, const double center[3], double radius)
{
    char line[2 + RB_SPD_POINT_ROOM + 1 + RB_FORMAT_ROOM + 1] = "s ";
    char *end = rb_spd_format_point(line + 2, center);
    *end++ = ' ';
    end = rb_format_number(end, radius);
    *end++ = '\n';
    fwrite(line, 1, (size_t)(end - line), out);
}
