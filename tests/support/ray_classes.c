// Aims at the places where single precision decides badly: edges, vertices, silhouettes, rims,
// axes, from near, from far and from within.
#include "tests/support/ray_classes.h"

#include <math.h>

static void begin_scene(struct rb_scene_builder *builder)
{
    *builder =
        (struct rb_scene_builder){.camera = {{4, 3, 2}, {0, 0, 0}, {0, 0, 1}, 45.0, 0.01, 64, 64}};
    stage_check(rb_scene_add_light(builder, (const double[3]){-100, -100, 100},
                                   (const double[3]){1, 1, 1}, &stage_failure));
    stage_check(rb_scene_add_material(builder, (const double[3]){1, 1, 1}, 0.5, 0.5, 10.0, 0.5, 1.2,
                                      &stage_failure));
}

static void random_point(struct ref_random *random, double reach, double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = ref_between(random, -reach, reach);
}

void stage_soup(struct stage *stage, double center)
{
    struct ref_random random = {11};
    struct rb_scene_builder builder;
    begin_scene(&builder);
    for (int i = 0; i < 40; i++) {
        double size = pow(10.0, ref_between(&random, -2.0, 0.0)), p[3], v[3][3];
        random_point(&random, 2.0, p);
        for (int k = 0; k < 3; k++)
            p[k] += center;
        stage_check(rb_scene_add_sphere(&builder, p, i % 5 ? size : -size, &stage_failure));
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                v[j][k] = p[k] + ref_between(&random, -size, size) * 2.0;
        stage_check(rb_scene_add_triangle(
            &builder, (const double(*)[3])v,
            i % 4 ? NULL : (const double[3][3]){{1, 0, 0}, {1, 1, 0}, {1, 0, 1}}, &stage_failure));
        double sign = i % 6 ? 1.0 : -1.0;
        stage_check(rb_scene_add_cone(&builder, v[0], sign * size * ref_between(&random, 0.0, 0.5),
                                      v[1], i % 3 ? sign * size * 0.3 : 0.0, &stage_failure));
    }
    double z = center - 4.0;
    stage_check(rb_scene_add_plane(&builder, (const double[3][3]){{0, 0, z}, {1, 0, z}, {0, 1, z}},
                                   &stage_failure));
    stage_check(rb_scene_add_plane(
        &builder, (const double[3][3]){{z, 1, 0}, {0, z, 1}, {1, 2, z - 1}}, &stage_failure));
    stage_build(stage, &builder);
}

void stage_tiny(struct stage *stage, double center)
{
    struct ref_random random = {12};
    struct rb_scene_builder builder;
    begin_scene(&builder);
    for (int i = 0; i < 100; i++) {
        double d[3], p[3], c[3] = {center, center, center};
        ref_direction(&random, d);
        ref_along(c, pow(10.0, ref_between(&random, 1.0, 3.0)), d, p);
        stage_check(rb_scene_add_sphere(&builder, p, 1e-3, &stage_failure));
    }
    stage_build(stage, &builder);
}

static void origin_near(struct ref_random *random, double reach, struct aim *aim)
{
    double d[3], o[3] = {aim->target[0], aim->target[1], aim->target[2]};
    ref_direction(random, d);
    ref_along(o, reach * ref_between(random, 0.1, 1.0), d, aim->o);
}

static const struct rb_triangle *any_triangle(struct ref_random *random,
                                              const struct rb_scene *scene)
{
    return &scene->triangles[ref_below(random, scene->count[RB_TRIANGLE])];
}

static void blend(const struct rb_triangle *triangle, const double weight[3], double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = weight[0] * (double)triangle->v[0][k] + weight[1] * (double)triangle->v[1][k] +
               weight[2] * (double)triangle->v[2][k];
}

void aim_random(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    float low[3], high[3];
    rb_scene_bounds(scene, ref_below(random, scene->bounded_count), low, high);
    for (int k = 0; k < 3; k++)
        aim->target[k] = ref_between(random, (double)low[k], (double)high[k]);
    origin_near(random, 4.0, aim);
}

static void aim_edge(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    double s = ref_uniform(random), weight[3] = {s, 1.0 - s, 0.0};
    blend(any_triangle(random, scene), weight, aim->target);
    origin_near(random, 4.0, aim);
}

