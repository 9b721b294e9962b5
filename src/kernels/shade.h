// Normative shading: from a hit to a point with a normal, from there to secondary rays and to
// light. Every variant repeats these operations in this order (see intersect.h).
#ifndef RB_KERNELS_SHADE_H
#define RB_KERNELS_SHADE_H

#include "base/random.h"
#include "kernels/intersect.h"
#include "kernels/power.h"

// How far secondary rays start off a planar surface, relative to its largest coordinate: 2^-20, 16
// ulps. A point computed on a triangle is within 3 ulps of it, and the edge tolerance lets a
// neighbour be hit 8 ulps away. Of 300 000 shadow verdicts on mount_high and mount9 each, 3 and 6
// were wrong at 2^-19, 0 and 4 at 2^-20, 0 and 3 at 2^-21; below that neighbours begin to cast
// shadows.
#define RB_OFFSET_SCALE 0x1p-20f

// The same for rays that stay outside of a sphere, cone or cylinder: 8 ulps, for the sake of others
// in the same place. Rays inside start on the surface, whose own rule is exact (rb_sphere_test).
#define RB_CURVED_OFFSET_SCALE 0x1p-21f

// Dimensions of the random numbers of a path: two for the place in the pixel, two per light sample.
enum { RB_DIMENSION_PIXEL = 0, RB_DIMENSION_LIGHT = 2 };

// Where in its pixel AA sample `sample` lies, within [0, 1) squared.
static inline void rb_pixel_place(const struct rb_view *view, uint32_t pixel, uint32_t sample,
                                  float *x, float *y)
{
    float n = (float)view->aa;
    float a = rb_random(view->seed, pixel, sample, 1, RB_DIMENSION_PIXEL);
    float b = rb_random(view->seed, pixel, sample, 1, RB_DIMENSION_PIXEL + 1);
    *x = ((float)(sample % view->aa) + a) / n;
    *y = ((float)(sample / view->aa) + b) / n;
}

// A point on the geometry, before it knows where the ray came from.
struct rb_point {
    struct rb_vec p;         // on the surface
    struct rb_vec geometric; // unit outward normal
    struct rb_vec shading;   // unit outward normal, interpolated where the file gives normals
    float offset;            // distance secondary rays keep from the surface
    bool curved;             // they keep it on the outside only
};

static inline struct rb_point rb_point_on_sphere(const struct rb_sphere *sphere, struct rb_vec p)
{
    struct rb_vec c = rb_vec_of(sphere->center);
    struct rb_vec n = rb_normalize(rb_vec_sub(p, c));
    struct rb_vec on = rb_vec_mad(c, fabsf(sphere->radius), n);
    float reach = rb_max(rb_vec_reach(on), fabsf(sphere->radius));
    return (struct rb_point){on, n, n, RB_CURVED_OFFSET_SCALE * reach, true};
}

static inline struct rb_point rb_point_on_triangle(const struct rb_scene *scene, uint32_t index,
                                                   float u, float v)
{
    const struct rb_triangle *triangle = &scene->triangles[index];
    struct rb_vec v0 = rb_vec_of(triangle->v[0]);
    struct rb_vec e1 = rb_vec_sub(rb_vec_of(triangle->v[1]), v0);
    struct rb_vec e2 = rb_vec_sub(rb_vec_of(triangle->v[2]), v0);
    struct rb_point point = {.curved = false};
    point.p = rb_vec_mad(rb_vec_mad(v0, u, e1), v, e2);
    point.geometric = rb_vec_of(scene->triangle_normals[index]);
    point.shading = point.geometric;
    point.offset =
        RB_OFFSET_SCALE * rb_max(rb_vec_reach(point.p), rb_max(rb_vec_reach(e1), rb_vec_reach(e2)));
    uint32_t smooth = scene->triangle_smooth ? scene->triangle_smooth[index] : RB_NONE;
    if (smooth != RB_NONE) {
        const float(*n)[3] = (const float(*)[3])scene->smooth_normals[smooth];
        struct rb_vec sum = rb_vec_scale(rb_vec_of(n[0]), 1.0f - u - v);
        sum = rb_vec_mad(rb_vec_mad(sum, u, rb_vec_of(n[1])), v, rb_vec_of(n[2]));
        float length2 = rb_dot(sum, sum);
        if (length2 >= FLT_MIN) // opposite normals may cancel; the flat one remains then
            point.shading = rb_vec_scale(sum, 1.0f / sqrtf(length2));
    }
    return point;
}

