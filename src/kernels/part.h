// Parts of queues, as queues of their own.
#ifndef RB_KERNELS_PART_H
#define RB_KERNELS_PART_H

#include "kernels/kernel.h"

// The part of a ray queue from `first` on: a view with room for `capacity` rays, `count` of them
// there.
static inline struct rb_rays rb_rays_view(const struct rb_rays *r, uint32_t first, uint32_t count,
                                          uint32_t capacity)
{
    return (struct rb_rays){
        r->ox + first,   r->oy + first,   r->oz + first,     r->dx + first,
        r->dy + first,   r->dz + first,   r->weight + first, r->pixel + first,
        r->path + first, r->self + first, r->media + first,  count,
        capacity,
    };
}

static inline struct rb_hits rb_hits_view(const struct rb_hits *h, uint32_t first)
{
    return (struct rb_hits){h->t + first, h->u + first, h->v + first, h->prim + first};
}

static inline struct rb_shadows rb_shadows_view(const struct rb_shadows *s, uint32_t first,
                                                uint32_t count)
{
    return (struct rb_shadows){
        s->ox + first,    s->oy + first,       s->oz + first,       s->dx + first, s->dy + first,
        s->dz + first,    s->distance + first, s->r + first,        s->g + first,  s->b + first,
        s->pixel + first, s->self + first,     s->occluded + first, count,         count,
    };
}

#endif
