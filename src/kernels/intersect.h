// Normative intersection tests. Every variant, scalar or SIMD, repeats these operations in this
// order; single precision, no FMA, true division and square root.
//
// A hit counts only if the ray passes the primitive's own bounding box, and its distance is clamped
// to the interval in which it does ("own box"). Together with a slab test whose rounding is
// monotone this makes the answer independent of any tree: an ancestor's interval always contains
// the primitive's. (Plain tests disagree between tree layouts for hundreds of rays in a million
// aimed at vertices and edges.)
#ifndef RB_KERNELS_INTERSECT_H
#define RB_KERNELS_INTERSECT_H

#include "base/vec.h"
#include "kernels/count.h"
#include "kernels/kernel.h"

// Which sides of a primitive a ray sees.
enum rb_sides {
    RB_SIDES_VISIBLE, // both; a negative radius from inside only
    RB_SIDES_FRONT,   // opaque surfaces from their front only (SPD's rule)
    RB_SIDES_BOTH,    // both without exception: shadow rays
};

// A ray as the tests see it.
struct rb_ray {
    struct rb_vec o, d;
    struct rb_vec inv; // 1 / d, d kept away from zero
    uint32_t self;     // primitive it starts on
    enum rb_sides sides;
};

struct rb_hit {
    float t, u, v;
    uint32_t prim;
};

#define RB_MISS ((struct rb_hit){INFINITY, 0.0f, 0.0f, RB_NONE})

// Where a ray is inside a box: [near, far], empty if near > far.
struct rb_interval {
    float near, far;
};

// Smallest |d| the slabs divide by: 2^-60. Any d below it moves the ray by less than an ulp of a
// coordinate anywhere in a scene, and the largest inverse times the largest coordinate, 1e18 *
// 1e12, is still finite.
#define RB_DIRECTION_MIN 0x1p-60f

// Far planes are pushed away by 5e-7, four ulps, more than the two roundings of a slab can lose
// (Ize 2013, "Robust BVH Ray Traversal", needs 2 gamma_3 = 3.6e-7 for the ratio of far to near).
#define RB_FAR_SCALE (1.0f + 5e-7f)

static inline float rb_safe_inverse(float d)
{
    float magnitude = rb_max(fabsf(d), RB_DIRECTION_MIN);
    return 1.0f / copysignf(magnitude, d);
}

static inline struct rb_ray rb_ray_make(struct rb_vec o, struct rb_vec d, uint32_t self,
                                        enum rb_sides sides)
{
    struct rb_vec inv = {rb_safe_inverse(d.x), rb_safe_inverse(d.y), rb_safe_inverse(d.z)};
    return (struct rb_ray){o, d, inv, self, sides};
}

static inline struct rb_ray rb_ray_load(const struct rb_rays *rays, uint32_t i, bool one_sided)
{
    struct rb_vec o = {rays->ox[i], rays->oy[i], rays->oz[i]};
    struct rb_vec d = {rays->dx[i], rays->dy[i], rays->dz[i]};
    return rb_ray_make(o, d, rays->self[i], one_sided ? RB_SIDES_FRONT : RB_SIDES_VISIBLE);
}

static inline struct rb_ray rb_shadow_load(const struct rb_shadows *shadows, uint32_t i)
{
    struct rb_vec o = {shadows->ox[i], shadows->oy[i], shadows->oz[i]};
    struct rb_vec d = {shadows->dx[i], shadows->dy[i], shadows->dz[i]};
    return rb_ray_make(o, d, shadows->self[i], RB_SIDES_BOTH);
}

static inline void rb_hit_store(struct rb_hits *hits, uint32_t i, const struct rb_hit *hit)
{
    hits->t[i] = hit->t, hits->u[i] = hit->u, hits->v[i] = hit->v;
    hits->prim[i] = hit->prim;
}

// Rays that fail this are deactivated on entry: they would poison what is computed for a packet.
static inline bool rb_ray_valid(const struct rb_ray *ray)
{
    return rb_vec_finite(ray->o) && rb_vec_finite(ray->d);
}

// One axis of the slab test; near and far plane are chosen by the sign of the inverse.
static inline void rb_slab(float low, float high, float o, float inv, struct rb_interval *range)
{
    float t_low = (low - o) * inv, t_high = (high - o) * inv;
    float near = inv < 0.0f ? t_high : t_low;
    float far = inv < 0.0f ? t_low : t_high;
    range->near = rb_max(range->near, near);
    range->far = rb_min(range->far, far * RB_FAR_SCALE);
}

