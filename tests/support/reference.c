// Ray and surface in double precision, one primitive at a time, as a textbook has it. Coordinates
// come in as floats, so differences of them are exact or nearly so, and double precision leaves 29
// bits between its own error and what single precision can see.
#include "tests/support/reference.h"

#include <math.h>
#include <string.h>

static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

// A triangle in double precision.
struct corners {
    double v[3][3];
    double normal[3]; // unit
};

static struct corners corners_of(const struct rb_scene *scene, uint32_t prim)
{
    const struct rb_triangle *triangle = &scene->triangles[prim - scene->first[RB_TRIANGLE]];
    struct corners c;
    for (int i = 0; i < 3; i++)
        ref_widen(triangle->v[i], c.v[i]);
    double a[3], b[3];
    ref_edge(triangle->v[0], triangle->v[1], a);
    ref_edge(triangle->v[0], triangle->v[2], b);
    ref_cross(a, b, c.normal);
    ref_normalize(c.normal);
    return c;
}

// Distance between the line o + t d and the segment from a to b.
static double line_segment_distance(const double o[3], const double d[3], const double a[3],
                                    const double b[3])
{
    double e[3], w[3], apart[3];
    ref_subtract(b, a, e);
    ref_subtract(a, o, w);
    double dd = ref_dot(d, d), de = ref_dot(d, e), ee = ref_dot(e, e);
    double dw = ref_dot(d, w), ew = ref_dot(e, w), determinant = dd * ee - de * de;
    double s = determinant > 0.0 ? clamp((de * dw - dd * ew) / determinant, 0.0, 1.0) : 0.0;
    double t = (dw + s * de) / dd;
    for (int k = 0; k < 3; k++)
        apart[k] = w[k] + s * e[k] - t * d[k];
    return ref_length(apart);
}

// Distance of a point from a triangle: from its plane if it lies above the inside, else from the
// nearest edge.
static double triangle_distance(const struct corners *c, const double p[3])
{
    bool above = true;
    double nearest = HUGE_VAL;
    for (int i = 0; i < 3; i++) {
        const double *a = c->v[i], *b = c->v[(i + 1) % 3];
        double e[3], w[3], side[3], apart[3];
        ref_subtract(b, a, e);
        ref_subtract(p, a, w);
        ref_cross(e, w, side);
        above = above && ref_dot(side, c->normal) >= 0.0;
        double s = clamp(ref_dot(w, e) / ref_dot(e, e), 0.0, 1.0);
        ref_along(w, -s, e, apart);
        nearest = fmin(nearest, ref_length(apart));
    }
    double w[3];
    ref_subtract(p, c->v[0], w);
    return above ? fabs(ref_dot(w, c->normal)) : nearest;
}

// Inside if the three edges see the line on the same side: signs of the volumes of the line with
// each edge (Pluecker).
static int triangle_crossings(const struct rb_scene *scene, uint32_t prim,
                              const struct ref_ray *ray, struct ref_hit hits[2])
{
    if (prim == ray->self)
        return 0;
    struct corners c = corners_of(scene, prim);
    double w[3][3], clearance = HUGE_VAL;
    int positive = 0, negative = 0;
    for (int i = 0; i < 3; i++)
        ref_subtract(c.v[i], ray->o, w[i]);
    for (int i = 0; i < 3; i++) {
        double normal[3];
        ref_cross(w[i], w[(i + 1) % 3], normal);
        double volume = ref_dot(normal, ray->d);
        positive += volume > 0.0, negative += volume < 0.0;
    }
    double facing = ref_dot(c.normal, ray->d), length = ref_length(ray->d);
    if ((positive && negative) || facing == 0.0)
        return 0;
    double t = ref_dot(c.normal, w[0]) / facing;
    if (!(t > 0.0))
        return 0;
    for (int i = 0; i < 3; i++)
        clearance =
            fmin(clearance, line_segment_distance(ray->o, ray->d, c.v[i], c.v[(i + 1) % 3]));
    hits[0] = (struct ref_hit){
        t, {c.normal[0], c.normal[1], c.normal[2]}, fabs(facing) / length, clearance, prim};
    return 1;
}

