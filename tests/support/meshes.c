// Bending grids, picking the triangles around an edge or a vertex, aiming at them.
#include "tests/support/meshes.h"

#include <math.h>
#include <string.h>

static struct mesh meshes[MESH_COUNT] = {
    {.name = "smooth", .stretch = 1.0, .roughness = 0.1},
    {.name = "rough", .stretch = 1.0, .roughness = 3.0},
    {.name = "ball", .stretch = 1.0, .roughness = 0.5, .ball = true},
    {.name = "slivers", .stretch = 100.0, .roughness = 0.5},
    {.name = "off-centre", .stretch = 1.0, .shift = 1000.0, .roughness = 1.0},
};

const char *const mesh_origins[ORIGIN_COUNT] = {"the eye", "a far light", "nearby"};

static void bend(struct mesh *mesh)
{
    struct ref_random random = {5};
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            double a = x * 2.0 / GRID - 1.0, b = y * 2.0 / GRID - 1.0;
            double rough = ref_between(&random, -1.0, 1.0) * mesh->roughness / GRID;
            double p[3] = {a, b, 0.4 * sin(3.0 * a) * cos(2.0 * b) + rough};
            if (mesh->ball) {
                double height = 2.9 * (y + 0.5) / SIDE + 0.1, angle = 6.0 * x / GRID;
                p[0] = (1.0 + rough) * sin(height) * cos(angle);
                p[1] = (1.0 + rough) * sin(height) * sin(angle);
                p[2] = (1.0 + rough) * cos(height);
            }
            p[1] *= mesh->stretch;
            for (int k = 0; k < 3; k++)
                mesh->v[y][x][k] = (float)(p[k] + mesh->shift);
        }
}

const struct mesh *mesh_make(int which)
{
    bend(&meshes[which]);
    return &meshes[which];
}

struct rb_triangle mesh_triangle(const struct mesh *mesh, int x, int y, int which)
{
    const int corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{1, 1}, {0, 1}, {0, 0}}};
    struct rb_triangle triangle;
    for (int i = 0; i < 3; i++) {
        const int *c = corner[which][i];
        memcpy(triangle.v[i], mesh->v[y + c[1]][x + c[0]], sizeof triangle.v[i]);
    }
    return triangle;
}

// The six triangles around an inner vertex.
static void pick_vertex(const struct mesh *mesh, struct ref_random *random, struct joint *joint)
{
    int x = 1 + (int)ref_below(random, GRID - 1), y = 1 + (int)ref_below(random, GRID - 1);
    const int around[6][3] = {{0, 0, 0},  {0, 0, 1},   {-1, 0, 0},
                              {0, -1, 1}, {-1, -1, 0}, {-1, -1, 1}};
    joint->count = 6;
    for (int i = 0; i < 6; i++)
        joint->triangles[i] = mesh_triangle(mesh, x + around[i][0], y + around[i][1], around[i][2]);
    ref_widen(mesh->v[y][x], joint->target);
}

// The two triangles at an edge: horizontal, vertical or diagonal.
static void pick_edge(const struct mesh *mesh, struct ref_random *random, struct joint *joint)
{
    int x = 1 + (int)ref_below(random, GRID - 1), y = 1 + (int)ref_below(random, GRID - 1);
    double s = ref_below(random, 4) ? ref_between(random, 0.02, 0.98) : 0.5;
    const float *to;
    joint->count = 2;
    switch (ref_below(random, 3)) {
    case 0:
        joint->triangles[0] = mesh_triangle(mesh, x, y, 0);
        joint->triangles[1] = mesh_triangle(mesh, x, y - 1, 1);
        to = mesh->v[y][x + 1];
        break;
    case 1:
        joint->triangles[0] = mesh_triangle(mesh, x, y, 1);
        joint->triangles[1] = mesh_triangle(mesh, x - 1, y, 0);
        to = mesh->v[y + 1][x];
        break;
    default:
        joint->triangles[0] = mesh_triangle(mesh, x, y, 0);
        joint->triangles[1] = mesh_triangle(mesh, x, y, 1);
        to = mesh->v[y + 1][x + 1];
    }
    for (int k = 0; k < 3; k++)
        joint->target[k] = (1.0 - s) * (double)mesh->v[y][x][k] + s * (double)to[k];
}

static void place_origin(const struct mesh *mesh, struct ref_random *random, enum origin origin,
                         const double target[3], double o[3])
{
    const double eye[3] = {-1.6, 1.6, 1.7}, light[3] = {-100.0, -100.0, 100.0};
    double d[3];
    ref_direction(random, d);
    for (int k = 0; k < 3; k++) {
        double place[ORIGIN_COUNT] = {mesh->shift + eye[k] + 0.1 * d[k],
                                      mesh->shift + light[k] + d[k], 0.0};
        o[k] = place[origin];
    }
    if (origin == NEAR)
        ref_along(target, pow(10.0, ref_between(random, -2.0, 0.3)), d, o);
}

// Do all triangles show the same side, at more than 1e-3 of a right angle?
static bool one_side(const struct joint *joint, const struct ref_ray *ray)
{
    int front = 0, back = 0;
    for (int i = 0; i < joint->count; i++) {
        double e[2][3], n[3];
        ref_edge(joint->triangles[i].v[0], joint->triangles[i].v[1], e[0]);
        ref_edge(joint->triangles[i].v[0], joint->triangles[i].v[2], e[1]);
        ref_cross(e[0], e[1], n);
        ref_normalize(n);
        double facing = ref_dot(n, ray->d);
        front += facing<-1e-3, back += facing> 1e-3;
    }
    return front == joint->count || back == joint->count;
}

struct rb_ray mesh_aim(const struct mesh *mesh, struct ref_random *random, enum origin origin,
                       bool vertices, struct joint *joint)
{
    for (;;) {
        struct ref_ray exact;
        float o[3], d[3];
        (vertices ? pick_vertex : pick_edge)(mesh, random, joint);
        place_origin(mesh, random, origin, joint->target, exact.o);
        for (int k = 0; k < 3; k++) {
            o[k] = (float)exact.o[k];
            exact.d[k] = joint->target[k] - (double)o[k];
        }
        ref_normalize(exact.d);
        for (int k = 0; k < 3; k++)
            d[k] = (float)exact.d[k];
        if (one_side(joint, &exact))
            return rb_ray_make(rb_vec_of(o), rb_vec_of(d), RB_NONE, RB_SIDES_VISIBLE);
    }
}
