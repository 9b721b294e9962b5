// `mount`: a fractal mountain by midpoint displacement on a square grid, and four glass spheres
// above it. SPD = Standard Procedural Databases (Eric Haines, 1987).
//
// A point's height is the mean of its neighbours plus a Gaussian deviate whose seed is a function
// of the point's position alone. So cells that share an edge agree on its midpoint without sharing
// data, nothing but the recursion's path is in memory, and every size is the same mountain refined.
#include "scene/spd.h"

#include <math.h>
#include <string.h>

// The random part of a midpoint's height per unit of half the edge: sqrt(ratio^2 - 1), where ratio
// = 2 / exp(ln 2 / (D - 1)) = 2^(1/6) for the fractal dimension D = 2.2.
static const double roughness = 0.50982452853395865;

struct mountain {
    FILE *out;
    int size;
    int cells; // per side
};

// Heights of the corners of a square, counter-clockwise from the lower left.
struct corners {
    double ll, lr, ur, ul;
};

static unsigned shift(unsigned x, int left)
{
    return left >= 0 ? x << left : x >> -left;
}

// The original's seed of grid point (x, y). It is a function of position, because doubling x and y
// while size grows by one cancels out. But beyond size 7 the original shifts by a negative amount,
// which C leaves undefined (on x86-64 the mountain becomes another one). Here that is a shift to
// the right by as much, which cancels out too: every size refines the same mountain. Up to size 7
// the first term does not reach the 16 bits that are kept.
static unsigned seed(int size, unsigned x, unsigned y)
{
    unsigned hash = shift(x, 23 - size) + shift(y, 15 - size) + shift(x, 7 - size);
    return 21u + (hash & 0xffff);
}

// One Gaussian deviate: the polar method on a linear congruential generator (Numerical Recipes). r
// is never 0: that takes 67228 twice in a row, and it is followed by 95639.
static double gaussian(unsigned state)
{
    const unsigned modulus = 134456;
    double v1, r;
    do {
        unsigned first = (28411 + 8121 * state) % modulus;
        state = (28411 + 8121 * first) % modulus;
        v1 = 2.0 * first / modulus - 1.0;
        double v2 = 2.0 * state / modulus - 1.0;
        r = v1 * v1 + v2 * v2;
    } while (r >= 1.0);
    return v1 * sqrt(-2.0 * log(r) / r);
}

static double displacement(const struct mountain *mountain, int x, int y)
{
    return gaussian(seed(mountain->size, (unsigned)x, (unsigned)y));
}

enum { LINE_ROOM = RB_SPD_POINT_ROOM + 1 };

struct line {
    char text[LINE_ROOM];
    size_t length;
};

static struct line vertex(const struct mountain *mountain, int x, int y, double z)
{
    const double point[3] = {-1.0 + x * 2.0 / mountain->cells, -1.0 + y * 2.0 / mountain->cells, z};
    struct line line;
    char *end = rb_spd_format_point(line.text, point);
    *end++ = '\n';
    line.length = (size_t)(end - line.text);
    return line;
}

static char *append_triangle(char *out, const struct line *a, const struct line *b,
                             const struct line *c)
{
    const struct line *const lines[3] = {a, b, c};
    memcpy(out, "p 3\n", 4);
    out += 4;
    for (int i = 0; i < 3; i++) {
        memcpy(out, lines[i]->text, lines[i]->length);
        out += lines[i]->length;
    }
    return out;
}

static void write_cell(const struct mountain *mountain, int x, int y, struct corners z)
{
    struct line ll = vertex(mountain, x, y, z.ll), lr = vertex(mountain, x + 1, y, z.lr);
    struct line ur = vertex(mountain, x + 1, y + 1, z.ur), ul = vertex(mountain, x, y + 1, z.ul);
    char text[2 * (4 + 3 * LINE_ROOM)];
    char *end = append_triangle(text, &ll, &lr, &ur);
    end = append_triangle(end, &ur, &ul, &ll);
    fwrite(text, 1, (size_t)(end - text), mountain->out);
}