static inline struct rb_point rb_point_on_cone(const struct rb_cone *cone, struct rb_vec p)
{
    struct rb_vec base = rb_vec_of(cone->base), axis = rb_vec_of(cone->axis);
    struct rb_vec l = rb_vec_sub(p, base);
    float z = rb_dot(l, axis);
    struct rb_vec across = rb_vec_mad(l, -z, axis);
    float length2 = rb_dot(across, across);
    struct rb_point point = {p, axis, axis, 0.0f, true};
    if (length2 >= FLT_MIN) { // the tip of a cone has no normal; the axis serves
        struct rb_vec radial = rb_vec_scale(across, 1.0f / sqrtf(length2));
        float radius = cone->base_radius + cone->slope * z;
        point.p = rb_vec_mad(rb_vec_mad(base, z, axis), radius, radial);
        point.geometric = rb_normalize(rb_vec_mad(radial, -cone->slope, axis));
        point.shading = point.geometric;
    }
    point.offset = RB_CURVED_OFFSET_SCALE * rb_max(rb_vec_reach(point.p), rb_vec_reach(l));
    return point;
}

static inline struct rb_point rb_point_on_plane(const struct rb_plane *plane, struct rb_vec p)
{
    struct rb_vec n = rb_vec_of(plane->normal);
    struct rb_vec on = rb_vec_mad(p, -(rb_dot(n, p) - plane->distance), n);
    return (struct rb_point){on, n, n, RB_OFFSET_SCALE * rb_vec_reach(on), false};
}

static inline struct rb_point rb_point_of_hit(const struct rb_scene *scene, struct rb_vec o,
                                              struct rb_vec d, const struct rb_hit *hit)
{
    struct rb_vec p = rb_vec_mad(o, hit->t, d);
    uint32_t index = hit->prim - scene->first[rb_scene_kind(scene, hit->prim)];
    switch (rb_scene_kind(scene, hit->prim)) {
    case RB_SPHERE:
        return rb_point_on_sphere(&scene->spheres[index], p);
    case RB_TRIANGLE:
        return rb_point_on_triangle(scene, index, hit->u, hit->v);
    case RB_CONE:
        return rb_point_on_cone(&scene->cones[index], p);
    default:
        return rb_point_on_plane(&scene->planes[index], p);
    }
}

// n turned towards where d comes from.
static inline struct rb_vec rb_turned(struct rb_vec n, struct rb_vec d)
{
    return rb_dot(n, d) > 0.0f ? rb_vec_neg(n) : n;
}

// Where a ray met a surface, as its secondary rays need it.
struct rb_contact {
    const struct rb_material *material;
    struct rb_vec d, n;      // ray direction; shading normal turned against it
    struct rb_vec near, far; // starting points on the viewer's side and on the other side
    uint32_t prim;
    bool entering;
};

// Of ray i, which hit something.
static inline struct rb_contact rb_contact_of_hit(const struct rb_scene *scene,
                                                  const struct rb_rays *rays,
                                                  const struct rb_hits *hits, uint32_t i)
{
    struct rb_vec o = {rays->ox[i], rays->oy[i], rays->oz[i]};
    struct rb_vec d = {rays->dx[i], rays->dy[i], rays->dz[i]};
    struct rb_hit hit = {hits->t[i], hits->u[i], hits->v[i], hits->prim[i]};
    struct rb_point point = rb_point_of_hit(scene, o, d, &hit);
    struct rb_vec side = rb_turned(point.geometric, d);
    bool entering = rb_dot(d, point.geometric) < 0.0f;
    float near_offset = point.curved && !entering ? 0.0f : point.offset;
    float far_offset = point.curved ? 0.0f : point.offset;
    return (struct rb_contact){
        .material = &scene->materials[scene->material_of[hit.prim]],
        .d = d,
        .n = rb_turned(point.shading, d),
        .near = rb_vec_mad(point.p, near_offset, side),
        .far = rb_vec_mad(point.p, -far_offset, side),
        .prim = hit.prim,
        .entering = entering,
    };
}

// The media stack: 16-bit indices into scene.media, the innermost in the lowest bits. A fifth
// medium pushes the outermost out.
static inline uint64_t rb_media_enter(uint64_t stack, uint32_t medium)
{
    return stack << 16 | medium;
}

// Removes the innermost occurrence of `medium`, wherever it is: overlapping bodies may be left in
// another order than they were entered. Unchanged if it does not occur.
static inline uint64_t rb_media_leave(uint64_t stack, uint32_t medium)
{
    for (int shift = 0; shift < 64; shift += 16) {
        if ((stack >> shift & 0xffff) == medium) {
            uint64_t inner = stack & (((uint64_t)1 << shift) - 1);
            uint64_t outer = shift == 48 ? 0 : stack >> (shift + 16);
            return outer << shift | inner;
        }
    }
    return stack;
}

