// Ray and surface in double precision, one primitive at a time, as a textbook has it. Coordinates
// come in as floats, so differences of them are exact or nearly so, and double precision leaves 29
// bits between its own error and what single precision can see.
#include "tests/support/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF_MAX = 4, STACK = 128 };

double ref_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double ref_length(const double a[3])
{
    return sqrt(ref_dot(a, a));
}

void ref_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void ref_along(const double o[3], double t, const double d[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = o[k] + t * d[k];
}

bool ref_normalize(double a[3])
{
    double length = ref_length(a);
    if (!(length > 0.0))
        return false;
    for (int k = 0; k < 3; k++)
        a[k] /= length;
    return true;
}

static void widen(const float a[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k];
}

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

double ref_uniform(struct ref_random *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

double ref_between(struct ref_random *random, double low, double high)
{
    return low + (high - low) * ref_uniform(random);
}

uint32_t ref_below(struct ref_random *random, uint32_t limit)
{
    return (uint32_t)(ref_uniform(random) * limit);
}

void ref_direction(struct ref_random *random, double d[3])
{
    double z = ref_between(random, -1.0, 1.0), angle = ref_between(random, 0.0, 2.0 * acos(-1.0));
    double across = sqrt(1.0 - z * z);
    d[0] = across * cos(angle), d[1] = across * sin(angle), d[2] = z;
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
        widen(triangle->v[i], c.v[i]);
    double a[3], b[3];
    subtract(c.v[1], c.v[0], a);
    subtract(c.v[2], c.v[0], b);
    ref_cross(a, b, c.normal);
    ref_normalize(c.normal);
    return c;
}

// Distance between the line o + t d and the segment from a to b.
static double line_segment_distance(const double o[3], const double d[3], const double a[3],
                                    const double b[3])
{
    double e[3], w[3], apart[3];
    subtract(b, a, e);
    subtract(a, o, w);
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
        subtract(b, a, e);
        subtract(p, a, w);
        ref_cross(e, w, side);
        above = above && ref_dot(side, c->normal) >= 0.0;
        double s = clamp(ref_dot(w, e) / ref_dot(e, e), 0.0, 1.0);
        ref_along(w, -s, e, apart);
        nearest = fmin(nearest, ref_length(apart));
    }
    double w[3];
    subtract(p, c->v[0], w);
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
        subtract(c.v[i], ray->o, w[i]);
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
    widen(sphere->center, c);
    subtract(c, ray->o, l);
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
    widen(cone->base, f.base);
    widen(cone->axis, f.axis);
    ref_normalize(f.axis);
    return f;
}

// Splits p - base into the height along the axis and the rest, across.
static double split(const struct frustum *f, const double p[3], double across[3])
{
    double l[3];
    subtract(p, f->base, l);
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
    subtract(middle, ray->o, l);
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
    widen(plane->normal, n);
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

static const struct ref_hit miss = {.t = HUGE_VAL, .prim = RB_NONE};

static void take_closer(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                        struct ref_hit *best)
{
    struct ref_hit hits[2];
    int count = ref_crossings(scene, prim, ray, hits);
    for (int i = 0; i < count; i++)
        if (hits[i].t < best->t || (hits[i].t == best->t && hits[i].prim < best->prim))
            *best = hits[i];
}

struct ref_hit ref_closest_brute(const struct rb_scene *scene, const struct ref_ray *ray)
{
    struct ref_hit best = miss;
    for (uint32_t prim = 0; prim < scene->primitive_count; prim++)
        take_closer(scene, prim, ray, &best);
    return best;
}

// Where the ray is inside a box, from *near to *far; false if nowhere. The box is widened by more
// than double precision can lose.
static bool box_range(const struct ref_node *node, const struct ref_ray *ray, double *near,
                      double *far)
{
    *near = 0.0, *far = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        double margin = 1e-12 * (fabs(ray->o[k]) + fabs(node->low[k]) + fabs(node->high[k]));
        double low = node->low[k] - margin - ray->o[k], high = node->high[k] + margin - ray->o[k];
        if (ray->d[k] == 0.0) {
            if (low > 0.0 || high < 0.0)
                return false;
            continue;
        }
        double a = low / ray->d[k], b = high / ray->d[k];
        *near = fmax(*near, fmin(a, b) * (1.0 - 1e-12));
        *far = fmin(*far, fmax(a, b) * (1.0 + 1e-12));
    }
    return *near <= *far;
}

// HUGE_VAL if the ray passes the box by.
static double box_entry(const struct ref_node *node, const struct ref_ray *ray)
{
    double near, far;
    return box_range(node, ray, &near, &far) ? near : HUGE_VAL;
}

struct ref_hit ref_closest(const struct ref_world *world, const struct ref_ray *ray)
{
    const struct rb_scene *scene = world->scene;
    struct ref_hit best = miss;
    uint32_t stack[STACK];
    int depth = 0;
    for (uint32_t prim = scene->bounded_count; prim < scene->primitive_count; prim++)
        take_closer(scene, prim, ray, &best);
    if (world->node_count)
        stack[depth++] = 0;
    while (depth > 0) {
        const struct ref_node *node = &world->nodes[stack[--depth]];
        double entry = box_entry(node, ray);
        if (entry == HUGE_VAL || entry > best.t)
            continue;
        for (uint32_t i = 0; i < node->count; i++)
            take_closer(scene, world->refs[node->first + i], ray, &best);
        if (node->count == 0) {
            bool swap = box_entry(&world->nodes[node->first], ray) <
                        box_entry(&world->nodes[node->first + 1], ray);
            stack[depth++] = node->first + swap;
            stack[depth++] = node->first + !swap;
        }
    }
    return best;
}

static bool crosses_before(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                           double distance)
{
    struct ref_hit hits[2];
    int count = ref_crossings(scene, prim, ray, hits);
    return (count > 0 && hits[0].t < distance) || (count > 1 && hits[1].t < distance);
}

bool ref_occluded(const struct ref_world *world, const struct ref_ray *ray, double distance)
{
    const struct rb_scene *scene = world->scene;
    uint32_t stack[STACK];
    int depth = 0;
    for (uint32_t prim = scene->bounded_count; prim < scene->primitive_count; prim++)
        if (crosses_before(scene, prim, ray, distance))
            return true;
    if (world->node_count)
        stack[depth++] = 0;
    while (depth > 0) {
        const struct ref_node *node = &world->nodes[stack[--depth]];
        if (!(box_entry(node, ray) < distance))
            continue;
        for (uint32_t i = 0; i < node->count; i++)
            if (crosses_before(scene, world->refs[node->first + i], ray, distance))
                return true;
        if (node->count == 0) {
            stack[depth++] = node->first;
            stack[depth++] = node->first + 1;
        }
    }
    return false;
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

double ref_depth_before(const struct rb_scene *scene, const struct ref_ray *ray, double distance)
{
    double deepest = 0.0, length = ref_length(ray->d);
    for (uint32_t prim = 0; prim < scene->primitive_count; prim++) {
        struct ref_hit hits[2];
        int count = ref_crossings(scene, prim, ray, hits);
        for (int i = 0; i < count; i++) {
            double ahead = (distance - hits[i].t) * length * hits[i].cosine;
            double behind = hits[i].t * length * hits[i].cosine;
            deepest = fmax(deepest, fmin(hits[i].clearance, fmin(ahead, behind)));
        }
    }
    return deepest;
}

double ref_distance(const struct rb_scene *scene, uint32_t prim, const double p[3])
{
    double l[3], across[3], n[3];
    switch (rb_scene_kind(scene, prim)) {
    case RB_SPHERE:
        widen(scene->spheres[prim].center, n);
        subtract(p, n, l);
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
        widen(plane->normal, n);
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
    struct ref_ray line = {.self = RB_NONE, .shadow = true};
    memcpy(line.o, ray->o, sizeof line.o), memcpy(line.d, ray->d, sizeof line.d);
    for (int i = 0; i < 3; i++)
        gap = fmin(gap, line_segment_distance(ray->o, ray->d, c.v[i], c.v[(i + 1) % 3]));
    if (triangle_crossings(scene, prim, &line, hits))
        gap = 0.0;
    subtract(p, c.v[0], w);
    return fmax(gap, fabs(ref_dot(w, c.normal)));
}

static double distance_at(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                          double t)
{
    double p[3];
    ref_along(ray->o, t, ray->d, p);
    return ref_distance(scene, prim, p);
}

// The smallest distance of a primitive from the piece low <= t <= high of a ray: steps, then
// ternary search around the best of them.
static double piece_distance(const struct rb_scene *scene, uint32_t prim, const struct ref_ray *ray,
                             double low, double high)
{
    enum { STEPS = 64 };
    double nearest = HUGE_VAL, best = low, step = (high - low) / STEPS;
    for (int i = 0; i <= STEPS; i++) {
        double here = distance_at(scene, prim, ray, low + i * step);
        if (here < nearest)
            nearest = here, best = low + i * step;
    }
    low = fmax(low, best - step), high = fmin(high, best + step);
    for (int i = 0; i < 60; i++) {
        double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
        if (distance_at(scene, prim, ray, a) < distance_at(scene, prim, ray, b))
            high = b;
        else
            low = a;
    }
    return fmin(nearest, distance_at(scene, prim, ray, low));
}

double ref_gap_before(const struct rb_scene *scene, const struct ref_ray *ray, double distance)
{
    double nearest = HUGE_VAL;
    for (uint32_t prim = 0; prim < scene->primitive_count; prim++) {
        double from = 0.0, to = distance;
        if (prim == ray->self)
            continue;
        if (crosses_before(scene, prim, ray, distance))
            return 0.0;
        if (prim < scene->bounded_count) { // look where it is near; elsewhere it cannot be at fault
            float low[3], high[3];
            struct ref_node box;
            rb_scene_bounds(scene, prim, low, high);
            for (int k = 0; k < 3; k++) {
                double margin = 1e-3 * (fabs((double)high[k]) + fabs((double)low[k]) + 1e-3);
                box.low[k] = (double)low[k] - margin, box.high[k] = (double)high[k] + margin;
            }
            if (!box_range(&box, ray, &from, &to) || from > distance)
                continue;
        }
        nearest = fmin(nearest, piece_distance(scene, prim, ray, from, fmin(to, distance)));
    }
    return nearest;
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
        subtract(c->v[(i + 1) % 3], p, a);
        subtract(c->v[(i + 2) % 3], p, b);
        ref_cross(a, b, area);
        widen(normals[i], n);
        ref_along(normal, ref_dot(area, c->normal), n, normal);
    }
    return ref_normalize(normal);
}

void ref_normal(const struct rb_scene *scene, uint32_t prim, const double p[3], double normal[3])
{
    double across[3];
    switch (rb_scene_kind(scene, prim)) {
    case RB_SPHERE:
        widen(scene->spheres[prim].center, across);
        subtract(p, across, normal);
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
        widen(scene->planes[prim - scene->first[RB_PLANE]].normal, normal);
    }
    ref_normalize(normal);
}

double ref_reach(const struct rb_scene *scene, uint32_t prim)
{
    if (prim >= scene->bounded_count)
        return fabs((double)scene->planes[prim - scene->first[RB_PLANE]].distance);
    float low[3], high[3];
    double reach = 0.0;
    rb_scene_bounds(scene, prim, low, high);
    for (int k = 0; k < 3; k++)
        reach = fmax(reach, fmax(fabs((double)low[k]), fabs((double)high[k])));
    return reach;
}

// Building the tree: boxes around everything, halved at the median of the longest axis.
struct build_item {
    double low[3], high[3];
    uint32_t prim;
    double key;
};

static int compare_items(const void *a, const void *b)
{
    double x = ((const struct build_item *)a)->key, y = ((const struct build_item *)b)->key;
    return (x > y) - (x < y);
}

static void set_bounds(struct ref_node *node, const struct build_item *items, uint32_t count)
{
    for (int k = 0; k < 3; k++) {
        node->low[k] = HUGE_VAL, node->high[k] = -HUGE_VAL;
        for (uint32_t i = 0; i < count; i++) {
            node->low[k] = fmin(node->low[k], items[i].low[k]);
            node->high[k] = fmax(node->high[k], items[i].high[k]);
        }
    }
}

static void build_node(struct ref_world *world, uint32_t index, struct build_item *items,
                       uint32_t first, uint32_t count)
{
    struct ref_node *node = &world->nodes[index];
    int axis = 0;
    set_bounds(node, items + first, count);
    for (int k = 1; k < 3; k++)
        if (node->high[k] - node->low[k] > node->high[axis] - node->low[axis])
            axis = k;
    if (count <= LEAF_MAX) {
        node->first = first, node->count = count;
        return;
    }
    for (uint32_t i = first; i < first + count; i++)
        items[i].key = items[i].low[axis] + items[i].high[axis];
    qsort(items + first, count, sizeof *items, compare_items);
    node->first = world->node_count, node->count = 0;
    world->node_count += 2;
    uint32_t half = count / 2, child = node->first;
    build_node(world, child, items, first, half);
    build_node(world, child + 1, items, first + half, count - half);
}

// The box of a primitive by its definition, not by rb_scene_bounds, which is under test.
static void item_bounds(const struct rb_scene *scene, uint32_t prim, struct build_item *item)
{
    float low[3], high[3];
    enum rb_kind kind = rb_scene_kind(scene, prim);
    if (kind == RB_CONE) // wide enough: the kernels' box and its half again
        rb_scene_bounds(scene, prim, low, high);
    struct corners c;
    if (kind == RB_TRIANGLE)
        c = corners_of(scene, prim);
    for (int k = 0; k < 3; k++) {
        if (kind == RB_SPHERE) {
            double r = fabs((double)scene->spheres[prim].radius);
            item->low[k] = (double)scene->spheres[prim].center[k] - r;
            item->high[k] = (double)scene->spheres[prim].center[k] + r;
        } else if (kind == RB_TRIANGLE) {
            item->low[k] = fmin(c.v[0][k], fmin(c.v[1][k], c.v[2][k]));
            item->high[k] = fmax(c.v[0][k], fmax(c.v[1][k], c.v[2][k]));
        } else {
            double size = (double)high[k] - (double)low[k];
            item->low[k] = (double)low[k] - 0.25 * size;
            item->high[k] = (double)high[k] + 0.25 * size;
        }
    }
    item->prim = prim;
}

bool ref_world_build(const struct rb_scene *scene, struct ref_world *world)
{
    uint32_t count = scene->bounded_count;
    *world = (struct ref_world){.scene = scene};
    struct build_item *items = calloc((size_t)count + 1, sizeof *items);
    world->nodes = calloc(2 * (size_t)count + 1, sizeof *world->nodes);
    world->refs = calloc((size_t)count + 1, sizeof *world->refs);
    bool built = items && world->nodes && world->refs;
    if (built && count) {
        for (uint32_t i = 0; i < count; i++)
            item_bounds(scene, i, &items[i]);
        world->node_count = 1;
        build_node(world, 0, items, 0, count);
        for (uint32_t i = 0; i < count; i++)
            world->refs[i] = items[i].prim;
    }
    free(items);
    if (!built)
        ref_world_free(world);
    return built;
}

void ref_world_free(struct ref_world *world)
{
    free(world->nodes);
    free(world->refs);
    *world = (struct ref_world){0};
}
