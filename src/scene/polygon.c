// Triangulation by ear clipping (Meisters 1975): as long as there are more than three vertices, cut
// off a convex one whose triangle holds no other vertex.
//
// Only reflex vertices can lie in such a triangle (Held 2001, "FIST: Fast Industrial-Strength
// Triangulation of Polygons"). They are kept in a tree of boxes, so that a test looks at those near
// the triangle. Two plainer ways are quadratic for shapes that exist: sorting them along one axis
// for wheels, where much of the rim shares one coordinate; a uniform grid for racks, whose last
// triangles are as long as the rack and thinner than a cell.
//
// The polygon is projected along the dominant axis of its normal by leaving that coordinate out, so
// no rounding happens before the orientation tests, which are plain double precision: vertices that
// are collinear up to rounding may give a sliver on the wrong side, far below single precision.
#include "scene/polygon.h"

#include "scene/polygon_tree.h"

#include <math.h>
#include <stdbool.h>

// How strictly a candidate is tested. A simple polygon always has a STRICT ear; the others are for
// outlines that touch or cross themselves.
enum rigour { STRICT, LENIENT, CONVEX, ANY };

// After STRICT has found nothing, one pass cuts off at most this part of the vertices left before
// STRICT is tried again: one at a time in small polygons, and still few passes in large ones.
#define FORCED_PART 64

// Candidates for ears, first in first out. Each vertex is in it at most once.
struct queue {
    uint32_t *ring;
    uint32_t size, head, count;
};

struct clipper {
    struct rb_polygon *polygon;
    struct rb_ring_vertex *vertices;
    struct rb_polygon_tree tree;
    struct queue queue;
    uint32_t left;         // vertices not yet cut off
    uint32_t reflex_count; // of them, in the tree
    enum rigour rigour;
    uint32_t round;
};

// The axis to leave out, and whether the other two swap for the front to be counter-clockwise.
// False if the polygon has no area. Newell's normal: the sum over all edges, relative to vertex 0.
static bool choose_axes(const double (*v)[3], uint32_t count, int *x_axis, int *y_axis)
{
    double normal[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 1; i + 1 < count; i++) {
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = v[i][k] - v[0][k];
            b[k] = v[i + 1][k] - v[0][k];
        }
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            normal[k] += a[l] * b[m] - a[m] * b[l];
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    }
    bool front = normal[axis] > 0.0;
    *x_axis = (axis + (front ? 1 : 2)) % 3;
    *y_axis = (axis + (front ? 2 : 1)) % 3;
    return normal[axis] != 0.0;
}

// Every turn is to the left, and the outline goes around once: x changes its direction twice.
static bool is_convex(const struct rb_ring_vertex *v, uint32_t count)
{
    uint32_t changes = 0;
    double last = v[0].x - v[count - 1].x;
    for (uint32_t i = 0; i < count; i++) {
        const struct rb_ring_vertex *next = &v[v[i].next];
        double step = next->x - v[i].x;
        if (v[i].reflex && rb_ring_area(&v[v[i].prev], &v[i], next) < 0.0)
            return false;
        if (step == 0.0)
            continue;
        changes += step * last < 0.0;
        last = step;
    }
    return changes <= 2;
}

static bool emit(struct rb_polygon *polygon, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t triangle[3] = {a, b, c};
    return rb_array_push(&polygon->triangles, triangle, sizeof triangle);
}

// A convex polygon: cuts off every second vertex, then every second of the rest, and so on. A fan
// would give a large polygon slivers that all reach across it.
static bool halve_convex(struct rb_polygon *polygon, uint32_t count)
{
    for (uint64_t step = 1; step < count; step *= 2) {
        for (uint64_t i = 0; i + step < count; i += 2 * step) {
            uint64_t end = i + 2 * step < count ? i + 2 * step : 0;
            if (end != i && !emit(polygon, (uint32_t)i, (uint32_t)(i + step), (uint32_t)end))
                return false;
        }
    }
    return true;
}

