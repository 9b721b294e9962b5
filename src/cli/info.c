#include "cli/commands.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_info = {
    .name = "info",
    .summary = "tell what is in a scene",
    .synopsis = "SCENE [--strict]",
    .text = RB_HELP_SCENE,
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){rb_options_strict, NULL},
    .run = run,
};

// Long lists are cut; their length is printed above them.
enum { SHOWN_MAX = 16 };

static void print_camera(const struct rb_camera *c)
{
    printf("camera      from %g %g %g  at %g %g %g  up %g %g %g\n", c->from[0], c->from[1],
           c->from[2], c->at[0], c->at[1], c->at[2], c->up[0], c->up[1], c->up[2]);
    printf("            angle %g degrees, hither %g (not used), %d x %d pixels\n", c->angle_deg,
           c->hither, c->width, c->height);
}

static double shown(float value)
{
    return (double)value;
}

static void print_lights(const struct rb_scene *scene)
{
    printf("lights      %" PRIu32 "\n", scene->light_count);
    for (uint32_t i = 0; i < scene->light_count && i < SHOWN_MAX; i++) {
        const struct rb_light *l = &scene->lights[i];
        printf("            at %g %g %g  colour %g %g %g\n", shown(l->position[0]),
               shown(l->position[1]), shown(l->position[2]), shown(l->color[0]), shown(l->color[1]),
               shown(l->color[2]));
    }
}

static void print_materials(const struct rb_scene *scene)
{
    printf("materials   %" PRIu32 "\n", scene->material_count);
    for (uint32_t i = 0; i < scene->material_count && i < SHOWN_MAX; i++) {
        const struct rb_material *m = &scene->materials[i];
        printf("            colour %g %g %g  Kd %g  Ks %g  Shine %g  T %g  ior %g\n",
               shown(m->color[0]), shown(m->color[1]), shown(m->color[2]), shown(m->kd),
               shown(m->ks), shown(m->shine), shown(m->t), shown(m->ior));
    }
}

static void print_bounds(const struct rb_scene *scene)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t id = 0; id < scene->bounded_count; id++) {
        float a[3], b[3];
        rb_scene_bounds(scene, id, a, b);
        for (int k = 0; k < 3; k++) {
            low[k] = fminf(low[k], a[k]);
            high[k] = fmaxf(high[k], b[k]);
        }
    }
    if (scene->bounded_count)
        printf("bounds      %g %g %g  to  %g %g %g%s\n", shown(low[0]), shown(low[1]),
               shown(low[2]), shown(high[0]), shown(high[1]), shown(high[2]),
               scene->count[RB_PLANE] ? ", and infinite planes" : "");
    else
        printf("bounds      %s\n", scene->count[RB_PLANE] ? "infinite planes only" : "no objects");
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_scene scene;
    int code = rb_open_scene(arguments->positional[0], arguments, &scene);
    if (code)
        return code;
    print_camera(&scene.camera);
    printf("background  %g %g %g\n", shown(scene.background[0]), shown(scene.background[1]),
           shown(scene.background[2]));
    print_lights(&scene);
    print_materials(&scene);
    printf("primitives  %" PRIu32 ": %" PRIu32 " spheres, %" PRIu32 " triangles, %" PRIu32
           " cones, %" PRIu32 " planes\n",
           scene.primitive_count, scene.count[RB_SPHERE], scene.count[RB_TRIANGLE],
           scene.count[RB_CONE], scene.count[RB_PLANE]);
    print_bounds(&scene);
    printf("memory      %zu bytes\n", scene.bytes);
    printf("hash        %016" PRIx64 "\n", scene.hash);
    rb_scene_free(&scene);
    return 0;
}
