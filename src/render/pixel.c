// The tree of rays of one pixel (Figure 1 of the 2019 report), by running the row's own kernels on
// queues of one ray and telling an observer what comes out.
#include "base/fpenv.h"
#include "render/inside.h"
#include "render/renderer.h"

#include <string.h>

struct walk {
    struct rb_renderer *renderer;
    const struct rb_pixel_observer *observer;
};

static void observe_lights(const struct walk *walk, const struct rb_pixel_ray *seen)
{
    struct rb_frame *frame = &walk->renderer->frame;
    struct rb_queues *queues = &walk->renderer->workers[0].queues;
    struct rb_shadows *shadows = &queues->shadows;
    struct rb_light_sample sample = {.pixel_sample = seen->sample};
    for (; sample.light < frame->world.scene->light_count; sample.light++) {
        for (sample.sample = 0; sample.sample < frame->shading.light_samples; sample.sample++) {
            shadows->count = 0;
            frame->kernels->light(&frame->world, &frame->shading, &queues->surfaces, &sample,
                                  shadows);
            struct rb_pixel_shadow shadow = {.light = sample.light, .sample = sample.sample};
            shadow.faces = shadows->count != 0;
            if (shadow.faces) {
                frame->kernels->trace_shadow(&frame->world, shadows);
                shadow.occluded = shadows->occluded[0];
                shadow.color[0] = shadows->r[0];
                shadow.color[1] = shadows->g[0];
                shadow.color[2] = shadows->b[0];
                if (!shadow.occluded)
                    rb_film_add(&frame->film, shadows->pixel[0], shadows->r[0], shadows->g[0],
                                shadows->b[0]);
            }
            walk->observer->shadow(walk->observer->user, seen, &shadow);
        }
    }
}

static struct rb_pixel_ray describe(const struct rb_queues *queues, const struct rb_rays *rays,
                                    int bounce, uint32_t sample)
{
    const struct rb_hits *hits = &queues->hits;
    const struct rb_surfaces *surfaces = &queues->surfaces;
    struct rb_pixel_ray seen = {
        .bounce = bounce,
        .sample = sample,
        .path = rays->path[0],
        .o = {rays->ox[0], rays->oy[0], rays->oz[0]},
        .d = {rays->dx[0], rays->dy[0], rays->dz[0]},
        .weight = rays->weight[0],
        .t = hits->t[0],
        .u = hits->u[0],
        .v = hits->v[0],
        .prim = hits->prim[0],
    };
    if (seen.prim != RB_NONE) {
        seen.n = (struct rb_vec){surfaces->nx[0], surfaces->ny[0], surfaces->nz[0]};
        seen.material = surfaces->material[0];
    }
    return seen;
}

// What the running sums of the pixel hold beyond `before`.
static void added_since(const struct rb_film *film, uint32_t pixel, const uint64_t before[3],
                        float added[3])
{
    for (int k = 0; k < 3; k++)
        added[k] =
            (float)(int64_t)(film->rgb[3 * (size_t)pixel + (size_t)k] - before[k]) / RB_FILM_ONE;
}

// The ray at index `slot` of the queue of `bounce`, and all that comes of it.
static void walk_ray(const struct walk *walk, int bounce, uint32_t slot, uint32_t sample)
{
    struct rb_frame *frame = &walk->renderer->frame;
    struct rb_queues *queues = &walk->renderer->workers[0].queues;
    struct rb_rays rays = rb_rays_view(&queues->rays[bounce], slot, 1, 1);
    bool last = bounce + 1 == frame->settings.depth;
    struct rb_rays reflected = {0}, refracted = {0};
    if (!last) {
        reflected = rb_rays_view(&queues->rays[bounce + 1], 0, 0, 1);
        refracted = rb_rays_view(&queues->rays[bounce + 1], 1, 0, 1);
    }
    uint32_t pixel = rays.pixel[0];
    uint64_t before[3];
    memcpy(before, frame->film.rgb + 3 * (size_t)pixel, sizeof before);
    frame->kernels->trace(&frame->world, &rays, &queues->hits);
    queues->surfaces.count = 0;
    frame->kernels->surface(&frame->world, &frame->shading, &rays, &queues->hits, &queues->surfaces,
                            last ? NULL : &reflected, last ? NULL : &refracted, &frame->film);

    struct rb_pixel_ray seen = describe(queues, &rays, bounce, sample);
    if (seen.prim != RB_NONE)
        seen.total_reflection =
            !last && refracted.count == 0 && frame->world.scene->materials[seen.material].t > 0.0f;
    walk->observer->ray(walk->observer->user, &seen);
    float added[3];
    if (seen.prim != RB_NONE)
        observe_lights(walk, &seen);
    added_since(&frame->film, pixel, before, added);
    walk->observer->local(walk->observer->user, &seen, added);
    if (reflected.count)
        walk_ray(walk, bounce + 1, 0, sample);
    if (refracted.count)
        walk_ray(walk, bounce + 1, 1, sample);
}

void rb_renderer_pixel(struct rb_renderer *renderer, int x, int y,
                       const struct rb_pixel_observer *observer, float color[3])
{
    struct rb_frame *frame = &renderer->frame;
    struct walk walk = {renderer, observer};
    fenv_t saved;
    rb_fpenv_enter(&saved);
    rb_film_clear(&frame->film);
    uint32_t samples = frame->view.aa * frame->view.aa;
    for (uint32_t sample = 0; sample < samples; sample++) {
        struct rb_span span = {x, y, x + 1, y + 1, sample};
        renderer->workers[0].queues.rays[0].count = 0;
        frame->kernels->generate(&frame->view, &span, &renderer->workers[0].queues.rays[0]);
        walk_ray(&walk, 0, 0, sample);
    }
    size_t first = 3 * ((size_t)y * (size_t)frame->film.width + (size_t)x);
    for (size_t k = 0; k < 3; k++)
        color[k] = rb_film_value(frame, first + k);
    rb_fpenv_leave(&saved);
}
