#include "cli/commands.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_pixel = {
    .name = "pixel",
    .summary = "print the tree of rays of one pixel",
    .synopsis = "SCENE X Y [options]",
    .text = RB_HELP_SCENE
    "\n\n"
    "X counts from the left, Y from the top, both from 0. Each ray is printed with its kind,\n"
    "what it hit, its weight in the pixel, the verdict on each light and its local\n"
    "colour, by the same kernels and with the same result as in a whole frame.\n\n"
    "  raybench pixel mount_low 200 200\n"
    "  raybench pixel balls_high 256 256 --depth 3 --variant naive",
    .positional_min = 3,
    .positional_max = 3,
    .groups = (const struct rb_option *const[]){rb_options_settings, rb_options_levels,
                                                rb_options_variant, rb_options_threads,
                                                rb_options_strict, NULL},
    .run = run,
};

static const char *const kind_names[RB_KIND_COUNT] = {
    [RB_SPHERE] = "sphere", [RB_TRIANGLE] = "triangle", [RB_CONE] = "cone", [RB_PLANE] = "plane"};

static void indent(int bounce)
{
    printf("%*s", 4 * bounce, "");
}

static void print_ray(void *user, const struct rb_pixel_ray *ray)
{
    const struct rb_scene *scene = user;
    const char *kind = ray->path == 1 ? "camera" : ray->path % 2 ? "refracted" : "reflected";
    if (ray->path == 1 && ray->sample)
        printf("sample %" PRIu32 "\n", ray->sample);
    indent(ray->bounce);
    printf("%s ray, bounce %d, weight %.6g: from (%.6g %.6g %.6g) along (%.6g %.6g %.6g)\n", kind,
           ray->bounce, (double)ray->weight, (double)ray->o.x, (double)ray->o.y, (double)ray->o.z,
           (double)ray->d.x, (double)ray->d.y, (double)ray->d.z);
    indent(ray->bounce);
    if (ray->prim == RB_NONE) {
        printf("  misses\n");
        return;
    }
    enum rb_kind shape = rb_scene_kind(scene, ray->prim);
    printf("  hits %s %" PRIu32 " (id %" PRIu32 ") at distance %.6g, normal (%.6g %.6g %.6g)%s\n",
           kind_names[shape], ray->prim - scene->first[shape], ray->prim, (double)ray->t,
           (double)ray->n.x, (double)ray->n.y, (double)ray->n.z,
           ray->total_reflection ? ", total internal reflection" : "");
}

static void print_shadow(void *user, const struct rb_pixel_ray *ray,
                         const struct rb_pixel_shadow *shadow)
{
    (void)user;
    indent(ray->bounce);
    printf("  light %" PRIu32 " sample %" PRIu32 ": ", shadow->light, shadow->sample);
    if (!shadow->faces)
        printf("behind the surface\n");
    else if (shadow->occluded)
        printf("in shadow\n");
    else
        printf("visible, adds (%.6g %.6g %.6g)\n", (double)shadow->color[0],
               (double)shadow->color[1], (double)shadow->color[2]);
}

static void print_local(void *user, const struct rb_pixel_ray *ray, const float added[3])
{
    double weight = (double)ray->weight;
    (void)user;
    indent(ray->bounce);
    printf("  %s colour ", ray->prim == RB_NONE ? "background" : "local");
    if (weight > 0)
        printf("(%.6g %.6g %.6g) x weight = ", (double)added[0] / weight, (double)added[1] / weight,
               (double)added[2] / weight);
    printf("(%.6g %.6g %.6g)\n", (double)added[0], (double)added[1], (double)added[2]);
}

static bool parse_coordinate(const char *text, int limit, int *value)
{
    size_t digits = strspn(text, "0123456789");
    *value = digits <= 9 ? atoi(text) : limit;
    return digits > 0 && text[digits] == '\0' && *value < limit;
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_scene scene;
    struct rb_renderer *renderer;
    int code = rb_open_renderer(arguments, &scene, &renderer);
    if (code)
        return code;
    const struct rb_settings *settings = rb_renderer_settings(renderer);
    int x, y;
    if (parse_coordinate(arguments->positional[1], settings->width, &x) &&
        parse_coordinate(arguments->positional[2], settings->height, &y)) {
        struct rb_pixel_observer observer = {&scene, print_ray, print_shadow, print_local};
        float color[3];
        rb_renderer_pixel(renderer, x, y, &observer, color);
        printf("pixel (%d, %d) = (%.9g %.9g %.9g)\n", x, y, (double)color[0], (double)color[1],
               (double)color[2]);
    } else {
        struct rb_error error = {0};
        rb_error_set(&error, RB_INVALID, "no pixel (%s, %s) in %d x %d", arguments->positional[1],
                     arguments->positional[2], settings->width, settings->height);
        code = rb_report(RB_INVALID, &error);
    }
    rb_renderer_free(renderer);
    rb_scene_free(&scene);
    return code;
}