// The part of the ray at or beyond its origin that is inside the box.
static inline struct rb_interval rb_box(const float low[3], const float high[3],
                                        const struct rb_ray *ray)
{
    struct rb_interval range = {0.0f, INFINITY};
    rb_slab(low[0], high[0], ray->o.x, ray->inv.x, &range);
    rb_slab(low[1], high[1], ray->o.y, ray->inv.y, &range);
    rb_slab(low[2], high[2], ray->o.z, ray->inv.z, &range);
    return range;
}

// Sphere. The discriminant is r^2 - |l - (l.d) d|^2, the squared distance of the line from the
// centre (Haines et al., Ray Tracing Gems 2019, chapter 7): the textbook form B^2 - |l|^2 + r^2
// cancels and is wrong for 36 % of rays aimed at the small spheres of balls size 6. A ray that
// starts on the sphere meets it again only at the far side, at 2 l.d, which needs no tolerance.
static inline bool rb_sphere_test(const struct rb_sphere *sphere, const struct rb_ray *ray,
                                  enum rb_sides sides, bool own, float *t)
{
    RB_COUNT_RAYS(SPHERES, 1, 1);
    struct rb_vec l = rb_vec_sub(rb_vec_of(sphere->center), ray->o);
    float b = rb_dot(l, ray->d);
    struct rb_vec apart = rb_vec_mad(l, -b, ray->d);
    float discriminant = sphere->radius * sphere->radius - rb_dot(apart, apart);
    if (!(discriminant >= 0.0f))
        return false;
    float root = sqrtf(discriminant);
    float near = b - root, far = own ? b + b : b + root;
    bool inside_only = sphere->radius < 0.0f && sides != RB_SIDES_BOTH;
    bool front_only = sides == RB_SIDES_FRONT && !inside_only;
    bool take_near = near > 0.0f && !own && !inside_only;
    *t = take_near ? near : far;
    return *t > 0.0f && (take_near || !front_only);
}

// Error of the edge functions below, relative to |o - v0| times the longest edge: rays may pass an
// edge by this much on the wrong side and still hit, so that none slips between two triangles that
// share it. The worst of 10^8 rays aimed at edges and vertices of five meshes, from near and far,
// needed 5.1 * 2^-24 (tests/unit/leaks.c; at a quarter of what stands here 34 in a million
// leak, without any 19 %). More than needed shows the wrong triangle at the rims of others.
#define RB_EDGE_TOLERANCE (8.0f * 0x1p-24f)

// Triangle: Moeller and Trumbore 1997, with the edge tolerance above. Barycentric coordinates are
// clamped into the triangle, so that a point computed from them lies on it.
static inline bool rb_triangle_test(const struct rb_triangle *triangle, const struct rb_ray *ray,
                                    enum rb_sides sides, struct rb_hit *hit)
{
    RB_COUNT_RAYS(TRIANGLES, 1, 1);
    struct rb_vec v0 = rb_vec_of(triangle->v[0]);
    struct rb_vec e1 = rb_vec_sub(rb_vec_of(triangle->v[1]), v0);
    struct rb_vec e2 = rb_vec_sub(rb_vec_of(triangle->v[2]), v0);
    struct rb_vec s = rb_vec_sub(ray->o, v0);
    struct rb_vec p = rb_cross(ray->d, e2);
    struct rb_vec q = rb_cross(s, e1);
    float det = rb_dot(e1, p);
    float sign = copysignf(1.0f, det);
    float area = det * sign;
    float us = rb_dot(s, p) * sign;
    float vs = rb_dot(ray->d, q) * sign;
    float slack = RB_EDGE_TOLERANCE * rb_vec_reach(s) * rb_max(rb_vec_reach(e1), rb_vec_reach(e2));
    bool inside = us >= -slack && vs >= -slack && us + vs <= area + slack && area >= FLT_MIN;
    if (!inside || (sides == RB_SIDES_FRONT && det < 0.0f))
        return false;
    float inverse = 1.0f / area;
    hit->t = rb_dot(e2, q) * sign * inverse;
    hit->u = rb_min(rb_max(us * inverse, 0.0f), 1.0f);
    hit->v = rb_min(rb_max(vs * inverse, 0.0f), 1.0f - hit->u);
    return true;
}

