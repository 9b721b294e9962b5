#include "tests/support/zoo.h"

static void begin(struct rb_scene_builder *builder)
{
    *builder =
        (struct rb_scene_builder){.camera = {{4, 3, 2}, {0, 0, 0}, {0, 0, 1}, 45.0, 0.01, 64, 64},
                                  .background = {0.1f, 0.5f, 0.9f}};
    // The last two: at what the camera looks at, where soft lights have no direction, and inside of
    // the largest sphere.
    static const double lights[][3] = {
        {-100, -100, 100}, {3, 0, 0}, {0, 5, 0.5}, {0, 0, 0}, {0.5, 0.25, 0.5}};
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++)
        stage_check(rb_scene_add_light(
            builder, lights[i], (const double[3]){1.0, 0.25 * (double)i, 0.3}, &stage_failure));
}

// The next material: what follows in the scene has it. Sharp highlights without diffuse light are
// on large things: there alone it shows where a power underflows.
static void next_material(struct rb_scene_builder *builder)
{
    static const double kd[] = {0.8, 0.0, 0.5}, ks[] = {0.5, 1.0, 0.0, 1.0, 0.25};
    static const double shine[] = {0.0, 1.0, 0.5, 10.0, 3.0, 1e3, 77.7, 1e5}, t[] = {0.0, 0.5, 0.0};
    static const double ior[] = {1.0, 1.5, 0.7, 1.33, 2.4, 1.0001, 1e3};
    size_t i = builder->materials.count + 10;
    const double color[3] = {0.1 * (double)(i % 11), 1.0 - 0.05 * (double)(i % 21), 1.0};
    stage_check(rb_scene_add_material(builder, color, kd[(i / 8 * 2 + i) % 3], ks[i % 5],
                                      shine[i % 8], t[i / 2 % 3], ior[i % 7], &stage_failure));
}

static void sphere(struct rb_scene_builder *builder, double x, double y, double z, double r)
{
    next_material(builder);
    stage_check(rb_scene_add_sphere(builder, (const double[3]){x, y, z}, r, &stage_failure));
}

static void add_spheres(struct rb_scene_builder *builder)
{
    sphere(builder, 0.5, 0.25, 0.5, 0.75);
    sphere(builder, 0.5, 0.25, 0.5, 0.75);  // the same twice
    sphere(builder, 0.5, 0.25, 0.5, 0.5);   // concentric
    sphere(builder, 0.5, 0.25, 0.5, -0.75); // the same, from inside
    sphere(builder, -1.0, 0.25, 0.5, 0.75); // touching
    sphere(builder, -1.0, -1.0, 0.0, -0.4);
    sphere(builder, 1.0, 1.0, 1.0, 1e-3);
    sphere(builder, 1.0, -1.0, 1.0, 0.1);
}

// Squares of 0.5 in a plane across axis k, each of two triangles: flat boxes, shared edges, and
// planes, squares and edges of others in the same place.
static void add_squares(struct rb_scene_builder *builder, int k, double at, int count)
{
    for (int i = 0; i < 2 * count; i++) {
        double v[3][3], x = -1.0 + 0.5 * (i / 2 % 3), y = -1.0 + 0.5 * (i / 6);
        const double corner[4][2] = {{x, y}, {x + 0.5, y}, {x + 0.5, y + 0.5}, {x, y + 0.5}};
        for (int j = 0; j < 3; j++) {
            const double *c = corner[j == 0 ? 0 : j + i % 2];
            v[j][k] = at, v[j][(k + 1) % 3] = c[0], v[j][(k + 2) % 3] = c[1];
        }
        // Smooth: unlike normals, opposite ones that cancel, and almost.
        static const double normals[3][3][3] = {{{1, 0, 0}, {1, 1, 0}, {1, 0, 1}},
                                                {{0, 0, 1}, {0, 0, -1}, {0, 0, -1}},
                                                {{1, 0, 0}, {-1, 1e-6, 0}, {-1, 0, 1e-6}}};
        if (i % 3 == 0)
            next_material(builder);
        stage_check(rb_scene_add_triangle(builder, (const double(*)[3])v,
                                          i % 2 ? normals[i / 2 % 3] : NULL, &stage_failure));
    }
}

