// Camera rays, RB_LANES pixels of a row at a time.
#ifndef RB_KERNELS_PACKET_GENERATE_H
#define RB_KERNELS_PACKET_GENERATE_H

#include "kernels/packet_lanes.h"

// The camera rays of `count` pixels from (x, y) to the right.
static void generate_row(const struct rb_view *view, int x, int y, uint32_t count, uint32_t sample,
                         struct rb_rays *out)
{
    vint lane = vi_lanes(), pixel = vi_set((uint32_t)(y * view->width + x)) + lane;
    vfloat sx = vf_set(view->center), sy = sx;
    for (int i = 0; view->aa > 1 && i < RB_LANES; i++) {
        float in_x, in_y;
        rb_pixel_place(view, (uint32_t)pixel[i], sample, &in_x, &in_y);
        sx[i] = in_x, sy[i] = in_y;
    }
    vfloat at_x = __builtin_convertvector(vi_set((uint32_t)x) + lane, vfloat) + sx;
    struct vvec d = vv_mad(vv_set(view->corner), at_x, vv_set(view->right));
    d = vv_normalize(vv_mad(d, (float)y + sy, vv_set(view->down)));
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
    RB_COUNT_STEP(vi_bits(vi_first(count)), RB_LANES);
    APPEND(columns, out->count, vi_bits(vi_first(count)));
    memset(out->media + out->count, 0, count * sizeof *out->media);
    out->count += count;
}

static void generate(const struct rb_view *view, const struct rb_span *span, struct rb_rays *out)
{
    for (int by = span->y0; by < span->y1; by += RB_BLOCK)
        for (int bx = span->x0; bx < span->x1; bx += RB_BLOCK)
            for (int y = by; y < by + RB_BLOCK && y < span->y1; y++)
                for (int x = bx; x < bx + RB_BLOCK && x < span->x1; x += RB_LANES) {
                    int rest = span->x1 - x;
                    generate_row(view, x, y, (uint32_t)(rest < RB_LANES ? rest : RB_LANES),
                                 span->sample, out);
                }
}

#endif