static void aim_midpoint(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    blend(any_triangle(random, scene), (const double[3]){0.0, 0.5, 0.5}, aim->target);
    origin_near(random, 4.0, aim);
}

static void aim_vertex(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    ref_widen(any_triangle(random, scene)->v[ref_below(random, 3)], aim->target);
    origin_near(random, 4.0, aim);
}

// From where a light would stand: sqrt(3) 100 away.
static void aim_far(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    (ref_below(random, 2) ? aim_vertex : aim_edge)(random, scene, aim);
    for (int k = 0; k < 3; k++)
        aim->o[k] = k == 2 ? 100.0 : -100.0;
}

// Nearly in the plane of a triangle: the sine of the angle is 1e-8 to 1e-2.
static void aim_grazing(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_triangle *triangle = any_triangle(random, scene);
    double a = ref_uniform(random), b = ref_uniform(random) * (1.0 - a), along[3], e[3], f[3], n[3];
    blend(triangle, (const double[3]){a, b, 1.0 - a - b}, aim->target);
    ref_edge(triangle->v[0], triangle->v[1], e);
    ref_edge(triangle->v[0], triangle->v[2], f);
    for (int k = 0; k < 3; k++)
        along[k] = ref_uniform(random) * e[k] - ref_uniform(random) * f[k];
    ref_cross(e, f, n);
    ref_normalize(n);
    ref_normalize(along);
    ref_along(along, pow(10.0, ref_between(random, -8.0, -2.0)), n, along);
    ref_along(aim->target, ref_between(random, 0.1, 4.0), along, aim->o);
}

// Past a sphere at 1 +- 1e-8 to 1e-2 of its radius.
static void aim_tangent(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_sphere *sphere = &scene->spheres[ref_below(random, scene->count[RB_SPHERE])];
    double c[3], out[3], other[3], across[3];
    double share = pow(10.0, ref_between(random, -8.0, -2.0)) * (ref_below(random, 2) ? 1.0 : -1.0);
    ref_widen(sphere->center, c);
    ref_direction(random, out);
    ref_direction(random, other);
    ref_cross(out, other, across);
    ref_normalize(across);
    ref_along(c, fabs((double)sphere->radius) * (1.0 + share), out, aim->target);
    ref_along(aim->target, ref_between(random, 0.1, 4.0), across, aim->o);
}

// From the middle of the scene at a disc a little larger than a sphere far away.
static void aim_tiny(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_sphere *sphere = &scene->spheres[ref_below(random, scene->count[RB_SPHERE])];
    double center = ref_reach(scene, 0) > 2000.0 ? 5000.0 : 0.0, offset[3];
    ref_widen(sphere->center, aim->target);
    random_point(random, 1.1 * (double)sphere->radius, offset);
    for (int k = 0; k < 3; k++) {
        aim->o[k] = center + ref_between(random, -1.0, 1.0);
        aim->target[k] += offset[k];
    }
}

// Past or at a cone: its rims, its tip, its silhouette, its axis.
static void aim_cone(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    const struct rb_cone *cone = &scene->cones[ref_below(random, scene->count[RB_CONE])];
    static const double heights[5] = {0.0, 1.0, 0.5, 0.99, 0.25};
    double axis[3], base[3], out[3], across[3];
    double z = heights[ref_below(random, 5)] * (double)cone->height;
    ref_widen(cone->axis, axis);
    ref_widen(cone->base, base);
    ref_direction(random, out);
    ref_cross(axis, out, across);
    ref_normalize(across);
    ref_along(base, z, axis, aim->target);
    double r = (double)cone->base_radius + (double)cone->slope * z;
    ref_along(aim->target, r * (double)ref_below(random, 2), across, aim->target);
    origin_near(random, 4.0, aim);
    if (ref_below(random, 2)) // in the tangent plane
        ref_along(aim->target, ref_between(random, 0.1, 4.0), out, aim->o);
    if (ref_below(random, 8) == 0) // along the axis
        ref_along(aim->target, ref_between(random, 0.1, 4.0), axis, aim->o);
}