// The quadratic around the point of the line nearest to the centre, where nothing cancels.
static int sphere_crossings(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                            struct ref_hit hits[2])
{
    const struct rb_sphere *sphere = &scene->spheres[prim];
    double c[3], l[3], apart[3], radius = fabs((double)sphere->radius);
    ref_widen(sphere->center, c);
    ref_subtract(c, ray->o, l);
    double dd = ref_dot(ray->d, ray->d), middle = ref_dot(l, ray->d) / dd;
    ref_along(l, -middle, ray->d, apart);
    double away = ref_length(apart);
    if (away > radius)
        return 0;
    double half = sqrt((radius - away) * (radius + away) / dd);
    double roots[2] = {middle - half, middle + half};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        if (!(roots[i] > 0.0) || (prim == ray->self && fabs(roots[i]) <= fabs(roots[1 - i])))
            continue;
        struct ref_hit *hit = &hits[count++];
        *hit = (struct ref_hit){.t = roots[i], .clearance = radius - away, .prim = prim};
        for (int k = 0; k < 3; k++)
            hit->normal[k] = (roots[i] * ray->d[k] - l[k]) / radius;
        hit->cosine = half * sqrt(dd) / radius;
    }
    return count;
}

// A cone in double precision; the stored axis is a unit vector up to rounding only.
struct frustum {
    double base[3], axis[3], base_radius, slope, height;
};

static struct frustum frustum_of(const struct rb_scene *scene, uint32_t prim)
{
    const struct rb_cone *cone = &scene->cones[prim - scene->first[RB_CONE]];
    struct frustum f = {.base_radius = (double)cone->base_radius,
                        .slope = (double)cone->slope,
                        .height = (double)cone->height};
    ref_widen(cone->base, f.base);
    ref_widen(cone->axis, f.axis);
    ref_normalize(f.axis);
    return f;
}

// Splits p - base into the height along the axis and the rest, across.
static double split(const struct frustum *f, const double p[3], double across[3])
{
    double l[3];
    ref_subtract(p, f->base, l);
    double z = ref_dot(l, f->axis);
    ref_along(l, -z, f->axis, across);
    return z;
}

static void frustum_normal(const struct frustum *f, const double across[3], double normal[3])
{
    double radial[3] = {across[0], across[1], across[2]};
    ref_normalize(radial);
    ref_along(radial, -f->slope, f->axis, normal);
    ref_normalize(normal);
}

static void frustum_crossing(const struct frustum *f, const struct ref_ray *ray, double t,
                             double clearance, struct ref_hit *hit)
{
    double p[3], across[3];
    ref_along(ray->o, t, ray->d, p);
    double z = split(f, p, across);
    *hit = (struct ref_hit){.t = t};
    frustum_normal(f, across, hit->normal);
    hit->cosine = fabs(ref_dot(hit->normal, ray->d)) / ref_length(ray->d);
    hit->clearance = fmin(clearance, fmin(z, f->height - z));
}

