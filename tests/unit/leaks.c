// No leaks: no ray slips between two triangles that share an edge or a vertex.
//
// Rays aim at the edges and vertices of meshes. The triangle test is repeated here with the edge
// tolerance as a parameter; for every ray the smallest tolerance is found at which the ray is
// caught, and from all of them the leak rate at any fraction of RB_EDGE_TOLERANCE. At the tolerance
// itself the test is compared with the kernels'. An argument sets the rays per row: 3400000 makes
// 10^8 in all, of which the worst needs 5.1 * 2^-24.
#include "tests/support/meshes.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>

enum { RAYS = 100000 };

// The kernels' triangle test up to the decision, and what it decides by.
struct edges {
    float us, vs, area, reach, longest;
};

static struct edges edges_of(const struct rb_triangle *triangle, const struct rb_ray *ray)
{
    struct rb_vec v0 = rb_vec_of(triangle->v[0]);
    struct rb_vec e1 = rb_vec_sub(rb_vec_of(triangle->v[1]), v0);
    struct rb_vec e2 = rb_vec_sub(rb_vec_of(triangle->v[2]), v0);
    struct rb_vec s = rb_vec_sub(ray->o, v0);
    struct rb_vec p = rb_cross(ray->d, e2), q = rb_cross(s, e1);
    float det = rb_dot(e1, p), sign = copysignf(1.0f, det);
    return (struct edges){rb_dot(s, p) * sign, rb_dot(ray->d, q) * sign, det * sign,
                          rb_vec_reach(s), rb_max(rb_vec_reach(e1), rb_vec_reach(e2))};
}

static bool accepts(const struct edges *e, float tolerance)
{
    float slack = tolerance * e->reach * e->longest;
    return e->us >= -slack && e->vs >= -slack && e->us + e->vs <= e->area + slack &&
           e->area >= FLT_MIN;
}

static bool passes_box(const struct rb_triangle *triangle, const struct rb_ray *ray)
{
    float low[3], high[3];
    rb_triangle_bounds(triangle, low, high);
    struct rb_interval range = rb_box(low, high, ray);
    return range.near <= range.far;
}

// The tolerance a ray needs to hit this triangle, in units of 2^-24.
static double need(const struct edges *e)
{
    double outside = fmax(fmax(-(double)e->us, -(double)e->vs), (double)(e->us + e->vs - e->area));
    return fmax(outside, 0.0) / ((double)e->reach * (double)e->longest) * 0x1p24;
}

enum { FRACTIONS = 6 };
static const float fractions[FRACTIONS] = {0.0f, 0.0625f, 0.125f, 0.25f, 0.5f, 1.0f};

struct leaks {
    uint64_t rays, at[FRACTIONS], boxes, unequal;
    double most; // tolerance that catches all
};

static void probe(const struct joint *joint, const struct rb_ray *ray, struct leaks *leaks)
{
    bool hit[FRACTIONS] = {false}, box = false;
    double least = HUGE_VAL;
    for (int i = 0; i < joint->count; i++) {
        const struct rb_triangle *triangle = &joint->triangles[i];
        struct edges e = edges_of(triangle, ray);
        struct rb_hit unused;
        leaks->unequal += accepts(&e, RB_EDGE_TOLERANCE) !=
                          rb_triangle_test(triangle, ray, RB_SIDES_VISIBLE, &unused);
        if (!passes_box(triangle, ray))
            continue;
        box = true;
        least = fmin(least, need(&e));
        for (int f = 0; f < FRACTIONS; f++)
            hit[f] = hit[f] || accepts(&e, fractions[f] * RB_EDGE_TOLERANCE);
    }
    leaks->rays++;
    leaks->boxes += !box;
    leaks->most = fmax(leaks->most, least);
    for (int f = 0; f < FRACTIONS; f++)
        leaks->at[f] += !hit[f];
}

static double per_million(uint64_t count, uint64_t of)
{
    return 1e6 * (double)count / (double)of;
}

static void measure(const struct mesh *mesh, enum origin origin, bool vertices, uint32_t rays)
{
    struct ref_random random = {77};
    struct leaks leaks = {0};
    for (uint32_t i = 0; i < rays; i++) {
        struct joint joint;
        struct rb_ray ray = mesh_aim(mesh, &random, origin, vertices, &joint);
        probe(&joint, &ray, &leaks);
    }
    uint64_t n = leaks.rays;
    note("%-9s %-8s from %-11s %9.1f %9.1f %9.1f %7.1f %7.1f %7.1f   %6.3f", mesh->name,
         vertices ? "vertices" : "edges", mesh_origins[origin], per_million(leaks.at[0], n),
         per_million(leaks.at[1], n), per_million(leaks.at[2], n), per_million(leaks.at[3], n),
         per_million(leaks.at[4], n), per_million(leaks.at[5], n), leaks.most);
    ok(leaks.at[FRACTIONS - 1] == 0 && leaks.boxes == 0, "%s, %s, from %s: no ray leaks",
       mesh->name, vertices ? "vertices" : "edges", mesh_origins[origin]);
    ok(leaks.unequal == 0, "... and the test here is the kernels'");
}

int main(int argc, char **argv)
{
    uint32_t rays = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : RAYS;
    note("Leaks per million rays at fractions of the edge tolerance, %g * 2^-24; the least "
         "tolerance without any",
         (double)RB_EDGE_TOLERANCE * 0x1p24);
    note("%-37s %9s %9s %9s %7s %7s %7s   %6s", "", "0", "1/16", "1/8", "1/4", "1/2", "1", "2^-24");
    for (int m = 0; m < MESH_COUNT; m++) {
        const struct mesh *mesh = mesh_make(m);
        for (int origin = 0; origin < ORIGIN_COUNT; origin++)
            for (int vertices = 0; vertices < 2; vertices++)
                measure(mesh, (enum origin)origin, vertices, rays);
    }
    return done();
}