static void cone(struct rb_scene_builder *builder, const double base[3], double base_radius,
                 const double apex[3], double apex_radius)
{
    next_material(builder);
    stage_check(rb_scene_add_cone(builder, base, base_radius, apex, apex_radius, &stage_failure));
}

static void add_cones(struct rb_scene_builder *builder)
{
    const double low[3] = {1, 0, -1}, high[3] = {1, 0, 0.5}, aside[3] = {1.5, 0.75, 1.25};
    cone(builder, low, 0.25, high, 0.25);
    cone(builder, low, 0.25, high, 0.25); // the same twice
    cone(builder, low, 0.25, high, 0.0);  // with a tip
    cone(builder, low, 0.0, aside, 0.5);
    cone(builder, aside, -0.3, high, -0.1); // from inside
    cone(builder, low, 1e-3, aside, 1e-3);
}

static void add_planes(struct rb_scene_builder *builder)
{
    static const double planes[][3][3] = {{{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}, // a face of squares
                                          {{0, 0, -1}, {0, 1, -1}, {1, 0, -1}}, // its back
                                          {{9, 1, 0}, {9, 0, 1}, {8, 2, 1}}};
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
        next_material(builder);
        stage_check(rb_scene_add_plane(builder, planes[i], &stage_failure));
    }
}

void stage_zoo(struct stage *stage)
{
    struct rb_scene_builder builder;
    begin(&builder);
    add_spheres(&builder);
    add_squares(&builder, 2, -1.0, 6);
    add_squares(&builder, 2, -1.0, 3); // the same again
    add_squares(&builder, 0, -1.0, 3);
    add_cones(&builder);
    add_planes(&builder);
    stage_build(stage, &builder);
}

void stage_planes(struct stage *stage)
{
    struct rb_scene_builder builder;
    begin(&builder);
    add_planes(&builder);
    stage_build(stage, &builder);
}

void stage_empty(struct stage *stage)
{
    struct rb_scene_builder builder;
    begin(&builder);
    next_material(&builder);
    stage_build(stage, &builder);
}

static void stage_near(struct stage *stage)
{
    stage_soup(stage, 0.0);
}

static void stage_far(struct stage *stage)
{
    stage_soup(stage, 1000.0);
}

static void stage_far_spheres(struct stage *stage)
{
    stage_tiny(stage, 0.0);
}

static void stage_mount(struct stage *stage)
{
    stage_load(stage, "mount1");
}

void zoo_open(struct zoo_scene scenes[ZOO_COUNT])
{
    static const struct {
        const char *name;
        const struct ray_class *classes;
        void (*make)(struct stage *stage);
        uint32_t weight;
    } table[ZOO_COUNT] = {
        {"zoo", ray_classes_soup, stage_zoo, 6},
        {"soup", ray_classes_soup, stage_near, 4},
        {"soup+1000", ray_classes_shifted, stage_far, 1},
        {"tiny", ray_classes_tiny, stage_far_spheres, 1},
        {"mount1", ray_classes_mesh, stage_mount, 2},
        {"planes", NULL, stage_planes, 1},
        {"empty", NULL, stage_empty, 1},
    };
    for (int i = 0; i < ZOO_COUNT; i++) {
        scenes[i].name = table[i].name;
        scenes[i].classes = table[i].classes;
        scenes[i].weight = table[i].weight;
        table[i].make(&scenes[i].stage);
    }
}

void zoo_close(struct zoo_scene scenes[ZOO_COUNT])
{
    for (int i = 0; i < ZOO_COUNT; i++)
        stage_close(&scenes[i].stage);
}
