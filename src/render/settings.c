#include "render/settings.h"

#include "render/variants.h"

#include <math.h>

static enum rb_status check_range(const char *name, int value, int low, int high,
                                  struct rb_error *error)
{
    if (value >= low && value <= high)
        return RB_OK;
    return rb_error_set(error, RB_INVALID, "%s must be from %d to %d, not %d", name, low, high,
                        value);
}

static enum rb_status check_number(const char *name, double value, struct rb_error *error)
{
    if (value >= 0 && value <= 1e6)
        return RB_OK;
    return rb_error_set(error, RB_INVALID, "%s must be from 0 to 1e6, not %g", name, value);
}

static void set_default(int *value, int fallback)
{
    *value = *value ? *value : fallback;
}

enum rb_status rb_settings_complete(struct rb_settings *s, const struct rb_scene *scene,
                                    struct rb_error *error)
{
    // SPD traces the corners of the pixels: one more than pixels.
    set_default(&s->width, scene->camera.width + s->spd);
    set_default(&s->height, scene->camera.height + s->spd);
    set_default(&s->depth, RB_DEPTH_DEFAULT);
    set_default(&s->aa, 1);
    set_default(&s->light_samples, 1);
    set_default(&s->tile, RB_TILE_DEFAULT);
    set_default(&s->threads, rb_threads_default());
    if (s->light_scale == 0)
        s->light_scale = scene->light_count ? 1.0 / sqrt(scene->light_count) : 1.0;
    const struct {
        const char *name;
        int value, low, high;
    } ranges[] = {
        {"the width", s->width, 1 + s->spd, RB_SIZE_MAX + s->spd},
        {"the height", s->height, 1 + s->spd, RB_SIZE_MAX + s->spd},
        {"the depth", s->depth, 1, RB_DEPTH_MAX},
        {"aa", s->aa, 1, RB_AA_MAX},
        {"the number of light samples", s->light_samples, 1, RB_LIGHT_SAMPLES_MAX},
        {"the tile size", s->tile, RB_BLOCK, RB_TILE_MAX},
        {"the number of threads", s->threads, 1, RB_THREADS_MAX},
    };
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (check_range(ranges[i].name, ranges[i].value, ranges[i].low, ranges[i].high, error))
            return RB_INVALID;
    if (check_number("the light size", s->light_size, error) ||
        check_number("the light scale", s->light_scale, error) ||
        check_number("ambient", s->ambient, error))
        return RB_INVALID;
    if (s->tile % RB_BLOCK)
        return rb_error_set(error, RB_INVALID, "the tile size must be a multiple of %d, not %d",
                            RB_BLOCK, s->tile);
    if ((int64_t)s->width * s->height > (int64_t)1 << 28)
        return rb_error_set(error, RB_INVALID, "%d x %d pixels are too many (at most 2^28)",
                            s->width, s->height);
    return RB_OK;
}

static void to_float(const double from[3], float to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = (float)from[k];
}

static void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// Scaled by the largest component first, so that nothing underflows.
static void normalize(double a[3])
{
    double largest = fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
    for (int k = 0; k < 3; k++)
        a[k] /= largest;
    double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (int k = 0; k < 3; k++)
        a[k] /= length;
}

struct rb_view rb_view_make(const struct rb_scene *scene, const struct rb_settings *settings)
{
    const struct rb_camera *camera = &scene->camera;
    double x[3], y[3], z[3], corner[3], right[3], down[3];
    for (int k = 0; k < 3; k++)
        z[k] = camera->from[k] - camera->at[k];
    normalize(z);
    cross(camera->up, z, x);
    normalize(x);
    cross(z, x, y);
    // The angle spans the outer edges of the image height; SPD lets it span the first to the last
    // pixel row but one, so that its corner rays lie at (i - n/2) / (n - 1) of it, n pixels.
    int width = settings->width - settings->spd, height = settings->height - settings->spd;
    double pi = 3.14159265358979323846;
    double extent = 2.0 * tan(camera->angle_deg * pi / 360.0);
    double step = extent / (settings->spd && height > 1 ? height - 1 : height);
    for (int k = 0; k < 3; k++) {
        right[k] = step * x[k];
        down[k] = -step * y[k];
        corner[k] = -z[k] - 0.5 * width * right[k] - 0.5 * height * down[k];
    }
    struct rb_view view = {
        .width = settings->width,
        .height = settings->height,
        .aa = (uint32_t)settings->aa,
        .center = settings->spd ? 0.0f : 0.5f,
        .seed = settings->seed,
    };
    to_float(camera->from, view.from);
    to_float(corner, view.corner);
    to_float(right, view.right);
    to_float(down, view.down);
    return view;
}

struct rb_shading rb_shading_make(const struct rb_scene *scene, const struct rb_settings *settings)
{
    uint32_t samples = (uint32_t)settings->light_samples, strata = 1;
    for (uint32_t i = 1; i * i <= samples; i++)
        if (samples % i == 0)
            strata = i; // the divisor nearest to the square root from below
    struct rb_shading shading = {
        .light_scale = (float)settings->light_scale,
        .ambient = (float)settings->ambient,
        .light_edge = (float)settings->light_size,
        .light_samples = samples,
        .strata_x = samples / strata,
        .strata_y = strata,
        .phong = settings->phong,
        .seed = settings->seed,
    };
    to_float(scene->camera.at, shading.at);
    return shading;
}
