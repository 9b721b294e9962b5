#include "bench/replay/classes.h"

#include "kernels/shade.h"

static const float REFRACTION_INDEX = 1.2f;

// No ray of an image has this path, so random numbers of the image are not used twice.
enum { DIFFUSE_PATH = 0 };

// The camera ray that hit and what it is told about the place.
struct parent {
    const struct rb_scene *scene;
    const struct rb_contact *contact;
    uint64_t seed;
    uint32_t pixel, sample;
};

// Origin and direction of a child; false if there is none.
typedef bool aim_fn(const struct parent *parent, struct rb_vec *o, struct rb_vec *d);

// Two axes across a unit vector (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
static void make_axes(struct rb_vec n, struct rb_vec *x, struct rb_vec *y)
{
    float sign = copysignf(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    *x = (struct rb_vec){1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    *y = (struct rb_vec){b, sign + n.y * n.y * a, -n.y};
}

static float random_number(const struct parent *parent, uint32_t dimension)
{
    return rb_random(parent->seed, parent->pixel, parent->sample, DIFFUSE_PATH, dimension);
}

// The point of the disc by rejection, which needs no sine and is the same on every machine.
static bool aim_diffuse(const struct parent *parent, struct rb_vec *o, struct rb_vec *d)
{
    float u, v, square;
    uint32_t dimension = 0;
    do {
        u = 2.0f * random_number(parent, dimension++) - 1.0f;
        v = 2.0f * random_number(parent, dimension++) - 1.0f;
        square = u * u + v * v;
    } while (square > 1.0f);
    float up = sqrtf(1.0f - square);
    struct rb_vec n = parent->contact->n, x, y;
    make_axes(n, &x, &y);
    *o = parent->contact->near;
    *d = rb_normalize(rb_vec_mad(rb_vec_mad(rb_vec_scale(n, up), u, x), v, y));
    return true;
}

static bool aim_reflection(const struct parent *parent, struct rb_vec *o, struct rb_vec *d)
{
    *o = parent->contact->near;
    *d = rb_reflect(parent->contact->d, parent->contact->n);
    return true;
}

static bool aim_refraction(const struct parent *parent, struct rb_vec *o, struct rb_vec *d)
{
    const struct rb_contact *contact = parent->contact;
    float from = contact->entering ? 1.0f : REFRACTION_INDEX;
    float to = contact->entering ? REFRACTION_INDEX : 1.0f;
    *o = contact->far;
    return rb_refract(contact->d, contact->n, from, to, d);
}

// `d` is the way to the light, in full length.
static bool aim_shadow(const struct parent *parent, struct rb_vec *o, struct rb_vec *d)
{
    const struct rb_contact *contact = parent->contact;
    if (parent->scene->light_count == 0)
        return false;
    struct rb_vec light = rb_vec_of(parent->scene->lights[0].position);
    *o = rb_dot(contact->n, rb_vec_sub(light, contact->near)) < 0.0f ? contact->far : contact->near;
    *d = rb_vec_sub(light, *o);
    return true;
}

static const struct {
    aim_fn *aim;
    enum rb_batch_kind kind;
    int bounce;
} classes[RB_CLASS_COUNT] = {
    [RB_CLASS_DIFFUSE] = {aim_diffuse, RB_BATCH_RAYS, 1},
    [RB_CLASS_REFLECTION] = {aim_reflection, RB_BATCH_RAYS, 1},
    [RB_CLASS_REFRACTION] = {aim_refraction, RB_BATCH_RAYS, 1},
    [RB_CLASS_SHADOW] = {aim_shadow, RB_BATCH_SHADOWS, 0},
};

enum rb_status rb_class_batches_alloc(struct rb_class_batches *batches,
                                      const bool wanted[RB_CLASS_COUNT], uint32_t count,
                                      struct rb_error *error)
{
    enum rb_status status = RB_OK;
    *batches = (struct rb_class_batches){0};
    for (int c = 0; c < RB_CLASS_COUNT && status == RB_OK; c++)
        if (wanted[c] && classes[c].aim)
            status = rb_batch_alloc(&batches->of[c], classes[c].kind, count, error);
    return status;
}

void rb_class_batches_free(struct rb_class_batches *batches)
{
    for (int c = 0; c < RB_CLASS_COUNT; c++)
        rb_batch_free(&batches->of[c]);
}

static void append_ray(struct rb_rays *rays, const struct parent *parent, enum rb_ray_class which,
                       struct rb_vec o, struct rb_vec d)
{
    uint32_t i = rays->count++;
    rays->ox[i] = o.x, rays->oy[i] = o.y, rays->oz[i] = o.z;
    rays->dx[i] = d.x, rays->dy[i] = d.y, rays->dz[i] = d.z;
    rays->weight[i] = 1.0f;
    rays->pixel[i] = parent->pixel;
    rays->path[i] = which == RB_CLASS_REFRACTION ? 3 : 2;
    rays->self[i] = parent->contact->prim;
    rays->media[i] = 0;
}

static void append_shadow(struct rb_shadows *shadows, const struct parent *parent, struct rb_vec o,
                          struct rb_vec to_light)
{
    uint32_t i = shadows->count++;
    float distance = sqrtf(rb_dot(to_light, to_light));
    struct rb_vec d = rb_vec_scale(to_light, 1.0f / distance);
    shadows->ox[i] = o.x, shadows->oy[i] = o.y, shadows->oz[i] = o.z;
    shadows->dx[i] = d.x, shadows->dy[i] = d.y, shadows->dz[i] = d.z;
    shadows->r[i] = shadows->g[i] = shadows->b[i] = 0.0f;
    shadows->distance[i] = distance;
    shadows->pixel[i] = parent->pixel;
    shadows->self[i] = parent->contact->prim;
}

void rb_class_spawn(enum rb_ray_class ray_class, const struct rb_scene *scene, uint64_t seed,
                    const struct rb_batch *camera, struct rb_batch *out)
{
    const struct rb_rays *rays = &camera->rays;
    out->bounce = classes[ray_class].bounce;
    out->span = camera->span;
    out->rays.count = out->shadows.count = 0;
    for (uint32_t i = 0; i < rays->count; i++) {
        if (camera->hits.prim[i] == RB_NONE)
            continue;
        struct rb_contact contact = rb_contact_of_hit(scene, rays, &camera->hits, i);
        struct parent parent = {scene, &contact, seed, rays->pixel[i], camera->span.sample};
        struct rb_vec o, d;
        if (!classes[ray_class].aim(&parent, &o, &d))
            continue;
        if (out->kind == RB_BATCH_RAYS)
            append_ray(&out->rays, &parent, ray_class, o, d);
        else
            append_shadow(&out->shadows, &parent, o, d);
    }
}
