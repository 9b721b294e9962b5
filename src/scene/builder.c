// Adds lights, materials and primitives to a scene under construction: checks what comes in, rounds
// it to single precision once and derives what the kernels need. scene.c seals the result.
//
// Everything derived (normals, cone axes, boxes) is computed in double precision from the rounded
// values, because those are what the kernels see.
#include "scene/scene.h"

#include <math.h>
#include <stdbool.h>

// Indices of refraction beyond these mean nothing, and their squares must not overflow.
#define IOR_MIN 1e-3
#define IOR_MAX 1e3

// A frustum whose radius changes by more than this per unit of height is a disc: its height drowns
// in the rounding of its coordinates, and the square of the slope in every other term.
#define SLOPE_MAX 1e6

// Objects before any material: matt white, as bright as paper.
static const struct rb_material default_material = {
    .color = {1.0f, 1.0f, 1.0f}, .kd = 0.8f, .shine = 1.0f, .ior = 1.0f};

static const size_t primitive_size[RB_KIND_COUNT] = {
    sizeof(struct rb_sphere), sizeof(struct rb_triangle), sizeof(struct rb_cone),
    sizeof(struct rb_plane)};

// Adding zero turns -0 into +0, so that equal scenes have equal bits.
static float rounded(double x)
{
    return (float)x + 0.0f;
}

static void round_vector(const double from[3], float to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = rounded(from[i]);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double reach(const double a[3])
{
    return fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
}

// Makes `a` a unit vector. Scaled by its largest component first, so that nothing underflows.
static bool normalize(double a[3])
{
    double largest = reach(a);
    if (!(largest > 0.0))
        return false;
    for (int i = 0; i < 3; i++)
        a[i] /= largest;
    double length = sqrt(dot(a, a));
    for (int i = 0; i < 3; i++)
        a[i] /= length;
    return true;
}

static enum rb_status check_vector(const double a[3], const char *what, struct rb_error *error)
{
    for (int i = 0; i < 3; i++) {
        if (!(fabs(a[i]) <= RB_COORDINATE_MAX))
            return rb_error_set(error, RB_INVALID, "%s has a coordinate that is not within +-%g",
                                what, RB_COORDINATE_MAX);
    }
    return RB_OK;
}

static enum rb_status check_range(double x, double low, const char *what, struct rb_error *error)
{
    if (x >= low && x <= RB_COORDINATE_MAX)
        return RB_OK;
    return rb_error_set(error, RB_INVALID, "%s must be a number from %g to %g", what, low,
                        RB_COORDINATE_MAX);
}

static enum rb_status check_color(const double color[3], const char *what, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (int i = 0; i < 3 && status == RB_OK; i++)
        status = check_range(color[i], 0.0, what, error);
    return status;
}

enum rb_status rb_scene_add_light(struct rb_scene_builder *builder, const double position[3],
                                  const double color[3], struct rb_error *error)
{
    enum rb_status status = check_vector(position, "the light", error);
    if (status == RB_OK)
        status = check_color(color, "a light's colour", error);
    if (status != RB_OK)
        return status;
    struct rb_light light;
    round_vector(position, light.position);
    round_vector(color, light.color);
    if (builder->lights.count >= RB_NONE - 1 ||
        !rb_array_push(&builder->lights, &light, sizeof light))
        return rb_error_memory(error, "the lights");
    return RB_OK;
}

static enum rb_status check_material(const double color[3], double kd, double ks, double shine,
                                     double t, double ior, struct rb_error *error)
{
    const struct {
        double value;
        const char *name;
    } parts[] = {{kd, "Kd"}, {ks, "Ks"}, {shine, "Shine"}, {t, "T"}};
    enum rb_status status = check_color(color, "a material's colour", error);
    for (size_t i = 0; i < sizeof parts / sizeof *parts && status == RB_OK; i++)
        status = check_range(parts[i].value, 0.0, parts[i].name, error);
    if (status != RB_OK)
        return status;
    if (!(fabs(ior) <= RB_COORDINATE_MAX) || (t > 0.0 && (ior < IOR_MIN || ior > IOR_MAX)))
        return rb_error_set(error, RB_INVALID,
                            "the index of refraction of a material with T > 0 must be from %g "
                            "to %g",
                            IOR_MIN, IOR_MAX);
    return RB_OK;
}

enum rb_status rb_scene_add_material(struct rb_scene_builder *builder, const double color[3],
                                     double kd, double ks, double shine, double t, double ior,
                                     struct rb_error *error)
{
    enum rb_status status = check_material(color, kd, ks, shine, t, ior, error);
    if (status != RB_OK)
        return status;
    struct rb_material material = {.kd = rounded(kd),
                                   .ks = rounded(ks),
                                   .shine = rounded(shine),
                                   .t = rounded(t),
                                   .ior = rounded(ior)};
    round_vector(color, material.color);
    if (builder->materials.count >= RB_NONE - 1 ||
        !rb_array_push(&builder->materials, &material, sizeof material))
        return rb_error_memory(error, "the materials");
    return RB_OK;
}

// Appends one primitive and its material.
static enum rb_status add_primitive(struct rb_scene_builder *builder, enum rb_kind kind,
                                    const void *primitive, struct rb_error *error)
{
    size_t total = 0;
    for (int k = 0; k < RB_KIND_COUNT; k++)
        total += builder->primitives[k].count;
    if (total >= RB_NONE - 1)
        return rb_error_set(error, RB_INVALID, "more than %u primitives", RB_NONE - 1);
    if (builder->materials.count == 0 &&
        !rb_array_push(&builder->materials, &default_material, sizeof default_material))
        return rb_error_memory(error, "the materials");
    uint32_t material = (uint32_t)(builder->materials.count - 1);
    if (!rb_array_push(&builder->primitives[kind], primitive, primitive_size[kind]) ||
        !rb_array_push(&builder->primitive_materials[kind], &material, sizeof material))
        return rb_error_memory(error, "the primitives");
    return RB_OK;
}

enum rb_status rb_scene_add_sphere(struct rb_scene_builder *builder, const double center[3],
                                   double radius, struct rb_error *error)
{
    enum rb_status status = check_vector(center, "the sphere's centre", error);
    if (status == RB_OK)
        status = check_range(radius, -RB_COORDINATE_MAX, "the sphere's radius", error);
    if (status != RB_OK)
        return status;
    struct rb_sphere sphere = {.radius = rounded(radius)};
    round_vector(center, sphere.center);
    if (sphere.radius == 0.0f) {
        builder->degenerate_count++;
        return RB_OK;
    }
    return add_primitive(builder, RB_SPHERE, &sphere, error);
}

// Cross product of two edges, computed in double precision from the stored vertices.
static void triangle_cross(const struct rb_triangle *triangle, double out[3])
{
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
        a[i] = (double)triangle->v[1][i] - (double)triangle->v[0][i];
        b[i] = (double)triangle->v[2][i] - (double)triangle->v[0][i];
    }
    cross(a, b, out);
}

