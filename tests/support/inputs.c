#include "tests/support/inputs.h"

#include <math.h>

static uint32_t random_word(struct ref_random *random)
{
    return (uint32_t)(ref_uniform(random) * 0x1p32);
}

// True once in n.
static bool once_in(struct ref_random *random, uint32_t n)
{
    return ref_below(random, n) == 0;
}

static float pick(struct ref_random *random, const float *values, uint32_t count)
{
    return values[ref_below(random, count)];
}

static void aim_anywhere(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    (void)scene;
    ref_direction(random, aim->target);
    for (int k = 0; k < 3; k++)
        aim->o[k] = ref_between(random, -3.0, 3.0);
}

static aim_fn *pick_class(struct ref_random *random, const struct ray_class *classes,
                          const char **name)
{
    uint32_t count = 0;
    *name = "anywhere";
    while (classes && classes[count].name)
        count++;
    if (count == 0)
        return aim_anywhere;
    const struct ray_class *class = &classes[ref_below(random, count)];
    *name = class->name;
    return class->aim;
}

// A component of the direction that is zero or nearly so, the others of unit length.
static void flatten(struct ref_random *random, float *d[3])
{
    static const float small[] = {0.0f, -0.0f, 1e-40f, -1e-40f, 1e-19f, -0x1p-60f, 1e-12f};
    uint32_t k = ref_below(random, 3);
    double v[3] = {(double)*d[0], (double)*d[1], (double)*d[2]};
    v[k] = 0.0;
    if (!ref_normalize(v))
        return;
    for (int i = 0; i < 3; i++)
        *d[i] = (float)v[i];
    *d[k] = pick(random, small, 7);
}

static void twist_ray(struct ref_random *random, const struct rb_scene *scene, struct rb_rays *rays,
                      uint32_t i)
{
    static const float poisons[] = {NAN, -NAN, INFINITY, -INFINITY};
    static const float zeros[] = {0.0f, -0.0f, 1e-42f};
    float *o[3] = {rays->ox + i, rays->oy + i, rays->oz + i};
    float *d[3] = {rays->dx + i, rays->dy + i, rays->dz + i};
    uint32_t k = ref_below(random, 3);
    switch (ref_below(random, 12)) {
    case 0:
        *(once_in(random, 2) ? o : d)[k] = pick(random, poisons, 4);
        break;
    case 1:
        *o[k] = pick(random, zeros, 3);
        break;
    case 2:
    case 3:
        flatten(random, d);
        break;
    case 4:
    case 5:
        if (scene->primitive_count)
            rays->self[i] = ref_below(random, scene->primitive_count);
        break;
    default:
        break;
    }
}

const char *input_rays(struct ref_random *random, const struct rb_scene *scene,
                       const struct ray_class *classes, uint32_t count, struct rb_rays *rays)
{
    const char *name;
    uint32_t mode = ref_below(random, 4); // 0 mixed, 1 from one point, else of one class
    bool twist = once_in(random, 2), back = once_in(random, 4);
    double spread = pow(10.0, ref_between(random, -6.0, 0.5));
    aim_fn *aim_class = pick_class(random, classes, &name);
    struct aim first, aim;
    aim_class(random, scene, &first);
    while (rays->count < count) {
        if (mode == 0)
            aim_class = pick_class(random, classes, &name);
        if (mode == 1)
            aim = first;
        else
            aim_class(random, scene, &aim);
        for (int k = 0; mode == 1 && k < 3; k++)
            aim.target[k] += ref_between(random, -spread, spread);
        for (int k = 0; mode == 1 && back && rays->count / 16 % 2 && k < 3; k++)
            aim.target[k] = 2 * aim.o[k] - aim.target[k]; // packets that look the other way
        aim_push(rays, &aim, random);
        if (twist)
            twist_ray(random, scene, rays, rays->count - 1);
    }
    return mode == 0 ? "mixed" : name;
}

