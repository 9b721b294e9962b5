// `balls`, the sphereflake: a sphere carries nine of a third its radius, three around its pole and
// six around its equator, and each of them does the same with its own pole pointing outwards.
// SPD = Standard Procedural Databases (Eric Haines, 1987).
//
// The sums are evaluated as the original program does: even the positions that should be 0 and come
// out as 1e-16 agree with its files, all but three numbers (another libm).
#include "scene/spd.h"

#include <math.h>

enum { CHILD_COUNT = 9 };

struct flake {
    FILE *out;
    double children[CHILD_COUNT][3]; // directions of the children of a sphere that points along +z
};

// Three edges of a cuboctahedron, tilted so that the first is as far above the equator as the other
// two lie in it, and their turns by 120 and 240 degrees.
static void place_children(double children[CHILD_COUNT][3])
{
    const double d = 1.0 / sqrt(2.0);
    const double edges[3][3] = {{d, d, 0.0}, {d, 0.0, -d}, {0.0, d, -d}};
    const double axis[3] = {d, -d, 0.0}, z[3] = {0.0, 0.0, 1.0};
    double tilt[3][3], turn[3][3];
    rb_spd_rotation(tilt, axis, asin(2.0 / sqrt(6.0)));
    for (int set = 0; set < 3; set++) {
        rb_spd_rotation(turn, z, set * 2.0 * RB_SPD_PI / 3.0);
        for (int i = 0; i < 3; i++) {
            double tilted[3];
            rb_spd_transform(tilted, edges[i], tilt);
            rb_spd_transform(children[3 * set + i], tilted, turn);
        }
    }
}

// The rotation that takes +z to `direction`.
static void rotate_from_z(double matrix[3][3], const double direction[3])
{
    double x = direction[0], y = direction[1], z = direction[2];
    if (z >= 0.9999) {
        const double any[3] = {0.0, 0.0, 1.0};
        rb_spd_rotation(matrix, any, 0.0);
    } else if (z <= -0.9999) {
        const double across[3] = {0.0, 1.0, 0.0};
        rb_spd_rotation(matrix, across, RB_SPD_PI);
    } else {
        double length = sqrt(x * x + y * y);
        const double across[3] = {-y / length, x / length, 0.0};
        rb_spd_rotation(matrix, across, acos(z));
    }
}

static void write_flake(const struct flake *flake, int depth, const double center[3], double radius,
                        const double direction[3])
{
    rb_spd_write_sphere(flake->out, center, radius);
    if (depth == 0 || ferror(flake->out))
        return;
    double matrix[3][3];
    rotate_from_z(matrix, direction);
    double distance = radius * (1.0 + 1.0 / 3.0);
    for (int i = 0; i < CHILD_COUNT; i++) {
        double offset[3], child[3], outwards[3];
        rb_spd_transform(offset, flake->children[i], matrix);
        for (int j = 0; j < 3; j++) {
            child[j] = offset[j] * distance + center[j];
            outwards[j] = (child[j] - center[j]) / distance;
        }
        write_flake(flake, depth - 1, child, radius * (1.0 / 3.0), outwards);
    }
}

static void write_header(FILE *out, int size, enum rb_dialect dialect)
{
    bool spd = dialect == RB_DIALECT_SPD;
    const char *color = spd ? "" : " 1 1 1";
    fputs("b 0.078 0.361 0.753\n"
          "v\n"
          "from 2.1 1.3 1.7\n"
          "at 0 0 0\n"
          "up 0 0 1\n"
          "angle 45\n"
          "hither 0.01\n"
          "resolution 512 512\n",
          out);
    fprintf(out, "l 4 3 2%s\nl 1 -4 4%s\nl -3 1 5%s\n", color, color, color);
    fputs("f 1 0.75 0.33 0.8 0 100000 0 1\n", out);
    fputs(spd ? "p 4\n12 12 -0.5\n-12 12 -0.5\n-12 -12 -0.5\n12 -12 -0.5\n"
              : "pl 12 12 -0.5 -12 12 -0.5 -12 -12 -0.5\n",
          out);
    // The course polished its two small files.
    const char *finish = "0.5 3.0827";
    if (!spd && size == 1)
        finish = "0.5 30.0827";
    if (!spd && size == 2)
        finish = "0.7 190.0827";
    fprintf(out, "f 1 0.9 0.7 0.5 %s 0 1\n", finish);
}

enum rb_status rb_balls_write(FILE *out, int size, enum rb_dialect dialect, struct rb_error *error)
{
    enum rb_status status = rb_spd_begin("balls", size, error);
    if (status != RB_OK)
        return status;
    write_header(out, size, dialect);
    struct flake flake = {.out = out};
    place_children(flake.children);
    write_flake(&flake, size, (const double[3]){0.0, 0.0, 0.0}, 0.5,
                (const double[3]){0.0, 0.0, 1.0});
    return rb_spd_end(out, error);
}

// 1 + 9 + ... + 9^size spheres and the floor.
double rb_balls_count(int size)
{
    return (pow(9.0, size + 1) - 1.0) / 8.0 + 1.0;
}