static void enqueue(struct clipper *c, uint32_t v)
{
    struct queue *queue = &c->queue;
    if (c->vertices[v].queued)
        return;
    c->vertices[v].queued = true;
    uint32_t room = queue->size - queue->head;
    queue->ring[queue->count < room ? queue->head + queue->count : queue->count - room] = v;
    queue->count++;
}

static uint32_t dequeue(struct clipper *c)
{
    struct queue *queue = &c->queue;
    uint32_t v = queue->ring[queue->head];
    queue->head = queue->head + 1 == queue->size ? 0 : queue->head + 1;
    queue->count--;
    c->vertices[v].queued = false;
    return v;
}

// Fills the ring. A vertex is reflex if it does not turn strictly left: a straight one may be in
// the way of an ear just as well.
static bool make_ring(struct clipper *c, const double (*v)[3], uint32_t count, int x_axis,
                      int y_axis)
{
    struct rb_array *vertices = &c->polygon->vertices;
    if (!rb_array_reserve(vertices, count, sizeof *c->vertices))
        return false;
    c->vertices = vertices->data;
    for (uint32_t i = 0; i < count; i++)
        c->vertices[i] = (struct rb_ring_vertex){.x = v[i][x_axis],
                                                 .y = v[i][y_axis],
                                                 .prev = i ? i - 1 : count - 1,
                                                 .next = i + 1 < count ? i + 1 : 0};
    for (uint32_t i = 0; i < count; i++) {
        struct rb_ring_vertex *b = &c->vertices[i];
        b->reflex = !(rb_ring_area(&c->vertices[b->prev], b, &c->vertices[b->next]) > 0.0);
        c->reflex_count += b->reflex;
    }
    c->left = count;
    return true;
}

// Whether `v` may be cut off under the present rigour.
static bool is_ear(struct clipper *c, uint32_t v)
{
    const struct rb_ring_vertex *b = &c->vertices[v];
    const struct rb_ring_vertex *t[3] = {&c->vertices[b->prev], b, &c->vertices[b->next]};
    bool spike = t[0]->x == t[2]->x && t[0]->y == t[2]->y;
    bool doubled = (b->x == t[0]->x && b->y == t[0]->y) || (b->x == t[2]->x && b->y == t[2]->y);
    c->tree.steps++;
    if (c->rigour == ANY || spike || doubled)
        return true; // the last two leave the outline as it is
    if (!(rb_ring_area(t[0], t[1], t[2]) > 0.0))
        return false;
    return c->rigour == CONVEX || c->reflex_count == 0 ||
           !rb_polygon_tree_blocks(&c->tree, t,
                                   c->rigour == STRICT ? RB_RING_STRICT : RB_RING_LENIENT);
}

static void not_reflex(struct clipper *c, struct rb_ring_vertex *v)
{
    v->reflex = false;
    c->reflex_count--;
    rb_polygon_tree_remove(&c->tree, v->slot);
}

// The vertex lost a neighbour: it may be convex now, and is worth another look.
static void update(struct clipper *c, uint32_t v)
{
    struct rb_ring_vertex *b = &c->vertices[v];
    if (b->reflex && rb_ring_area(&c->vertices[b->prev], b, &c->vertices[b->next]) > 0.0)
        not_reflex(c, b);
    b->round = c->round;
    enqueue(c, v);
}

// Cuts `v` off. False without memory.
static bool clip(struct clipper *c, uint32_t v)
{
    struct rb_ring_vertex *b = &c->vertices[v];
    struct rb_ring_vertex *before = &c->vertices[b->prev], *behind = &c->vertices[b->next];
    bool fits = !(rb_ring_area(before, b, behind) > 0.0) || emit(c->polygon, b->prev, v, b->next);
    b->gone = true;
    if (b->reflex)
        not_reflex(c, b);
    before->next = b->next;
    behind->prev = b->prev;
    c->left--;
    update(c, b->prev);
    update(c, b->next);
    return fits;
}

