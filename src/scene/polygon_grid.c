#include "scene/polygon_grid.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static bool same(const struct rb_ring_vertex *a, const struct rb_ring_vertex *b)
{
    return a->x == b->x && a->y == b->y;
}

// Monotone in x, and total: what is not a number goes to cell 0.
static int cell_along(const struct rb_polygon_grid *grid, int axis, double x)
{
    double cell = (x - grid->low[axis]) * grid->scale[axis];
    double last = (double)(grid->size[axis] - 1);
    return cell > 0.0 ? (int)(cell < last ? cell : last) : 0;
}

static struct rb_grid_cell *cell_at(const struct rb_polygon_grid *grid, int row, int column)
{
    return &grid->cells[(ptrdiff_t)row * grid->size[0] + column];
}

static struct rb_grid_cell *cell_of(const struct rb_polygon_grid *grid,
                                    const struct rb_ring_vertex *v)
{
    return cell_at(grid, cell_along(grid, 1, v->y), cell_along(grid, 0, v->x));
}

// About one reflex vertex per cell, cells about square. The slack covers the rounding of where rows
// begin and where edges cross them.
static void measure(struct rb_polygon_grid *grid, uint32_t count, uint32_t reflex_count)
{
    double high[2] = {-HUGE_VAL, -HUGE_VAL};
    grid->low[0] = grid->low[1] = HUGE_VAL;
    for (uint32_t i = 0; i < count; i++) {
        double at[2] = {grid->vertices[i].x, grid->vertices[i].y};
        for (int k = 0; k < 2; k++) {
            grid->low[k] = fmin(grid->low[k], at[k]);
            high[k] = fmax(high[k], at[k]);
        }
    }
    double extent[2] = {high[0] - grid->low[0], high[1] - grid->low[1]};
    double cells = (double)reflex_count;
    double wide = fmin(fmax(floor(sqrt(cells * extent[0] / extent[1])), 1.0), cells);
    grid->size[0] = (int)wide;
    grid->size[1] = (int)fmax(floor(cells / wide), 1.0);
    for (int k = 0; k < 2; k++) {
        grid->scale[k] = (double)grid->size[k] / extent[k];
        grid->slack[k] = 1e-12 * extent[k] + 0x1p-50 * fmax(fabs(grid->low[k]), fabs(high[k]));
    }
}

bool rb_polygon_grid_fill(struct rb_polygon_grid *grid, const struct rb_ring_vertex *vertices,
                          uint32_t count, uint32_t reflex_count, struct rb_array *cells,
                          struct rb_array *blockers)
{
    grid->vertices = vertices;
    measure(grid, count, reflex_count);
    size_t cell_count = (size_t)grid->size[0] * (size_t)grid->size[1];
    if (!rb_array_reserve(cells, cell_count, sizeof *grid->cells) ||
        !rb_array_reserve(blockers, reflex_count, sizeof *grid->blockers))
        return false;
    grid->cells = cells->data;
    grid->blockers = blockers->data;

    // A counting sort: sizes, then where each cell begins, then the vertices.
    memset(grid->cells, 0, cell_count * sizeof *grid->cells);
    for (uint32_t i = 0; i < count; i++) {
        if (vertices[i].reflex)
            cell_of(grid, &vertices[i])->first++;
    }
    uint32_t end = 0;
    for (size_t i = 0; i < cell_count; i++) {
        uint32_t size = grid->cells[i].first;
        grid->cells[i].first = end;
        end += size;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (vertices[i].reflex) {
            struct rb_grid_cell *cell = cell_of(grid, &vertices[i]);
            grid->blockers[cell->first + cell->count++] = i;
        }
    }
    return true;
}

// A vertex in the same place as a corner does not block: it belongs to an outline that touches
// itself there, or to a hole that a doubled edge joins to it.
static bool vertex_blocks(const struct rb_ring_vertex *p, const struct rb_ring_vertex *const t[3],
                          enum rb_ring_rule rule)
{
    if (p == t[0] || p == t[1] || p == t[2])
        return false;
    double ab = rb_ring_area(t[0], t[1], p);
    double bc = rb_ring_area(t[1], t[2], p);
    double ca = rb_ring_area(t[2], t[0], p);
    if (rule != RB_RING_STRICT)
        return ab > 0.0 && bc > 0.0 && ca > 0.0;
    return ab >= 0.0 && bc >= 0.0 && ca >= 0.0 && !same(p, t[0]) && !same(p, t[1]) &&
           !same(p, t[2]);
}

static bool cell_blocks(struct rb_polygon_grid *grid, struct rb_grid_cell *cell,
                        const struct rb_ring_vertex *const t[3], enum rb_ring_rule rule)
{
    uint32_t *blockers = grid->blockers + cell->first;
    grid->steps += 1 + cell->count;
    for (uint32_t i = 0; i < cell->count;) {
        const struct rb_ring_vertex *p = &grid->vertices[blockers[i]];
        if (!p->reflex)
            blockers[i] = blockers[--cell->count];
        else if (vertex_blocks(p, t, rule))
            return true;
        else
            i++;
    }
    return false;
}

// The range of x the triangle covers between y = low and y = high; empty (inf, -inf) if none.
static void x_range(const struct rb_ring_vertex *const t[3], double low, double high,
                    double range[2])
{
    range[0] = HUGE_VAL;
    range[1] = -HUGE_VAL;
    for (int i = 0; i < 3; i++) {
        const struct rb_ring_vertex *a = t[i], *b = t[(i + 1) % 3];
        if (a->y > b->y) {
            a = b;
            b = t[i];
        }
        if (b->y < low || a->y > high)
            continue;
        double slope = b->y > a->y ? (b->x - a->x) / (b->y - a->y) : 0.0;
        double start = a->y < low ? a->x + (low - a->y) * slope : a->x;
        double stop = b->y > high ? a->x + (high - a->y) * slope : b->x;
        range[0] = fmin(range[0], fmin(start, stop));
        range[1] = fmax(range[1], fmax(start, stop));
    }
}

bool rb_polygon_grid_blocks(struct rb_polygon_grid *grid, const struct rb_ring_vertex *const t[3],
                            enum rb_ring_rule rule)
{
    int row = cell_along(grid, 1, fmin(t[0]->y, fmin(t[1]->y, t[2]->y)));
    int last_row = cell_along(grid, 1, fmax(t[0]->y, fmax(t[1]->y, t[2]->y)));
    for (; row <= last_row; row++) {
        double low = grid->low[1] + (double)row / grid->scale[1] - grid->slack[1];
        double high = grid->low[1] + (double)(row + 1) / grid->scale[1] + grid->slack[1];
        double range[2];
        x_range(t, low, high, range);
        int column = cell_along(grid, 0, range[0] - grid->slack[0]);
        int last = cell_along(grid, 0, range[1] + grid->slack[0]);
        for (; column <= last; column++) {
            if (cell_blocks(grid, cell_at(grid, row, column), t, rule))
                return true;
        }
    }
    return false;
}