// Indices of refraction on both sides of a surface, and the media on the other side.
struct rb_crossing {
    float from, to;
    uint64_t media;
};

// A ray with media stack `media` meets transparent `material`. Leaving a body it has never entered,
// it must have started inside.
static inline struct rb_crossing rb_media_cross(const struct rb_scene *scene,
                                                const struct rb_material *material, uint64_t media,
                                                bool entering)
{
    uint64_t next = entering ? rb_media_enter(media, material->medium)
                             : rb_media_leave(media, material->medium);
    float inside = !entering && next == media ? material->ior : scene->media[media & 0xffff];
    return (struct rb_crossing){inside, scene->media[next & 0xffff], next};
}

static inline struct rb_vec rb_reflect(struct rb_vec d, struct rb_vec n)
{
    return rb_normalize(rb_vec_mad(d, -2.0f * rb_dot(d, n), n));
}

// Snell's law with n turned towards the ray. False on total internal reflection.
static inline bool rb_refract(struct rb_vec d, struct rb_vec n, float from, float to,
                              struct rb_vec *refracted)
{
    float eta = from / to, cosine = -rb_dot(d, n);
    float k = 1.0f - eta * eta * (1.0f - cosine * cosine);
    if (!(k >= 0.0f))
        return false;
    struct rb_vec bent = rb_vec_scale(d, eta);
    *refracted = rb_normalize(rb_vec_mad(bent, eta * cosine - sqrtf(k), n));
    return true;
}

// Point on the light that shadow ray `sample` of this pixel aims at: the light itself, or a
// jittered stratum of the square of edge `edge` around it that faces `at`.
static inline struct rb_vec rb_light_point(const struct rb_shading *shading, struct rb_vec light,
                                           const struct rb_light_sample *sample, uint32_t pixel,
                                           uint32_t path)
{
    if (!(shading->light_edge > 0.0f))
        return light;
    struct rb_vec axis = rb_vec_sub(rb_vec_of(shading->at), light);
    axis = rb_dot(axis, axis) >= FLT_MIN ? rb_normalize(axis) : (struct rb_vec){0, 0, 1};
    struct rb_vec helper =
        fabsf(axis.x) < 0.5f ? (struct rb_vec){1, 0, 0} : (struct rb_vec){0, 1, 0};
    struct rb_vec s = rb_normalize(rb_cross(helper, axis)), r = rb_cross(axis, s);
    uint32_t dimension =
        RB_DIMENSION_LIGHT + 2 * (sample->light * shading->light_samples + sample->sample);
    float a = rb_random(shading->seed, pixel, sample->pixel_sample, path, dimension);
    float b = rb_random(shading->seed, pixel, sample->pixel_sample, path, dimension + 1);
    float i = (float)(sample->sample % shading->strata_x);
    float j = (float)(sample->sample / shading->strata_x);
    a = ((i + a) / (float)shading->strata_x - 0.5f) * shading->light_edge;
    b = ((j + b) / (float)shading->strata_y - 0.5f) * shading->light_edge;
    return rb_vec_mad(rb_vec_mad(light, a, s), b, r);
}

// Is the light at `distance` along l hidden from p by the very primitive p lies on? Only the inside
// of an opaque sphere, cone or cylinder can do that; glass never shadows itself.
static inline bool rb_shadows_itself(const struct rb_scene *scene, uint32_t prim, struct rb_vec p,
                                     struct rb_vec l, float distance)
{
    enum rb_kind kind = rb_scene_kind(scene, prim);
    bool curved = kind == RB_SPHERE || kind == RB_CONE;
    if (!curved || scene->materials[scene->material_of[prim]].t > 0.0f)
        return false;
    struct rb_ray ray = rb_ray_make(p, l, prim, RB_SIDES_BOTH);
    uint32_t index = prim - scene->first[kind];
    float t;
    bool met = kind == RB_SPHERE
                   ? rb_sphere_test(&scene->spheres[index], &ray, RB_SIDES_BOTH, true, &t)
                   : rb_cone_test(&scene->cones[index], &ray, RB_SIDES_BOTH, true, &t);
    return met && t < distance;
}

// Intensity of the highlight before Ks and light: (N.H)^Shine, or Phong's (R.V)^Shine.
static inline float rb_highlight(const struct rb_shading *shading, struct rb_vec n, struct rb_vec l,
                                 struct rb_vec v, float shine)
{
    float cosine;
    if (shading->phong)
        cosine = rb_dot(rb_vec_sub(rb_vec_scale(n, 2.0f * rb_dot(n, l)), l), v);
    else
        cosine = rb_dot(n, rb_normalize(rb_vec_add(l, v)));
    return rb_power(cosine, shine);
}

#endif
