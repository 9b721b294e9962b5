// The NFF reader: every entity and every layout; nff_mistakes.c has what can go wrong.
#define _POSIX_C_SOURCE 200809L
#include "scene/load.h"
#include "tests/unit/read_nff.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static bool near(float a, double b)
{
    return fabs((double)a - b) <= 1e-6 * fmax(1.0, fabs(b));
}

static bool near3(const float a[3], double x, double y, double z)
{
    return near(a[0], x) && near(a[1], y) && near(a[2], z);
}

static void test_entities(void)
{
    ok(read_text("b 0.078 0.361 0.753\n" VIEW "l 4 3 2 1 0.5 0.25\nl 1 -4 4\n"
                 "f 1 0.75 0.33 0.8 0.1 100000 0.5 1.5\n"
                 "s 1 2 3 0.5\ns 1 2 3 -0.5\n"
                 "c 0 0 0 1\n0 0 2 0.5\nc 0 0 0 -1 0 0 2 -1\n"
                 "p 3 0 0 0 1 0 0 0 1 0\n"
                 "f 1 1 1 1 0 1 0 0\n"
                 "pp 3 0 0 0 0 0 2 1 0 0 0 2 0 0 1 0 1 0 0\n"
                 "pl 12 12 -0.5 -12 12 -0.5 -12 -12 -0.5\n"
                 "gpl 0 0 1 0 1 1 1 0 1\n") == RB_OK,
       "every entity: %s", error.text);
    ok(warning_count == 0, "no warnings");
    const struct rb_camera *camera = &scene.camera;
    ok(camera->from[0] == 2.1 && camera->from[2] == 1.7 && camera->up[2] == 1.0 &&
           camera->angle_deg == 45.0 && camera->hither == 0.01 && camera->width == 512 &&
           camera->height == 384,
       "view");
    ok(near3(scene.background, 0.078, 0.361, 0.753), "background");
    ok(scene.light_count == 2 && near3(scene.lights[0].color, 1, 0.5, 0.25) &&
           near3(scene.lights[1].color, 1, 1, 1) && near3(scene.lights[1].position, 1, -4, 4),
       "lights with and without colour");
    ok(scene.material_count == 2 && near(scene.materials[0].t, 0.5) &&
           near(scene.materials[0].shine, 1e5) && scene.media_count == 2 &&
           near(scene.media[1], 1.5) && scene.materials[0].medium == 1 &&
           scene.materials[1].medium == 0,
       "materials and media");
    ok(scene.count[RB_SPHERE] == 2 && near(scene.spheres[1].radius, -0.5), "spheres");
    ok(scene.count[RB_CONE] == 2 && near(scene.cones[0].slope, -0.25) &&
           near3(scene.cones[0].axis, 0, 0, 1) && near(scene.cones[0].height, 2) &&
           scene.cones[0].inside == 0.0f && scene.cones[1].inside == 1.0f &&
           near(scene.cones[1].base_radius, 1) && scene.cones[0].low[0] < -1.0f &&
           near(0.1f * scene.cones[0].high[2], 0.2),
       "cones");
    ok(scene.count[RB_TRIANGLE] == 2 && near3(scene.triangle_normals[0], 0, 0, 1) &&
           scene.triangle_smooth[0] == RB_NONE && scene.triangle_smooth[1] == 0 &&
           near3(scene.smooth_normals[0][0], 0, 0, 1) && near3(scene.smooth_normals[0][2], 1, 0, 0),
       "triangles, flat and smooth");
    ok(scene.count[RB_PLANE] == 2 && near3(scene.planes[0].normal, 0, 0, 1) &&
           near(scene.planes[0].distance, -0.5) && near3(scene.planes[1].normal, 0, 0, -1) &&
           near(scene.planes[1].distance, -1),
       "planes");
    ok(scene.primitive_count == 8 && scene.bounded_count == 6 && scene.first[RB_CONE] == 4 &&
           scene.material_of[2] == 0 && scene.material_of[3] == 1 && scene.material_of[4] == 0 &&
           scene.material_of[7] == 1,
       "ids and materials");
    ok(read_text(VIEW "s 0 0 0 1") == RB_OK && scene.material_count == 1 &&
           scene.materials[0].kd > 0.0f,
       "a default material");
}