void input_stamp_rays(struct ref_random *random, const struct rb_scene *scene, struct rb_rays *rays)
{
    static const float weights[] = {1.0f, 0.0f, 1e-3f, 1e-40f, 1e8f, 1e12f};
    for (uint32_t i = 0; i < rays->count; i++) {
        rays->weight[i] =
            once_in(random, 4) ? pick(random, weights, 6) : (float)ref_uniform(random);
        rays->pixel[i] = ref_below(random, FILM_PIXELS);
        rays->path[i] = random_word(random) / INPUT_MAX * INPUT_MAX + i;
        rays->media[i] = 0;
        for (uint32_t k = ref_below(random, 6); k > 0; k--)
            rays->media[i] = rays->media[i] << 16 | ref_below(random, scene->media_count);
    }
}

static bool finite_ray(const struct rb_rays *rays, uint32_t i)
{
    return isfinite(rays->ox[i]) && isfinite(rays->oy[i]) && isfinite(rays->oz[i]) &&
           isfinite(rays->dx[i]) && isfinite(rays->dy[i]) && isfinite(rays->dz[i]);
}

void input_twist_hits(struct ref_random *random, const struct rb_scene *scene,
                      const struct rb_rays *rays, struct rb_hits *hits)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        uint32_t kind = ref_below(random, 8);
        if (kind > 1 || !finite_ray(rays, i))
            continue;
        hits->t[i] = INFINITY, hits->u[i] = hits->v[i] = 0.0f;
        hits->prim[i] = RB_NONE;
        if (kind == 0 || !scene->primitive_count)
            continue;
        hits->t[i] = (float)pow(10.0, ref_between(random, -3.0, 2.0));
        hits->prim[i] = ref_below(random, scene->primitive_count);
        if (rb_scene_kind(scene, hits->prim[i]) == RB_TRIANGLE) {
            hits->u[i] = (float)ref_below(random, 3) * 0.5f;
            hits->v[i] = (1.0f - hits->u[i]) * (float)ref_uniform(random);
        }
    }
}

// Writes a vector of unit length along v.
static void put_unit(const double v[3], float *x, float *y, float *z)
{
    double unit[3] = {v[0], v[1], v[2]};
    if (ref_normalize(unit))
        *x = (float)unit[0], *y = (float)unit[1], *z = (float)unit[2];
}

static void twist_surface(struct ref_random *random, const struct rb_light *light,
                          struct rb_surfaces *s, uint32_t i)
{
    double l[3] = {(double)(light->position[0] - s->px[i]), (double)(light->position[1] - s->py[i]),
                   (double)(light->position[2] - s->pz[i])};
    double d[3], sign = once_in(random, 4) ? -1.0 : 1.0;
    ref_direction(random, d);
    for (int k = 0; k < 3; k++) // almost, or exactly, the way the light comes from
        d[k] = sign * l[k] + d[k] * pow(10.0, ref_between(random, -9.0, 1.0));
    switch (ref_below(random, 8)) {
    case 0:
        s->px[i] = light->position[0], s->py[i] = light->position[1], s->pz[i] = light->position[2];
        break;
    case 1:
        put_unit(l, &s->nx[i], &s->ny[i], &s->nz[i]);
        put_unit(d, &s->vx[i], &s->vy[i], &s->vz[i]);
        break;
    case 2:
        put_unit(d, &s->nx[i], &s->ny[i], &s->nz[i]);
        put_unit(l, &s->vx[i], &s->vy[i], &s->vz[i]);
        break;
    case 3:
        put_unit(d, &s->nx[i], &s->ny[i], &s->nz[i]);
        put_unit(d, &s->vx[i], &s->vy[i], &s->vz[i]);
        break;
    case 4:
        s->inside[i] = !s->inside[i];
        break;
    default:
        break;
    }
}

void input_twist_surfaces(struct ref_random *random, const struct rb_light *light,
                          struct rb_surfaces *surfaces)
{
    bool twist = once_in(random, 2);
    for (uint32_t i = 0; i < surfaces->count; i++) {
        surfaces->pixel[i] = random_word(random) / INPUT_MAX * INPUT_MAX + i;
        if (twist)
            twist_surface(random, light, surfaces, i);
    }
}