// |across|^2 = (base_radius + slope z)^2, about the point of the line nearest to the cone's middle.
static int cone_crossings(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                          struct ref_hit hits[2])
{
    struct frustum f = frustum_of(scene, prim);
    double middle[3], l[3], o[3], across[3], d_across[3];
    ref_along(f.base, 0.5 * f.height, f.axis, middle);
    ref_subtract(middle, ray->o, l);
    double shift = ref_dot(l, ray->d) / ref_dot(ray->d, ray->d);
    ref_along(ray->o, shift, ray->d, o);
    double z = split(&f, o, across), dz = ref_dot(ray->d, f.axis);
    ref_along(ray->d, -dz, f.axis, d_across);
    double radius = f.base_radius + f.slope * z, d_radius = f.slope * dz;
    double a = ref_dot(d_across, d_across) - d_radius * d_radius;
    double b = ref_dot(across, d_across) - radius * d_radius;
    double c = ref_dot(across, across) - radius * radius;
    double discriminant = b * b - a * c;
    if (!(discriminant >= 0.0) || a == 0.0)
        return 0;
    double q = -(b + copysign(sqrt(discriminant), b));
    double roots[2] = {shift + q / a, q != 0.0 ? shift + c / q : shift + q / a};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        double height = z + (roots[i] - shift) * dz, r = f.base_radius + f.slope * height;
        if (!(roots[i] > 0.0) || !(height >= 0.0 && height <= f.height) || r < 0.0 ||
            (prim == ray->self && fabs(roots[i]) <= fabs(roots[1 - i])))
            continue;
        frustum_crossing(&f, ray, roots[i], discriminant / (2.0 * fabs(a) * r), &hits[count]);
        hits[count++].prim = prim;
    }
    return count;
}

static int plane_crossings(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                           struct ref_hit hits[2])
{
    const struct rb_plane *plane = &scene->planes[prim - scene->first[RB_PLANE]];
    double n[3];
    ref_widen(plane->normal, n);
    double facing = ref_dot(n, ray->d), length = ref_length(n);
    double t = ((double)plane->distance - ref_dot(n, ray->o)) / facing;
    if (prim == ray->self || !(t > 0.0 && t < HUGE_VAL))
        return 0;
    hits[0] = (struct ref_hit){t,
                               {n[0] / length, n[1] / length, n[2] / length},
                               fabs(facing) / length / ref_length(ray->d),
                               HUGE_VAL,
                               prim};
    return 1;
}

// The norm's rule of sides: what has a negative radius is seen from inside only; one-sided rays see
// opaque surfaces from their front only; shadow rays see everything.
static bool visible(const struct rb_scene *scene, const struct ref_ray *ray,
                    const struct ref_hit *hit)
{
    enum rb_kind kind = rb_scene_kind(scene, hit->prim);
    bool from_inside = ref_dot(hit->normal, ray->d) > 0.0;
    bool inside_only =
        (kind == RB_SPHERE && scene->spheres[hit->prim].radius < 0.0f) ||
        (kind == RB_CONE && scene->cones[hit->prim - scene->first[RB_CONE]].inside > 0.0f);
    if (ray->shadow)
        return true;
    if (inside_only)
        return from_inside;
    return !ray->one_sided || !from_inside ||
           scene->materials[scene->material_of[hit->prim]].t > 0.0f;
}

int ref_crossings(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                  struct ref_hit hits[2])
{
    struct ref_hit all[2];
    int found = 0, kept = 0;
    if (prim == ray->self && ray->shadow)
        return 0;
    switch (rb_scene_kind(scene, prim)) {
    case RB_SPHERE:
        found = sphere_crossings(scene, prim, ray, all);
        break;
    case RB_TRIANGLE:
        found = triangle_crossings(scene, prim, ray, all);
        break;
    case RB_CONE:
        found = cone_crossings(scene, prim, ray, all);
        break;
    default:
        found = plane_crossings(scene, prim, ray, all);
    }
    for (int i = 0; i < found; i++)
        if (visible(scene, ray, &all[i]))
            hits[kept++] = all[i];
    return kept;
}

bool ref_shadows_itself(const struct rb_scene *scene, const struct ref_ray *ray, double distance)
{
    struct ref_hit hits[2];
    int count = 0;
    if (scene->materials[scene->material_of[ray->self]].t > 0.0f)
        return false;
    if (rb_scene_kind(scene, ray->self) == RB_SPHERE)
        count = sphere_crossings(scene, ray->self, ray, hits);
    if (rb_scene_kind(scene, ray->self) == RB_CONE)
        count = cone_crossings(scene, ray->self, ray, hits);
    return count > 0 && hits[0].t < distance;
}