// The same scene in different layouts has the same hash.
static void test_layout(void)
{
    static const char *const layouts[] = {
        "v from 2.1 1.3 1.7 at 0 0 0 up 0 0 1 angle 45 hither 0.01 resolution 512 384 l 4 3 2 1 1 "
        "1 "
        "s 1 2 3 0.5 p 4 0 0 0 1 0 0 1 1 0 0 1 0",
        "v resolution 512 384\nhither .01 angle 45. up 0 0 1e0 at -0 0 0 from 2.1 13e-1 0.17E1\n"
        "l 4\n3\n2\n1 1\n\n1\ns 1 2\t3\v.5\np\n4\n0 0\n0 1 0 0 1 1\n0 0 1 0",
        "# a comment\n" VIEW "l 4 3 2 #no colour, or is there?\n 1 1 1\n#s 9 9 9 9\ns 1 2#glued\n"
        "3 0.5   \np 4#\n0 0 0 # one\n1 0 0\n#\n#\n1 1 0\n0 1 0\n# the end",
        "\xef\xbb\xbfv\r\nfrom 2.1 1.3 1.7\r\nat 0 0 0\r\nup 0 0 1\r\nangle 45\r\nhither 0.01\r\n"
        "resolution 512 384\r\nl 4 3 2\r\n# comment\r\ns 1 2 3 0.5\r\np 4\r\n0 0 0\r\n1 0 0\r\n"
        "1 1 0\r\n0 1 0\r\n",
        "v\rfrom 2.1 1.3 1.7\rat 0 0 0\rup 0 0 1\rangle 45\rhither 0.01\rresolution 512 384\r"
        "#old Mac\rl 4 3 2\rs 1 2 3 0.5\rp 4\r0 0 0\r1 0 0\r1 1 0\r0 1 0",
    };
    uint64_t hash = 0;
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
        enum rb_status status = read_text(layouts[i]);
        hash = i ? hash : scene.hash;
        ok(status == RB_OK && scene.hash == hash && scene.count[RB_TRIANGLE] == 2 &&
               warning_count == 0,
           "layout %zu: %s", i, error.text);
    }
    read_text(VIEW "l 4 3 2 s 1 2 3 0.5 p 4 0 0 0 1 0 0 1 1 0 0 1 1e-6");
    ok(scene.hash != hash, "another scene, another hash");
}

static double scene_area(int axis)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < scene.count[RB_TRIANGLE]; i++) {
        const struct rb_triangle *t = &scene.triangles[i];
        int x = (axis + 1) % 3, y = (axis + 2) % 3;
        sum +=
            ((double)t->v[1][x] - (double)t->v[0][x]) * ((double)t->v[2][y] - (double)t->v[0][y]) -
            ((double)t->v[1][y] - (double)t->v[0][y]) * ((double)t->v[2][x] - (double)t->v[0][x]);
    }
    return sum / 2.0;
}

static void test_polygons(void)
{
    ok(read_text(VIEW "p 4 0 0 0 4 0 0 4 4 0 3 1 0") == RB_OK && near((float)scene_area(2), 4) &&
           near3(scene.triangle_normals[0], 0, 0, 1) && near3(scene.triangle_normals[1], 0, 0, 1),
       "concave: area and orientation");
    ok(read_text(VIEW "p 4 0 3 1 0 4 4 0 4 0 0 0 0") == RB_OK && near((float)scene_area(0), -4) &&
           near3(scene.triangle_normals[1], -1, 0, 0),
       "concave, facing -x");
    ok(read_text(VIEW "pp 4 0 0 0 0 0 1 4 0 0 1 0 1 4 4 0 1 1 1 3 1 0 0 1 1") == RB_OK &&
           scene.count[RB_TRIANGLE] == 2 && near((float)scene_area(2), 4),
       "concave and smooth");
    for (uint32_t i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++) { // each corner has kept its own normal
            const float *v = scene.triangles[i].v[k];
            const float *n = scene.smooth_normals[scene.triangle_smooth[i]][k];
            ok((v[0] == 4.0f) == (fabsf(n[0]) > 0.5f) && (v[1] > 0.0f) == (fabsf(n[1]) > 0.5f),
               "normal of corner %d of triangle %u", k, i);
        }
    }
}