// Cone frustum and cylinder, open at both ends: |p'|^2 = (r0 + slope z)^2 with p' the part of p
// across the axis. The origin is first moved to where the ray passes the centre of a cylinder or
// the small end of a cone, so that the quadratic is solved with small numbers. For a ray that
// starts on the surface one root is 0 by definition and only the other one counts.
static inline bool rb_cone_test(const struct rb_cone *cone, const struct rb_ray *ray,
                                enum rb_sides sides, bool own, float *t)
{
    RB_COUNT_RAYS(CONES, 1, 1);
    struct rb_vec axis = rb_vec_of(cone->axis);
    float shift = own ? 0.0f : rb_dot(rb_vec_sub(rb_vec_of(cone->center), ray->o), ray->d);
    struct rb_vec o = rb_vec_sub(rb_vec_mad(ray->o, shift, ray->d), rb_vec_of(cone->base));
    float z = rb_dot(o, axis), dz = rb_dot(ray->d, axis);
    struct rb_vec across = rb_vec_mad(o, -z, axis), d_across = rb_vec_mad(ray->d, -dz, axis);
    float radius = cone->base_radius + cone->slope * z, d_radius = cone->slope * dz;
    float a = rb_dot(d_across, d_across) - d_radius * d_radius;
    float b = rb_dot(across, d_across) - radius * d_radius;
    float c = own ? 0.0f : rb_dot(across, across) - radius * radius;
    float discriminant = b * b - a * c;
    if (!(discriminant >= 0.0f))
        return false;
    // Of the two roots, one enters the solid and one leaves it; q avoids the difference b - root.
    float q = -(b + copysignf(sqrtf(discriminant), b));
    float enter = b < 0.0f ? c / q : q / a, leave = b < 0.0f ? q / a : c / q;
    bool inside_only = cone->inside > 0.0f && sides != RB_SIDES_BOTH;
    bool front_only = sides == RB_SIDES_FRONT && !inside_only;
    float z_enter = z + enter * dz, z_leave = z + leave * dz;
    bool enters = !inside_only && enter + shift > 0.0f && enter + shift < INFINITY &&
                  z_enter >= 0.0f && z_enter <= cone->height;
    bool leaves = !front_only && leave + shift > 0.0f && leave + shift < INFINITY &&
                  z_leave >= 0.0f && z_leave <= cone->height;
    bool take_enter = enters && (!leaves || enter < leave);
    *t = (take_enter ? enter : leave) + shift;
    return enters || leaves;
}

// Plane through all space; has no box. Solved for the distance of the origin, so that it does not
// cancel when the plane's own point is far away.
static inline bool rb_plane_test(const struct rb_plane *plane, const struct rb_ray *ray,
                                 enum rb_sides sides, float *t)
{
    RB_COUNT_RAYS(PLANES, 1, 1);
    struct rb_vec n = rb_vec_of(plane->normal);
    float facing = rb_dot(n, ray->d);
    *t = (plane->distance - rb_dot(n, ray->o)) / facing;
    return *t > 0.0f && *t < INFINITY && !(sides == RB_SIDES_FRONT && facing > 0.0f);
}

// The sides of primitive `id` that this ray sees: glass always shows both.
static inline enum rb_sides rb_sides_of(const struct rb_scene *scene, const struct rb_ray *ray,
                                        uint32_t id)
{
    bool glass = ray->sides == RB_SIDES_FRONT && scene->materials[scene->material_of[id]].t > 0.0f;
    return glass ? RB_SIDES_VISIBLE : ray->sides;
}

// t of a hit that was found, clamped to where the ray is inside the own box.
static inline bool rb_hit_clamp(struct rb_hit *hit, bool found, struct rb_interval range)
{
    hit->t = rb_min(rb_max(hit->t, range.near), range.far);
    return found && hit->t > 0.0f;
}

// Does a ray that starts on primitive `id` not see it at all? Planar ones cannot be met again;
// shadow rays leave the question to rb_shadows_itself.
static inline bool rb_self_excluded(const struct rb_ray *ray, uint32_t id, bool planar)
{
    return id == ray->self && (planar || ray->sides == RB_SIDES_BOTH);
}

// One ray meets one bounded primitive.
static inline void rb_count_primitive(size_t bytes)
{
    (void)bytes;
    RB_COUNT_STEP(1, 1);
    RB_COUNT_RAYS(BOXES, 1, 1);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, bytes);
}