double ref_distance(const struct rb_scene *scene, uint32_t prim, const double p[3])
{
    double l[3], across[3], n[3];
    switch (rb_scene_kind(scene, prim)) {
    case RB_SPHERE:
        ref_widen(scene->spheres[prim].center, n);
        ref_subtract(p, n, l);
        return fabs(ref_length(l) - fabs((double)scene->spheres[prim].radius));
    case RB_TRIANGLE: {
        struct corners c = corners_of(scene, prim);
        return triangle_distance(&c, p);
    }
    case RB_CONE: { // in the half plane of height and radius the frustum is a segment
        struct frustum f = frustum_of(scene, prim);
        double z = split(&f, p, across), r = ref_length(across) - f.base_radius;
        double s = clamp((z + r * f.slope) / (1.0 + f.slope * f.slope), 0.0, f.height);
        return hypot(z - s, r - f.slope * s);
    }
    default: {
        const struct rb_plane *plane = &scene->planes[prim - scene->first[RB_PLANE]];
        ref_widen(plane->normal, n);
        return fabs(ref_dot(n, p) - (double)plane->distance) / ref_length(n);
    }
    }
}

double ref_off(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray, double t)
{
    double p[3], w[3], gap = HUGE_VAL;
    ref_along(ray->o, t, ray->d, p);
    if (rb_scene_kind(scene, prim) != RB_TRIANGLE)
        return ref_distance(scene, prim, p);
    struct corners c = corners_of(scene, prim);
    struct ref_hit hits[2];
    struct ref_ray line = *ray;
    line.self = RB_NONE, line.shadow = true;
    for (int i = 0; i < 3; i++)
        gap = fmin(gap, line_segment_distance(ray->o, ray->d, c.v[i], c.v[(i + 1) % 3]));
    if (ref_crossings(scene, prim, &line, hits))
        gap = 0.0;
    ref_subtract(p, c.v[0], w);
    return fmax(gap, fabs(ref_dot(w, c.normal)));
}

// Barycentric weights of p's foot on the triangle, as shares of its area.
static bool smooth_normal(const struct rb_scene *scene, uint32_t prim, const struct corners *c,
                          const double p[3], double normal[3])
{
    uint32_t index = prim - scene->first[RB_TRIANGLE];
    if (!scene->triangle_smooth || scene->triangle_smooth[index] == RB_NONE)
        return false;
    const float(*normals)[3] =
        (const float(*)[3])scene->smooth_normals[scene->triangle_smooth[index]];
    memset(normal, 0, 3 * sizeof *normal);
    for (int i = 0; i < 3; i++) {
        double a[3], b[3], area[3], n[3];
        ref_subtract(c->v[(i + 1) % 3], p, a);
        ref_subtract(c->v[(i + 2) % 3], p, b);
        ref_cross(a, b, area);
        ref_widen(normals[i], n);
        ref_along(normal, ref_dot(area, c->normal), n, normal);
    }
    return ref_normalize(normal);
}

void ref_normal(const struct rb_scene *scene, uint32_t prim, const double p[3], double normal[3])
{
    double across[3];
    switch (rb_scene_kind(scene, prim)) {
    case RB_SPHERE:
        ref_widen(scene->spheres[prim].center, across);
        ref_subtract(p, across, normal);
        break;
    case RB_TRIANGLE: {
        struct corners c = corners_of(scene, prim);
        if (!smooth_normal(scene, prim, &c, p, normal))
            memcpy(normal, c.normal, sizeof c.normal);
        break;
    }
    case RB_CONE: {
        struct frustum f = frustum_of(scene, prim);
        split(&f, p, across);
        frustum_normal(&f, across, normal);
        break;
    }
    default:
        ref_widen(scene->planes[prim - scene->first[RB_PLANE]].normal, normal);
    }
    ref_normalize(normal);
}