// The square of `width` cells whose lower left corner is grid point (x, y).
static void write_square(const struct mountain *mountain, int width, int x, int y, struct corners z)
{
    if (ferror(mountain->out))
        return;
    if (width == 1) {
        write_cell(mountain, x, y, z);
        return;
    }
    int half = width / 2;
    double rise = half * 2.0 / mountain->cells * roughness;
    double lower = (z.ll + z.lr) / 2.0 + rise * displacement(mountain, x + half, y);
    double right = (z.lr + z.ur) / 2.0 + rise * displacement(mountain, x + width, y + half);
    double upper = (z.ur + z.ul) / 2.0 + rise * displacement(mountain, x + half, y + width);
    double left = (z.ul + z.ll) / 2.0 + rise * displacement(mountain, x, y + half);
    double middle = (z.ll + z.lr + z.ur + z.ul) / 4.0 +
                    1.4142136 * rise * displacement(mountain, x + half, y + half);
    write_square(mountain, half, x, y, (struct corners){z.ll, lower, middle, left});
    write_square(mountain, half, x + half, y, (struct corners){lower, z.lr, right, middle});
    write_square(mountain, half, x + half, y + half, (struct corners){middle, right, z.ur, upper});
    write_square(mountain, half, x, y + half, (struct corners){left, middle, upper, z.ul});
}

// Four spheres at the corners of a regular tetrahedron whose edge is 0.17 * 2: they touch. The
// course shrank three of them a little.
static void write_spheres(FILE *out, enum rb_dialect dialect)
{
    const double course_radii[4] = {0.17, 0.169, 0.168, 0.167};
    const double center[3] = {-0.8, 0.8, 1.0}, z[3] = {0.0, 0.0, 1.0};
    const double diagonal[3] = {1.0 / sqrt(2.0), 1.0 / sqrt(2.0), 0.0};
    const double top[3] = {0.0, 0.0, 0.17 * sqrt(1.5)};
    double lower[3], matrix[3][3];
    rb_spd_rotation(matrix, diagonal, acos(-1.0 / 3.0));
    rb_spd_transform(lower, top, matrix);
    for (int i = 0; i < 4; i++) {
        double offset[3] = {top[0], top[1], top[2]};
        if (i > 0) {
            rb_spd_rotation(matrix, z, (i - 1) * 2.0 * RB_SPD_PI / 3.0);
            rb_spd_transform(offset, lower, matrix);
        }
        for (int j = 0; j < 3; j++)
            offset[j] += center[j];
        rb_spd_write_sphere(out, offset, dialect == RB_DIALECT_SPD ? 0.17 : course_radii[i]);
    }
}

static void write_header(FILE *out, int size, enum rb_dialect dialect)
{
    bool spd = dialect == RB_DIALECT_SPD;
    const char *color = "";
    if (!spd)
        color = size < 7 ? " 1.0 1.0 1.0" : " 1 1 1"; // both spellings are the course's
    fputs("b 0.078 0.361 0.753\n"
          "v\n"
          "from -1.6 1.6 1.7\n"
          "at 0 0 0\n"
          "up 0 0 1\n"
          "angle 45\n"
          "hither 0.01\n"
          "resolution 512 512\n",
          out);
    fprintf(out, "l -100 -100 100%s\n", color);
    fprintf(out, "f 1 1 1 0.1 0.1 101.148 0.9 %s\n", spd ? "1.5" : "1.2");
    write_spheres(out, dialect);
    fputs("f 0.5 0.45 0.35 1 0 100000 0 0\n", out);
}

enum rb_status rb_mount_write(FILE *out, int size, enum rb_dialect dialect, struct rb_error *error)
{
    enum rb_status status = rb_spd_begin("mount", size, error);
    if (status != RB_OK)
        return status;
    write_header(out, size, dialect);
    struct mountain mountain = {.out = out, .size = size, .cells = 1 << size};
    write_square(&mountain, mountain.cells, 0, 0, (struct corners){0});
    return rb_spd_end(out, error);
}

// Two triangles per cell and the spheres.
double rb_mount_count(int size)
{
    return 2.0 * pow(4.0, size) + 4.0;
}