static void test_million_vertices(void)
{
    enum { COUNT = 1000000 };
    size_t room = 64 * (size_t)COUNT, length;
    char *text = malloc(room);
    length = (size_t)snprintf(text, room, VIEW "p %d\n", COUNT);
    for (int i = 0; i < COUNT; i++) {
        double angle = 2.0 * 3.141592653589793 * i / COUNT, radius = i % 4 < 2 ? 1.0 : 0.9;
        length += (size_t)snprintf(text + length, room - length, "%.9g %.9g 0\n",
                                   100.0 * radius * cos(angle), 100.0 * radius * sin(angle));
    }
    time_t start = time(NULL);
    enum rb_status status = read_bytes(text, length, false);
    double area = 1e4 * 0.95 * 0.95 * 3.141592653589793, taken = difftime(time(NULL), start);
    ok(status == RB_OK && fabs(scene_area(2) - area) < 0.01 * area && taken < 30.0,
       "a gear of %d vertices: area %.6g, %.0f s", COUNT, scene_area(2), taken);
    free(text);
}

static void test_numbers(void)
{
    static const char *const numbers[] = {
        "0.1",
        "1e-7",
        "123456.789",
        "900719925474.09931",
        "0.30000000000000004",
        "5e-324",
        "1E+5",
        ".5",
        "5.",
        "+1.5",
        "1e-400",
        "0e99999999",
        "00012.50",
        "179.76931348623157e9",
        "0.000000000000000000000000000012345",
        "1234567890123456789012345678901234567890e-30",
        "2.2250738585072011e-308",
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char text[400];
        snprintf(text, sizeof text,
                 "v from 1 2 3 at 0 0 0 up 0 0 1 angle 45 hither %s resolution 9 9", numbers[i]);
        enum rb_status status = read_text(text);
        ok(status == RB_OK && scene.camera.hither == strtod(numbers[i], NULL), "%s is %.17g",
           numbers[i], scene.camera.hither);
    }
}

static void test_load(void)
{
    struct rb_nff_options options = {0};
    struct rb_scene named = {0};
    enum rb_status status = rb_scene_load("balls_low", &options, &named, &error);
    ok(status == RB_OK && named.count[RB_SPHERE] == 10 && named.count[RB_PLANE] == 1,
       "a preset by name");
    uint64_t hash = named.hash;
    rb_scene_free(&named);
    status = rb_scene_load("balls1", &options, &named, &error);
    ok(status == RB_OK && named.hash == hash, "the same scene as a generated size");
    rb_scene_free(&named);
    status = rb_scene_load("/", &options, &named, &error);
    ok(status == RB_INVALID && strstr(error.text, "directory") && strcmp(error.file, "/") == 0,
       "a directory: %s", error.text);
    status = rb_scene_load("no_such_scene", &options, &named, &error);
    ok(status == RB_INVALID && strstr(error.text, "no such file"), "no file: %s", error.text);
    status = rb_scene_load("./no/such", &options, &named, &error);
    ok(status == RB_INVALID && strstr(error.text, "cannot open"), "no folder: %s", error.text);
    char path[] = "/tmp/rb_nff_XXXXXX";
    int file = mkstemp(path);
    ok(write(file, VIEW "s 0 0 0 1\n", sizeof VIEW + 9) > 0 && close(file) == 0 &&
           rb_scene_load(path, NULL, &named, NULL) == RB_OK && named.count[RB_SPHERE] == 1,
       "a file, without options");
    rb_scene_free(&named);
    unlink(path);
}

int main(void)
{
    test_entities();
    test_layout();
    test_numbers();
    test_polygons();
    test_load();
    test_million_vertices();
    rb_scene_free(&scene);
    ok(rb_memory_live_count() == 0, "no memory left behind");
    return done();
}