// Starts inside a sphere or a cone.
static void aim_inside(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    double d[3];
    if (ref_below(random, 2)) {
        const struct rb_sphere *sphere =
            &scene->spheres[ref_below(random, scene->count[RB_SPHERE])];
        ref_widen(sphere->center, aim->o);
        ref_direction(random, d);
        ref_along(aim->o, 0.999999 * ref_uniform(random) * fabs((double)sphere->radius), d, aim->o);
    } else {
        const struct rb_cone *cone = &scene->cones[ref_below(random, scene->count[RB_CONE])];
        double axis[3];
        ref_widen(cone->base, aim->o);
        ref_widen(cone->axis, axis);
        ref_along(aim->o, ref_uniform(random) * (double)cone->height, axis, aim->o);
    }
    ref_direction(random, d);
    ref_along(aim->o, 1.0, d, aim->target);
}

// Parallel to one axis or to the plane of two, zeros of both signs, often through a vertex.
void aim_axis(struct ref_random *random, const struct rb_scene *scene, struct aim *aim)
{
    (ref_below(random, 2) ? aim_vertex : aim_random)(random, scene, aim);
    uint32_t axis = ref_below(random, 3), kept = ref_below(random, 3);
    for (uint32_t k = 0; k < 3; k++) {
        aim->target[k] = (double)(float)aim->target[k];
        if (k != axis && k != kept)
            aim->o[k] = aim->target[k];
    }
    if (aim->o[axis] == aim->target[axis])
        aim->o[axis] += 1.0;
}

void aim_push(struct rb_rays *rays, const struct aim *aim, struct ref_random *random)
{
    float o[3], d[3];
    double direction[3];
    for (int k = 0; k < 3; k++) {
        o[k] = (float)aim->o[k];
        direction[k] = aim->target[k] - (double)o[k];
    }
    ref_normalize(direction);
    for (int k = 0; k < 3; k++) {
        d[k] = (float)direction[k];
        if (direction[k] == 0.0 && ref_below(random, 2))
            d[k] = -0.0f;
    }
    stage_push(rays, rb_vec_of(o), rb_vec_of(d));
}

const struct ray_class ray_classes_soup[] = {
    {"random", aim_random, 3, false, false},
    {"one-sided", aim_random, 1, true, false},
    {"edges", aim_edge, 2, false, false},
    {"edge midpoints", aim_midpoint, 2, false, false},
    {"vertices", aim_vertex, 2, false, false},
    {"far light", aim_far, 2, false, false},
    {"grazing", aim_grazing, 2, false, false},
    {"tangent", aim_tangent, 2, false, false},
    {"cones", aim_cone, 2, false, false},
    {"inside", aim_inside, 2, false, false},
    {"axis-parallel", aim_axis, 2, false, false},
    {"secondary", aim_random, 3, false, true},
    {0},
};
const struct ray_class ray_classes_mesh[] = {
    {"random", aim_random, 1, false, false},   {"edges", aim_edge, 1, false, false},
    {"vertices", aim_vertex, 1, false, false}, {"far light", aim_far, 1, false, false},
    {"grazing", aim_grazing, 1, false, false}, {"axis-parallel", aim_axis, 1, false, false},
    {"secondary", aim_random, 1, false, true}, {0},
};
const struct ray_class ray_classes_spheres[] = {
    {"random", aim_random, 1, false, false},
    {"tangent", aim_tangent, 1, false, false},
    {"secondary", aim_random, 1, false, true},
    {0},
};
const struct ray_class ray_classes_shifted[] = {
    {"random", aim_random, 1, false, false},   {"edges", aim_edge, 1, false, false},
    {"vertices", aim_vertex, 1, false, false}, {"grazing", aim_grazing, 1, false, false},
    {"tangent", aim_tangent, 1, false, false}, {"cones", aim_cone, 1, false, false},
    {"inside", aim_inside, 1, false, false},   {"axis-parallel", aim_axis, 1, false, false},
    {"secondary", aim_random, 2, false, true}, {0},
};
const struct ray_class ray_classes_tiny[] = {
    {"tiny far spheres", aim_tiny, 2, false, false},
    {"from them", aim_tiny, 2, false, true},
    {0},
};
