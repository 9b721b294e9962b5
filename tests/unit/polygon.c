// Triangulation: the triangles cover the polygon once, keep its orientation and only use its
// vertices; large and tangled outlines end in bounded time.
#include "scene/polygon.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double pi = 3.141592653589793;

struct outline {
    double (*v)[3];
    uint32_t count;
};

static struct outline outline_new(uint32_t count)
{
    return (struct outline){calloc(count, sizeof(double[3])), count};
}

// Twice the signed area in the x-y plane of the triangle or of a whole outline.
static double area2(const double (*v)[3], const uint32_t *index, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const double *a = v[index ? index[i] : i];
        const double *b = v[index ? index[(i + 1) % count] : (i + 1) % count];
        sum += a[0] * b[1] - b[0] * a[1];
    }
    return sum;
}

static double seconds(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Triangulates; checks that no triangle is turned and that the areas add up. Frees the outline.
static void check_cover(struct outline outline, const char *what)
{
    struct rb_polygon polygon = {0};
    struct rb_error error = {0};
    const double(*v)[3] = (const double(*)[3])outline.v;
    double start = seconds(), sum = 0.0, whole = area2(v, NULL, outline.count);
    enum rb_status status = rb_polygon_triangulate(&polygon, v, outline.count, &error);
    double taken = seconds() - start;
    size_t turned = 0;
    const uint32_t(*triangles)[3] = polygon.triangles.data;
    for (size_t i = 0; i < polygon.triangles.count; i++) {
        double part = area2(v, triangles[i], 3);
        turned += part * whole < 0.0;
        sum += part;
    }
    ok(status == RB_OK && turned == 0 && fabs(sum - whole) <= 1e-9 * fabs(whole) &&
           polygon.triangles.count <= outline.count - 2 && taken < 20.0,
       "%s: %u vertices, %zu triangles, area %.9g of %.9g, %zu turned, %.2f s %s", what,
       outline.count, polygon.triangles.count, sum / 2.0, whole / 2.0, turned, taken, error.text);
    rb_polygon_release(&polygon);
    free(outline.v);
}

static struct outline polar(uint32_t count, double (*radius)(uint32_t), double turns)
{
    struct outline out = outline_new(count);
    for (uint32_t i = 0; i < count; i++) {
        double angle = turns * 2.0 * pi * (double)i / (double)count;
        out.v[i][0] = radius(i) * cos(angle);
        out.v[i][1] = radius(i) * sin(angle);
    }
    return out;
}

static double gear_radius(uint32_t i)
{
    return i % 4 < 2 ? 1.0 : 0.9;
}

static double star_radius(uint32_t i)
{
    uint64_t x = (i + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 31) * 0xbf58476d1ce4e5b9u;
    return 0.1 + 0.9 * (double)(x >> 40) * 0x1p-24;
}

static double circle_radius(uint32_t i)
{
    (void)i;
    return 1.0;
}

// Teeth on a bar: once they are cut off, all that is left is collinear.
static struct outline rack(uint32_t teeth)
{
    struct outline out = outline_new(2 * teeth + 3);
    uint32_t n = 0;
    out.v[n++][0] = 0.0;
    out.v[n++][0] = 2.0 * teeth;
    for (uint32_t i = teeth; i-- > 0;) {
        out.v[n][0] = 2.0 * i + 2.0;
        out.v[n++][1] = 1.0;
        out.v[n][0] = 2.0 * i + 1.0;
        out.v[n++][1] = 9.0;
    }
    out.v[n][1] = 1.0;
    return out;
}

static struct outline spiral(uint32_t count)
{
    struct outline out = outline_new(count);
    for (uint32_t i = 0; i < count; i++) {
        bool outer = i < count / 2;
        double along = (double)(outer ? i : count - 1 - i) / (count / 2) * 40.0 * pi;
        double radius = 1.0 + 0.1 * along + (outer ? 0.3 : 0.0);
        out.v[i][0] = radius * cos(along);
        out.v[i][1] = radius * sin(along);
    }
    return out;
}

static struct outline from_list(const double *xy, uint32_t count)
{
    struct outline out = outline_new(count);
    for (uint32_t i = 0; i < count; i++) {
        out.v[i][0] = xy[2 * i];
        out.v[i][1] = xy[2 * i + 1];
    }
    return out;
}

static void reverse(struct outline *outline)
{
    for (uint32_t i = 0, k = outline->count - 1; i < k; i++, k--) {
        double v[3];
        memcpy(v, outline->v[i], sizeof v);
        memcpy(outline->v[i], outline->v[k], sizeof v);
        memcpy(outline->v[k], v, sizeof v);
    }
}

static void test_shapes(void)
{
    static const double arrow[] = {0, 0, 4, 0, 4, 4, 3, 1};
    static const double flat_edges[] = {0, 0, 1, 0, 2, 0, 2, 1, 2, 2, 1, 2, 0, 2, 0, 1};
    static const double one_side[] = {0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 2, 5};
    // A square with a square hole, joined by a doubled edge.
    static const double hole[] = {0, 0, 9, 0, 9, 9, 0, 9, 0, 0, 3, 3, 3, 6, 6, 6, 6, 3, 3, 3};
    static const double spike[] = {0, 0, 2, 0, 2, 1, 5, 1, 2, 1, 2, 2, 0, 2};
    static const double touching[] = {0, 0, 4, 0, 4, 4, 2, 0, 0, 4};
    static const double doubled[] = {0, 0, 0, 0, 4, 0, 4, 4, 4, 4, 1, 3, 1, 3, 0, 4};
    check_cover(from_list(arrow, 4), "arrow head");
    struct outline turned = from_list(arrow, 4);
    reverse(&turned);
    check_cover(turned, "arrow head seen from behind");
    check_cover(from_list(flat_edges, 8), "square with vertices on its edges");
    check_cover(from_list(one_side, 6), "triangle with vertices on one edge");
    check_cover(from_list(hole, 10), "hole joined by a doubled edge");
    check_cover(from_list(spike, 7), "whisker");
    check_cover(from_list(touching, 5), "outline touching itself");
    check_cover(from_list(doubled, 8), "doubled vertices");
    for (uint32_t n = 3; n < 12; n++)
        check_cover(polar(n, circle_radius, 1.0), "regular polygon");
    check_cover(polar(144, gear_radius, 1.0), "gear of the database");
}

static void test_large(void)
{
    check_cover(polar(1000000, gear_radius, 1.0), "gear");
    check_cover(polar(1000000, circle_radius, 1.0), "circle");
    check_cover(rack(500000), "rack");
    check_cover(spiral(300000), "spiral");
    check_cover(polar(100000, star_radius, 1.0), "random star");
}

// Every axis may be left out in the projection, seen from either side.
static void test_projections(void)
{
    for (int axis = 0; axis < 3; axis++) {
        for (int side = 0; side < 2; side++) {
            struct outline gear = polar(144, gear_radius, 1.0);
            if (side)
                reverse(&gear);
            for (uint32_t i = 0; i < gear.count; i++) {
                double v[3] = {gear.v[i][0], gear.v[i][1], 0.3 * gear.v[i][0]};
                for (int k = 0; k < 3; k++)
                    gear.v[i][(k + axis) % 3] = v[k];
            }
            struct rb_polygon polygon = {0};
            rb_polygon_triangulate(&polygon, (const double(*)[3])gear.v, gear.count, NULL);
            const uint32_t(*triangles)[3] = polygon.triangles.data;
            int turned = 0;
            for (size_t i = 0; i < polygon.triangles.count; i++) {
                const double *a = gear.v[triangles[i][0]], *b = gear.v[triangles[i][1]],
                             *c = gear.v[triangles[i][2]];
                int x = axis, y = (axis + 1) % 3;
                double area = (b[x] - a[x]) * (c[y] - a[y]) - (b[y] - a[y]) * (c[x] - a[x]);
                turned += side ? area >= 0.0 : area <= 0.0;
            }
            ok(polygon.triangles.count == 142 && turned == 0,
               "gear across axis %d, side %d: all triangles face the same way", (axis + 2) % 3,
               side);
            rb_polygon_release(&polygon);
            free(gear.v);
        }
    }
}

// Outlines that cross themselves only have to end.
static void test_tangles(void)
{
    struct rb_polygon polygon = {0};
    for (uint32_t n = 4; n < 200; n++) {
        struct outline tangle = outline_new(n);
        for (uint32_t i = 0; i < n; i++) {
            tangle.v[i][0] = floor(8.0 * star_radius(7 * n + i)); // many coincide
            tangle.v[i][1] = floor(8.0 * star_radius(1000 * n + i));
        }
        if (rb_polygon_triangulate(&polygon, (const double(*)[3])tangle.v, n, NULL) != RB_OK ||
            polygon.triangles.count > n - 2)
            ok(false, "tangle of %u vertices", n);
        free(tangle.v);
    }
    ok(true, "196 tangles end");
    static const double bow[] = {0, 0, 1, 1, 1, 0, 0, 1};
    struct outline tie = from_list(bow, 4);
    ok(rb_polygon_triangulate(&polygon, (const double(*)[3])tie.v, 4, NULL) == RB_OK &&
           polygon.triangles.count == 0,
       "a bow tie has no area and no triangles");
    free(tie.v);
    struct outline wound = polar(10001, circle_radius, 3.0);
    ok(rb_polygon_triangulate(&polygon, (const double(*)[3])wound.v, wound.count, NULL) == RB_OK,
       "an outline wound three times ends");
    free(wound.v);
    rb_polygon_release(&polygon);
}

// With the budget all but spent, the next tangle is refused, and a clear text says why.
static void test_budget(void)
{
    struct rb_polygon polygon = {.steps = RB_POLYGON_STEPS_MAX - 10};
    struct rb_error error = {0};
    struct outline gear = polar(1000, gear_radius, 1.0);
    ok(rb_polygon_triangulate(&polygon, (const double(*)[3])gear.v, gear.count, &error) ==
               RB_INVALID &&
           strstr(error.text, "too tangled"),
       "over budget: %s", error.text);
    free(gear.v);
    rb_polygon_release(&polygon);
}

static void test_memory(void)
{
    struct outline gear = polar(144, gear_radius, 1.0);
    long live = rb_memory_live_count();
    int failures = 0;
    for (long n = 1; n < 100; n++) {
        struct rb_polygon polygon = {0};
        rb_memory_fail_at(n);
        enum rb_status status =
            rb_polygon_triangulate(&polygon, (const double(*)[3])gear.v, gear.count, NULL);
        rb_memory_fail_at(0);
        rb_polygon_release(&polygon);
        failures += status == RB_FAILED;
        if (status == RB_OK)
            break;
    }
    ok(failures == 5 && rb_memory_live_count() == live, "each of %d allocations may fail",
       failures);
    free(gear.v);
}

int main(void)
{
    test_shapes();
    test_projections();
    test_tangles();
    test_budget();
    test_memory();
    test_large();
    return done();
}