// Unit vertex normals in single precision.
static enum rb_status round_normals(const double (*normals)[3], float out[3][3],
                                    struct rb_error *error)
{
    for (int i = 0; i < 3; i++) {
        double n[3] = {normals[i][0], normals[i][1], normals[i][2]};
        enum rb_status status = check_vector(n, "a vertex normal", error);
        if (status != RB_OK)
            return status;
        if (!normalize(n))
            return rb_error_set(error, RB_INVALID, "a vertex normal has length zero");
        round_vector(n, out[i]);
    }
    return RB_OK;
}

// Records that the newest triangle is smooth, or flat if `normals` is NULL. The array of indices
// exists only once there is a smooth triangle.
static bool push_smooth(struct rb_scene_builder *builder, const float (*normals)[3])
{
    const uint32_t flat = RB_NONE;
    struct rb_array *smooth = &builder->triangle_smooth;
    if (!normals && builder->smooth_normals.count == 0)
        return true;
    while (smooth->count + 1 < builder->primitives[RB_TRIANGLE].count) {
        if (!rb_array_push(smooth, &flat, sizeof flat))
            return false;
    }
    if (!normals)
        return rb_array_push(smooth, &flat, sizeof flat);
    uint32_t index = (uint32_t)builder->smooth_normals.count;
    return rb_array_push(smooth, &index, sizeof index) &&
           rb_array_push(&builder->smooth_normals, normals, sizeof(float[3][3]));
}

enum rb_status rb_scene_add_triangle(struct rb_scene_builder *builder, const double v[3][3],
                                     const double (*normals)[3], struct rb_error *error)
{
    struct rb_triangle triangle;
    float smooth[3][3];
    for (int i = 0; i < 3; i++) {
        enum rb_status status = check_vector(v[i], "a vertex", error);
        if (status != RB_OK)
            return status;
        round_vector(v[i], triangle.v[i]);
    }
    enum rb_status status = normals ? round_normals(normals, smooth, error) : RB_OK;
    if (status != RB_OK)
        return status;

    double n[3];
    triangle_cross(&triangle, n);
    if (!normalize(n)) {
        builder->degenerate_count++;
        return RB_OK;
    }
    float normal[3];
    round_vector(n, normal);
    status = add_primitive(builder, RB_TRIANGLE, &triangle, error);
    if (status != RB_OK)
        return status;
    if (!rb_array_push(&builder->triangle_normals, normal, sizeof normal) ||
        !push_smooth(builder, normals ? (const float(*)[3])smooth : NULL))
        return rb_error_memory(error, "the triangles' normals");
    return RB_OK;
}

