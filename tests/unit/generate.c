// The generators against what is known of the scenes they write. tests/cli/generate.t compares
// whole files with the originals.
#include "scene/generate.h"

#include "tests/unit/tap.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void test_names(void)
{
    static const struct {
        const char *name, *generator; // NULL: not a name
        int size;
    } cases[] = {
        {"balls_low", "balls", 1},
        {"balls_medium", "balls", 2},
        {"balls_high", "balls", 4},
        {"mount_low", "mount", 1},
        {"mount_high", "mount", 5},
        {"mount_very_high", "mount", 7},
        {"balls6", "balls", 6},
        {"balls0", "balls", 0},
        {"mount10", "mount", 10},
        {"mount99", "mount", 99}, // refused when written
        {"balls2147483647", "balls", INT_MAX},
        {"balls99999999999", "balls", INT_MAX},
        {"balls", NULL, 0},
        {"balls-1", NULL, 0},
        {"balls+1", NULL, 0},
        {"balls 1", NULL, 0},
        {"balls1 ", NULL, 0},
        {"balls6x", NULL, 0},
        {"balls1.5", NULL, 0},
        {"mount07", NULL, 0}, // one name per scene
        {"mount00", NULL, 0},
        {"balls_", NULL, 0},
        {"Balls6", NULL, 0},
        {"ball6", NULL, 0},
        {"teapot12", NULL, 0},
        {"6", NULL, 0},
        {"", NULL, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct rb_generator *generator = NULL;
        int size = -1;
        bool known = rb_scene_name_parse(cases[i].name, &generator, &size);
        if (cases[i].generator)
            ok(known && generator && strcmp(generator->name, cases[i].generator) == 0 &&
                   size == cases[i].size,
               "\"%s\" is %s of size %d", cases[i].name, cases[i].generator, cases[i].size);
        else
            ok(!known, "\"%s\" is no scene", cases[i].name);
    }
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++) {
        const struct rb_generator *generator = rb_generator_find(preset->generator);
        ok(generator && preset->size >= generator->size_min &&
               preset->size <= generator->size_max && preset->paper_s > 0.0,
           "preset %s can be made", preset->name);
    }
    ok(rb_generator_find("gears") == NULL, "an unknown generator is not found");
}

// What the generator writes, ready to read. NULL and a failed check if it does not.
static FILE *generate(const char *name, int size, enum rb_dialect dialect)
{
    struct rb_error error = {0};
    FILE *file = tmpfile();
    if (file && rb_generator_find(name)->write(file, size, dialect, &error) == RB_OK) {
        rewind(file);
        return file;
    }
    ok(false, "%s of size %d is written: %s", name, size, file ? error.text : "no temporary file");
    if (file)
        fclose(file);
    return NULL;
}

static void test_counts(void)
{
    for (const struct rb_generator *g = rb_generators; g->name; g++) {
        for (int size = g->size_min; size <= 5; size++) {
            for (int dialect = RB_DIALECT_P3D; dialect <= RB_DIALECT_SPD; dialect++) {
                FILE *file = generate(g->name, size, (enum rb_dialect)dialect);
                if (!file)
                    continue;
                long count = 0;
                char line[256];
                while (fgets(line, sizeof line, file))
                    count += line[0] == 's' || line[0] == 'p';
                fclose(file);
                ok((double)count == g->object_count(size), "%s size %d dialect %d: %ld objects",
                   g->name, size, dialect, count);
            }
        }
    }
    const struct rb_generator *balls = rb_generator_find("balls");
    const struct rb_generator *mount = rb_generator_find("mount");
    ok(balls->object_count(4) == 7382.0 && balls->object_count(7) == 5380841.0,
       "balls sizes 4 and 7 hold 7381 and 5380840 spheres and a floor");
    ok(mount->object_count(6) == 8196.0 && mount->object_count(10) == 2097156.0,
       "mount sizes 6 and 10 hold 8192 and 2097152 triangles and four spheres");
}

// Every sphere of the flake touches the one it grows on, which precedes it.
static void test_balls_touch(void)
{
    FILE *file = generate("balls", 4, RB_DIALECT_P3D);
    if (!file)
        return;
    double path[8][4] = {{0}}; // by depth: center and radius
    double worst = 0.0;
    char line[256];
    while (fgets(line, sizeof line, file)) {
        double s[4];
        if (sscanf(line, "s %lf %lf %lf %lf", &s[0], &s[1], &s[2], &s[3]) != 4)
            continue;
        long depth = lround(log(0.5 / s[3]) / log(3.0));
        memcpy(path[depth], s, sizeof s);
        if (depth == 0)
            continue;
        const double *parent = path[depth - 1];
        double dx = s[0] - parent[0], dy = s[1] - parent[1], dz = s[2] - parent[2];
        double gap = sqrt(dx * dx + dy * dy + dz * dz) - s[3] - parent[3];
        worst = fmax(worst, fabs(gap));
    }
    fclose(file);
    ok(worst < 4e-6, "spheres touch their parents within %g", worst);
}

