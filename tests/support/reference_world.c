// All primitives of a scene: what a ray meets first, whether it meets anything, and how far it
// would have to be moved.
#include "tests/support/reference.h"

#include <math.h>
#include <stdlib.h>

enum { LEAF_MAX = 4, STACK = 128 };

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
    for (int k = 0; k < 3; k++) {
        if (kind == RB_SPHERE) {
            double r = fabs((double)scene->spheres[prim].radius);
            item->low[k] = (double)scene->spheres[prim].center[k] - r;
            item->high[k] = (double)scene->spheres[prim].center[k] + r;
        } else if (kind == RB_TRIANGLE) {
            const struct rb_triangle *t = &scene->triangles[prim - scene->first[RB_TRIANGLE]];
            item->low[k] = (double)fminf(t->v[0][k], fminf(t->v[1][k], t->v[2][k]));
            item->high[k] = (double)fmaxf(t->v[0][k], fmaxf(t->v[1][k], t->v[2][k]));
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