// One pass over what is queued now, until at most `most` are cut off; their number goes to `cut`. A
// vertex whose neighbour went in the same pass waits for the next: cutting off every second one
// gives rounder triangles than cutting one after the other.
static bool pass(struct clipper *c, uint32_t most, uint32_t *cut)
{
    uint32_t waiting = c->queue.count;
    c->round++;
    *cut = 0;
    for (uint32_t i = 0; i < waiting && c->left > 3 && *cut < most; i++) {
        uint32_t v = dequeue(c);
        if (c->vertices[v].gone)
            continue;
        if (c->vertices[v].round == c->round) {
            enqueue(c, v);
        } else if (is_ear(c, v)) {
            (*cut)++;
            if (!clip(c, v))
                return false;
        }
    }
    return true;
}

static void enqueue_all(struct clipper *c, uint32_t count)
{
    c->tree.steps += count;
    for (uint32_t i = 0; i < count; i++) {
        if (!c->vertices[i].gone)
            enqueue(c, i);
    }
}

// Cuts off ears until a triangle is left. STRICT passes go on while there are candidates; when a
// look at all vertices finds nothing, the next laxer test may force some cuts.
static enum rb_status clip_ears(struct clipper *c, uint32_t count, struct rb_error *error)
{
    bool progress = true;
    while (c->left > 3) {
        if (c->queue.count == 0 || c->rigour != STRICT) {
            c->rigour = progress ? STRICT : c->rigour + 1;
            progress = false;
            enqueue_all(c, count);
        }
        uint32_t cut, most = c->rigour == STRICT ? UINT32_MAX : 1 + c->left / FORCED_PART;
        if (!pass(c, most, &cut))
            return rb_error_memory(error, "the triangles of a polygon");
        progress |= cut > 0;
        if (c->polygon->steps + c->tree.steps > RB_POLYGON_STEPS_MAX)
            return rb_error_set(error, RB_INVALID,
                                "the outline of the polygon is too tangled to cut into triangles; "
                                "split it, or check whether it crosses itself");
    }
    uint32_t v = 0;
    while (c->vertices[v].gone)
        v++;
    const struct rb_ring_vertex *b = &c->vertices[v];
    if (rb_ring_area(&c->vertices[b->prev], b, &c->vertices[b->next]) > 0.0 &&
        !emit(c->polygon, b->prev, v, b->next))
        return rb_error_memory(error, "the triangles of a polygon");
    return RB_OK;
}

static enum rb_status cut_concave(struct clipper *c, uint32_t count, struct rb_error *error)
{
    struct rb_polygon *polygon = c->polygon;
    // An outline that winds around several times may have no reflex vertex at all.
    if (!rb_array_reserve(&polygon->queue, count, sizeof *c->queue.ring) ||
        (c->reflex_count > 0 &&
         !rb_polygon_tree_build(&c->tree, c->vertices, count, c->reflex_count, &polygon->slots,
                                &polygon->nodes)))
        return rb_error_memory(error, "a polygon");
    c->queue = (struct queue){.ring = polygon->queue.data, .size = count};
    enum rb_status status = clip_ears(c, count, error);
    polygon->steps += c->tree.steps;
    return status;
}

enum rb_status rb_polygon_triangulate(struct rb_polygon *polygon, const double (*vertex)[3],
                                      uint32_t count, struct rb_error *error)
{
    struct clipper clipper = {.polygon = polygon};
    int x_axis, y_axis;
    polygon->triangles.count = 0;
    if (count < 3 || !choose_axes(vertex, count, &x_axis, &y_axis))
        return RB_OK;
    if (!rb_array_reserve(&polygon->triangles, count - 2, sizeof(uint32_t[3])) ||
        !make_ring(&clipper, vertex, count, x_axis, y_axis))
        return rb_error_memory(error, "a polygon");
    if (!is_convex(clipper.vertices, count))
        return cut_concave(&clipper, count, error);
    return halve_convex(polygon, count) ? RB_OK : rb_error_memory(error, "a polygon");
}

void rb_polygon_release(struct rb_polygon *polygon)
{
    struct rb_array *arrays[] = {&polygon->triangles, &polygon->vertices, &polygon->queue,
                                 &polygon->slots, &polygon->nodes};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rb_array_release(arrays[i]);
    polygon->steps = 0;
}