// Heights of the (2^size + 1)^2 grid points, row by row; NULL if a point is missing or two
// triangles differ about it.
static double *read_mountain(int size, enum rb_dialect dialect)
{
    FILE *file = generate("mount", size, dialect);
    if (!file)
        return NULL;
    long side = (1L << size) + 1;
    double *heights = malloc((size_t)(side * side) * sizeof *heights);
    bool good = heights != NULL;
    for (long i = 0; good && i < side * side; i++)
        heights[i] = (double)NAN;
    char line[256];
    while (good && fgets(line, sizeof line, file)) {
        char *end = line;
        double x = strtod(line, &end);
        if (end == line)
            continue;
        double y = strtod(end, &end), z = strtod(end, &end);
        long column = lround((x + 1.0) / 2.0 * (double)(side - 1));
        long row = lround((y + 1.0) / 2.0 * (double)(side - 1));
        double *height = &heights[row * side + column];
        good = isnan(*height) || *height == z;
        *height = z;
    }
    for (long i = 0; good && i < side * side; i++)
        good = !isnan(heights[i]);
    fclose(file);
    if (good)
        return heights;
    ok(false, "mount size %d covers its grid without cracks", size);
    free(heights);
    return NULL;
}

static void test_mount(void)
{
    static const double expected[9] = {0,        -0.5481, 0,           -0.314742, 0.529551,
                                       0.657244, 0,       -0.00294902, 0};
    double *coarse = read_mountain(1, RB_DIALECT_P3D);
    ok(coarse && memcmp(coarse, expected, sizeof expected) == 0,
       "mount size 1: nine known heights");

    for (int size = 2; size <= 9; size++) {
        double *fine = read_mountain(size, size % 2 ? RB_DIALECT_SPD : RB_DIALECT_P3D);
        long side = (1L << size) + 1, coarse_side = side / 2 + 1;
        long kept = 0;
        double squares = 0.0; // of the displacement of the new midpoints of horizontal edges
        for (long row = 0; fine && coarse && row < side; row += 2) {
            for (long column = 0; column < side; column += 2)
                kept += fine[row * side + column] == coarse[row / 2 * coarse_side + column / 2];
            for (long column = 1; column < side; column += 2) {
                const double *z = &fine[row * side + column];
                squares += pow(*z - (z[-1] + z[1]) / 2.0, 2.0);
            }
        }
        ok(kept == coarse_side * coarse_side, "mount size %d keeps the points of size %d", size,
           size - 1);
        double deviation = sqrt(squares / (double)(coarse_side * (coarse_side - 1)));
        double rise = 0.5098245 * 2.0 / (double)(side - 1);
        // Of n deviates the spread is 1 +- 1 / sqrt(2 n); from size 6 on there are 1056 or more.
        if (size >= 6)
            ok(fabs(deviation / rise - 1.0) < 0.1,
               "mount size %d is displaced %.3f of what it should", size, deviation / rise);
        free(coarse);
        coarse = fine;
    }
    free(coarse);
}

static void test_out_of_range(void)
{
    for (const struct rb_generator *g = rb_generators; g->name; g++) {
        const int sizes[] = {g->size_min - 1, g->size_max + 1, INT_MIN, INT_MAX};
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            struct rb_error error = {0};
            char range[64];
            snprintf(range, sizeof range, "%s must be from %d to %d", g->name, g->size_min,
                     g->size_max);
            FILE *file = tmpfile();
            enum rb_status status = g->write(file, sizes[i], RB_DIALECT_P3D, &error);
            ok(status == RB_INVALID && strstr(error.text, range) && !strchr(error.text, '\n') &&
                   ftell(file) == 0,
               "%s size %d is refused: %s", g->name, sizes[i], error.text);
            fclose(file);
        }
        ok(g->write(stdout, -1, RB_DIALECT_P3D, NULL) == RB_INVALID,
           "%s is refused without an error to fill", g->name);
    }
}

// A full disk, and a stream that takes no output at all.
static void test_failing_stream(void)
{
    clock_t start = clock();
    for (const struct rb_generator *g = rb_generators; g->name; g++) {
        const int sizes[] = {g->size_min, g->size_max};
        for (size_t i = 0; i < 2; i++) {
            struct rb_error error = {0};
            FILE *full = fopen("/dev/full", "w");
            if (full) {
                enum rb_status status = g->write(full, sizes[i], RB_DIALECT_P3D, &error);
                ok(status == RB_FAILED && strstr(error.text, "cannot write") != NULL,
                   "%s size %d on a full disk: %s", g->name, sizes[i], error.text);
                fclose(full);
            } else {
                ok(true, "%s size %d on a full disk # SKIP no /dev/full", g->name, sizes[i]);
            }
            FILE *closed = fopen("/dev/null", "r");
            error = (struct rb_error){0};
            ok(g->write(closed, sizes[i], RB_DIALECT_P3D, &error) == RB_FAILED && error.text[0],
               "%s size %d on a stream for reading: %s", g->name, sizes[i], error.text);
            fclose(closed);
        }
    }
    // The largest sizes alone would take a quarter of a minute.
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    ok(seconds < 1.0, "failing streams end the work early: %.3f s", seconds);
}

int main(void)
{
    test_names();
    test_counts();
    test_balls_touch();
    test_mount();
    test_out_of_range();
    test_failing_stream();
    return done();
}