void input_shadows(struct ref_random *random, const struct rb_rays *rays,
                   const struct rb_hits *hits, struct rb_shadows *s)
{
    static const float odd[] = {0.0f, 1e-40f, 1e30f, INFINITY};
    for (uint32_t i = 0; i < rays->count; i++) {
        float t = hits->prim[i] == RB_NONE ? 10.0f : hits->t[i];
        s->ox[i] = rays->ox[i], s->oy[i] = rays->oy[i], s->oz[i] = rays->oz[i];
        s->dx[i] = rays->dx[i], s->dy[i] = rays->dy[i], s->dz[i] = rays->dz[i];
        s->r[i] = s->g[i] = s->b[i] = 1.0f;
        s->pixel[i] = i;
        s->self[i] = rays->self[i];
        switch (ref_below(random, 8)) {
        case 0:
            s->distance[i] = t; // not in between: the interval is open
            break;
        case 1:
            s->distance[i] = nextafterf(t, INFINITY);
            break;
        case 2:
            s->distance[i] = pick(random, odd, 4);
            break;
        default:
            s->distance[i] = t * (float)ref_between(random, 0.5, 3.0);
            break;
        }
    }
    s->count = rays->count;
}

void input_view(struct ref_random *random, int width, struct rb_view *view, struct rb_span *span)
{
    double step = pow(10.0, ref_between(random, -4.0, -1.0)), z[3], y[3], x[3];
    uint32_t rows = INPUT_MAX / (uint32_t)width;
    int height = 1 + (int)ref_below(random, rows < 33 ? rows : 33);
    // Tiles begin at multiples of a block.
    span->x0 = RB_BLOCK * (int)ref_below(random, 3),
    span->y0 = RB_BLOCK * (int)ref_below(random, 3);
    span->x1 = span->x0 + width, span->y1 = span->y0 + height;
    view->width = span->x1 + (int)ref_below(random, 40);
    view->height = span->y1 + (int)ref_below(random, 40);
    view->aa = 1 + ref_below(random, 3);
    view->center = once_in(random, 4) ? 0.0f : 0.5f; // 0 by SPD's rules
    view->seed = random_word(random);
    span->sample = ref_below(random, view->aa * view->aa);
    ref_direction(random, z);
    ref_direction(random, x);
    ref_cross(z, x, y);
    ref_normalize(y);
    ref_cross(y, z, x);
    for (int k = 0; k < 3; k++) {
        view->from[k] = (float)ref_between(random, -5.0, 5.0);
        view->right[k] = (float)(step * x[k]);
        view->down[k] = (float)(-step * y[k]);
        view->corner[k] = (float)(-z[k] - 0.5 * step * (view->width * x[k] - view->height * y[k]));
    }
}

struct rb_shading input_shading(struct ref_random *random, const struct rb_scene *scene,
                                struct rb_light_sample *sample)
{
    static const uint32_t strata[][2] = {{1, 1}, {2, 1}, {2, 2}, {2, 3}, {1, 7}, {4, 4}};
    const uint32_t *grid = strata[ref_below(random, 6)];
    struct rb_shading shading = {
        .light_samples = grid[0] * grid[1], .strata_x = grid[0], .strata_y = grid[1]};
    shading.light_scale = (float)ref_between(random, 0.1, 1.0);
    shading.ambient = once_in(random, 2) ? 0.0f : 0.1f;
    shading.light_edge = once_in(random, 3) ? 0.0f : (float)ref_between(random, 0.001, 5.0);
    shading.phong = once_in(random, 2);
    shading.seed = (uint64_t)random_word(random) << 20;
    for (int k = 0; k < 3; k++)
        shading.at[k] = (float)scene->camera.at[k];
    sample->light = ref_below(random, scene->light_count);
    sample->sample = ref_below(random, shading.light_samples);
    sample->pixel_sample = ref_below(random, 9);
    return shading;
}
