// Camera rays, RB_LANES pixels at a time.
#ifndef RB_KERNELS_PACKET_GENERATE_H
#define RB_KERNELS_PACKET_GENERATE_H

#include "kernels/packet_lanes.h"

// The camera rays of RB_LANES pixels of a cell from (x, y) on, those of the span.
static void generate_some(const struct rb_view *view, const struct rb_span *span, int x, int y,
                          struct rb_rays *out)
{
    vint px = vi_set((uint32_t)x) + vi_lanes() % RB_CELL;
    vint py = vi_set((uint32_t)y) + vi_lanes() / RB_CELL;
    vint pixel = py * view->width + px;
    unsigned bits = vi_bits((px < span->x1) & (py < span->y1));
    vfloat sx = vf_set(view->center), sy = sx;
    for (int i = 0; view->aa > 1 && i < RB_LANES; i++) {
        float in_x, in_y;
        rb_pixel_place(view, (uint32_t)pixel[i], span->sample, &in_x, &in_y);
        sx[i] = in_x, sy[i] = in_y;
    }
    vfloat at_x = __builtin_convertvector(px, vfloat) + sx;
    vfloat at_y = __builtin_convertvector(py, vfloat) + sy;
    struct vvec d = vv_mad(vv_set(view->corner), at_x, vv_set(view->right));
    d = vv_normalize(vv_mad(d, at_y, vv_set(view->down)));
    struct vvec o = vv_set(view->from);
    const struct column columns[] = {
        FLOATS(out->ox, o.x),
        FLOATS(out->oy, o.y),
        FLOATS(out->oz, o.z),
        FLOATS(out->dx, d.x),
        FLOATS(out->dy, d.y),
        FLOATS(out->dz, d.z),
        FLOATS(out->weight, vf_set(1.0f)),
        WORDS(out->pixel, pixel),
        WORDS(out->path, vi_set(1)),
        WORDS(out->self, vi_set(RB_NONE)),
    };
    uint32_t count = (uint32_t)__builtin_popcount(bits);
    RB_COUNT_STEP(bits, RB_LANES);
    APPEND(columns, out->count, bits);
    memset(out->media + out->count, 0, count * sizeof *out->media);
    out->count += count;
}

static void generate(const struct rb_view *view, const struct rb_span *span, struct rb_rays *out)
{
    for (int by = span->y0; by < span->y1; by += RB_BLOCK)
        for (int bx = span->x0; bx < span->x1; bx += RB_BLOCK)
            for (int cy = by; cy < by + RB_BLOCK && cy < span->y1; cy += RB_CELL)
                for (int x = bx; x < bx + RB_BLOCK && x < span->x1; x += RB_CELL)
                    for (int y = cy; y < cy + RB_CELL; y += RB_LANES / RB_CELL)
                        generate_some(view, span, x, y, out);
}

#endif