// The three below test primitive `index` of its kind against its own box and then itself. On true
// `hit` is complete and its t positive.
static inline bool rb_sphere_hit(const struct rb_scene *scene, uint32_t index,
                                 const struct rb_ray *ray, struct rb_hit *hit)
{
    const struct rb_sphere *sphere = &scene->spheres[index];
    rb_count_primitive(sizeof *sphere);
    float low[3], high[3];
    rb_sphere_bounds(sphere, low, high);
    struct rb_interval range = rb_box(low, high, ray);
    if (!(range.near <= range.far))
        return false;
    *hit = (struct rb_hit){.prim = index};
    bool own = index == ray->self;
    bool found = !rb_self_excluded(ray, index, false) &&
                 rb_sphere_test(sphere, ray, rb_sides_of(scene, ray, index), own, &hit->t);
    return rb_hit_clamp(hit, found, range);
}

static inline bool rb_triangle_hit(const struct rb_scene *scene, uint32_t index,
                                   const struct rb_ray *ray, struct rb_hit *hit)
{
    const struct rb_triangle *triangle = &scene->triangles[index];
    rb_count_primitive(sizeof *triangle);
    float low[3], high[3];
    rb_triangle_bounds(triangle, low, high);
    struct rb_interval range = rb_box(low, high, ray);
    if (!(range.near <= range.far))
        return false;
    *hit = (struct rb_hit){.prim = scene->first[RB_TRIANGLE] + index};
    bool found = !rb_self_excluded(ray, hit->prim, true) &&
                 rb_triangle_test(triangle, ray, rb_sides_of(scene, ray, hit->prim), hit);
    return rb_hit_clamp(hit, found, range);
}

static inline bool rb_cone_hit(const struct rb_scene *scene, uint32_t index,
                               const struct rb_ray *ray, struct rb_hit *hit)
{
    const struct rb_cone *cone = &scene->cones[index];
    rb_count_primitive(sizeof *cone);
    struct rb_interval range = rb_box(cone->low, cone->high, ray);
    if (!(range.near <= range.far))
        return false;
    *hit = (struct rb_hit){.prim = scene->first[RB_CONE] + index};
    bool own = hit->prim == ray->self;
    bool found = !rb_self_excluded(ray, hit->prim, false) &&
                 rb_cone_test(cone, ray, rb_sides_of(scene, ray, hit->prim), own, &hit->t);
    return rb_hit_clamp(hit, found, range);
}

// Any bounded primitive, by id.
static inline bool rb_primitive_hit(const struct rb_scene *scene, uint32_t id,
                                    const struct rb_ray *ray, struct rb_hit *hit)
{
    switch (rb_scene_kind(scene, id)) {
    case RB_SPHERE:
        return rb_sphere_hit(scene, id, ray, hit);
    case RB_TRIANGLE:
        return rb_triangle_hit(scene, id - scene->first[RB_TRIANGLE], ray, hit);
    default:
        return rb_cone_hit(scene, id - scene->first[RB_CONE], ray, hit);
    }
}

// Is `hit` closer than `best`, or as close with a lower id?
static inline bool rb_hit_closer(const struct rb_hit *hit, const struct rb_hit *best)
{
    return hit->t < best->t || (hit->t == best->t && hit->prim < best->prim);
}

static inline bool rb_plane_hit(const struct rb_scene *scene, uint32_t index,
                                const struct rb_ray *ray, struct rb_hit *hit)
{
    *hit = (struct rb_hit){.prim = scene->first[RB_PLANE] + index};
    RB_COUNT_STEP(1, 1);
    RB_COUNT_BYTES(PRIMITIVE_BYTES, sizeof scene->planes[index]);
    return !rb_self_excluded(ray, hit->prim, true) &&
           rb_plane_test(&scene->planes[index], ray, rb_sides_of(scene, ray, hit->prim), &hit->t);
}

// The closest plane, where a search through the bounded primitives starts.
static inline struct rb_hit rb_planes_closest(const struct rb_scene *scene,
                                              const struct rb_ray *ray)
{
    struct rb_hit best = RB_MISS, hit;
    for (uint32_t i = 0; i < scene->count[RB_PLANE]; i++)
        if (rb_plane_hit(scene, i, ray, &hit) && rb_hit_closer(&hit, &best))
            best = hit;
    return best;
}

static inline bool rb_planes_any(const struct rb_scene *scene, const struct rb_ray *ray,
                                 float distance)
{
    struct rb_hit hit;
    for (uint32_t i = 0; i < scene->count[RB_PLANE]; i++)
        if (rb_plane_hit(scene, i, ray, &hit) && hit.t < distance)
            return true;
    return false;
}

#endif