// The box around the two end discs of the stored cone. A disc of radius r across the unit axis w
// reaches r sqrt(1 - w_i^2) along axis i; the root of the other two squares does not cancel. The
// stored axis is off by up to 2^-24 in each component and a kernel's evaluation by a few times
// that, all relative to the size of the cone: 2^-20 of it is put around.
//
// The solver's centre is the small end of a cone, not the middle: near the tip |p'|^2 - r^2
// cancels, and measured from the middle tips came out 1092 ulps off.
static void cone_bounds(struct rb_cone *cone)
{
    double height = (double)cone->height, base_radius = (double)cone->base_radius;
    double apex_radius = fmax(base_radius + (double)cone->slope * height, 0.0);
    double margin = 0x1p-20 * (height + fmax(base_radius, apex_radius));
    for (int i = 0; i < 3; i++) {
        double base = (double)cone->base[i], apex = base + (double)cone->axis[i] * height;
        double across = hypot((double)cone->axis[(i + 1) % 3], (double)cone->axis[(i + 2) % 3]);
        double low = fmin(base - base_radius * across, apex - apex_radius * across) - margin;
        double high = fmax(base + base_radius * across, apex + apex_radius * across) + margin;
        cone->low[i] = nextafterf(rounded(low), -INFINITY);
        cone->high[i] = nextafterf(rounded(high), INFINITY);
        double small_end = cone->slope < 0.0f ? apex : base;
        cone->center[i] = rounded(cone->slope == 0.0f ? 0.5 * (low + high) : small_end);
    }
}

enum rb_status rb_scene_add_cone(struct rb_scene_builder *builder, const double base[3],
                                 double base_radius, const double apex[3], double apex_radius,
                                 struct rb_error *error)
{
    enum rb_status status = check_vector(base, "the cone's base", error);
    if (status == RB_OK)
        status = check_vector(apex, "the cone's apex", error);
    if (status == RB_OK)
        status = check_range(base_radius, -RB_COORDINATE_MAX, "the base radius", error);
    if (status == RB_OK)
        status = check_range(apex_radius, -RB_COORDINATE_MAX, "the apex radius", error);
    if (status != RB_OK)
        return status;
    if ((base_radius < 0.0 && apex_radius > 0.0) || (base_radius > 0.0 && apex_radius < 0.0))
        return rb_error_set(error, RB_INVALID,
                            "the radii of a cone must have the same sign (both negative: visible "
                            "from inside only)");

    float r0 = rounded(base_radius), r1 = rounded(apex_radius), top[3];
    struct rb_cone cone = {.base_radius = fabsf(r0), .inside = r0 < 0.0f || r1 < 0.0f};
    round_vector(base, cone.base);
    round_vector(apex, top);
    double axis[3];
    for (int i = 0; i < 3; i++)
        axis[i] = (double)top[i] - (double)cone.base[i];
    double height = sqrt(dot(axis, axis));
    if (!normalize(axis) || (r0 == 0.0f && r1 == 0.0f)) {
        builder->degenerate_count++;
        return RB_OK;
    }
    double slope = ((double)fabsf(r1) - (double)fabsf(r0)) / height;
    if (fabs(slope) > SLOPE_MAX)
        return rb_error_set(error, RB_INVALID,
                            "the radii of the cone differ by more than %g times its length; "
                            "write a polygon instead",
                            SLOPE_MAX);
    round_vector(axis, cone.axis);
    cone.height = rounded(height);
    cone.slope = rounded(slope);
    cone_bounds(&cone);
    return add_primitive(builder, RB_CONE, &cone, error);
}

// The normal comes from the points as given. They are collinear if the cross product is within its
// own error: 2^-53 of the largest coordinate in each point, times the other edge, and some to
// spare.
enum rb_status rb_scene_add_plane(struct rb_scene_builder *builder, const double p[3][3],
                                  struct rb_error *error)
{
    double largest = 0.0;
    for (int i = 0; i < 3; i++) {
        enum rb_status status = check_vector(p[i], "a point of the plane", error);
        if (status != RB_OK)
            return status;
        largest = fmax(largest, reach(p[i]));
    }
    double a[3], b[3], n[3];
    subtract(p[1], p[0], a);
    subtract(p[2], p[0], b);
    cross(a, b, n);
    if (!(reach(n) > 0x1p-48 * largest * (reach(a) + reach(b))) || !normalize(n))
        return rb_error_set(error, RB_INVALID,
                            "the three points of the plane lie on one line; move one of them");
    struct rb_plane plane;
    round_vector(n, plane.normal);
    // Of the stored normal, and right on average at the three points.
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            sum += (double)plane.normal[k] * p[i][k];
    }
    plane.distance = rounded(sum / 3.0);
    return add_primitive(builder, RB_PLANE, &plane, error);
}
