// Scalar bodies of the kernels that do not trace: camera rays, surfaces, lights. They are the
// reference for every SIMD body and serve all kernel sets that bring none of their own.
#include "kernels/shade.h"

static uint32_t append_ray(struct rb_rays *rays, struct rb_vec o, struct rb_vec d)
{
    uint32_t i = rays->count++;
    rays->ox[i] = o.x, rays->oy[i] = o.y, rays->oz[i] = o.z;
    rays->dx[i] = d.x, rays->dy[i] = d.y, rays->dz[i] = d.z;
    return i;
}

static void generate_ray(const struct rb_view *view, int x, int y, uint32_t sample,
                         struct rb_rays *out)
{
    uint32_t pixel = (uint32_t)y * (uint32_t)view->width + (uint32_t)x;
    float sx = view->center, sy = view->center;
    if (view->aa > 1)
        rb_pixel_place(view, pixel, sample, &sx, &sy);
    struct rb_vec d = rb_vec_mad(rb_vec_of(view->corner), (float)x + sx, rb_vec_of(view->right));
    d = rb_vec_mad(d, (float)y + sy, rb_vec_of(view->down));
    uint32_t i = append_ray(out, rb_vec_of(view->from), rb_normalize(d));
    out->weight[i] = 1.0f;
    out->pixel[i] = pixel;
    out->path[i] = 1;
    out->self[i] = RB_NONE;
    out->media[i] = 0;
    RB_COUNT_STEP(1, 1);
}

void RB_TWIN(rb_scalar_generate)(const struct rb_view *view, const struct rb_span *span,
                                 struct rb_rays *out)
{
    for (int by = span->y0; by < span->y1; by += RB_BLOCK)
        for (int bx = span->x0; bx < span->x1; bx += RB_BLOCK)
            for (int cy = by; cy < by + RB_BLOCK && cy < span->y1; cy += RB_CELL)
                for (int cx = bx; cx < bx + RB_BLOCK && cx < span->x1; cx += RB_CELL)
                    for (int y = cy; y < cy + RB_CELL && y < span->y1; y++)
                        for (int x = cx; x < cx + RB_CELL && x < span->x1; x++)
                            generate_ray(view, x, y, span->sample, out);
}

static void append_surface(struct rb_surfaces *out, const struct rb_contact *contact,
                           const struct rb_scene *scene, const struct rb_rays *rays, uint32_t ray)
{
    uint32_t i = out->count++;
    out->px[i] = contact->near.x, out->py[i] = contact->near.y, out->pz[i] = contact->near.z;
    out->nx[i] = contact->n.x, out->ny[i] = contact->n.y, out->nz[i] = contact->n.z;
    out->vx[i] = -contact->d.x, out->vy[i] = -contact->d.y, out->vz[i] = -contact->d.z;
    out->weight[i] = rays->weight[ray];
    out->pixel[i] = rays->pixel[ray];
    out->path[i] = rays->path[ray];
    out->prim[i] = contact->prim;
    out->material[i] = scene->material_of[contact->prim];
    out->inside[i] = !contact->entering;
}

// Path index of a child: 2p for the reflected, 2p + 1 for the refracted ray.
static void append_secondary(struct rb_rays *out, struct rb_vec o, struct rb_vec d, float weight,
                             const struct rb_rays *parent, uint32_t ray, uint32_t child,
                             uint32_t self, uint64_t media)
{
    uint32_t i = append_ray(out, o, d);
    out->weight[i] = parent->weight[ray] * weight;
    out->pixel[i] = parent->pixel[ray];
    out->path[i] = 2 * parent->path[ray] + child;
    out->self[i] = self;
    out->media[i] = media;
}

static void spawn(const struct rb_scene *scene, const struct rb_contact *contact,
                  const struct rb_rays *rays, uint32_t i, struct rb_rays *reflected,
                  struct rb_rays *refracted)
{
    const struct rb_material *material = contact->material;
    if (material->ks > 0.0f || material->t > 0.0f)
        append_secondary(reflected, contact->near, rb_reflect(contact->d, contact->n), material->ks,
                         rays, i, 0, contact->prim, rays->media[i]);
    if (!(material->t > 0.0f))
        return;
    struct rb_crossing crossing =
        rb_media_cross(scene, material, rays->media[i], contact->entering);
    struct rb_vec d;
    if (rb_refract(contact->d, contact->n, crossing.from, crossing.to, &d))
        append_secondary(refracted, contact->far, d, material->t, rays, i, 1, contact->prim,
                         crossing.media);
}

void RB_TWIN(rb_scalar_surface)(const struct rb_world *world, const struct rb_shading *shading,
                                const struct rb_rays *rays, const struct rb_hits *hits,
                                struct rb_surfaces *surfaces, struct rb_rays *reflected,
                                struct rb_rays *refracted, struct rb_film *film)
{
    const struct rb_scene *scene = world->scene;
    for (uint32_t i = 0; i < rays->count; i++) {
        float weight = rays->weight[i];
        RB_COUNT_STEP(hits->prim[i] != RB_NONE, 1);
        if (hits->prim[i] == RB_NONE) {
            rb_film_add_scaled(film, rays->pixel[i], weight, scene->background);
            continue;
        }
        struct rb_contact contact = rb_contact_of_hit(scene, rays, hits, i);
        append_surface(surfaces, &contact, scene, rays, i);
        if (shading->ambient != 0.0f) {
            float ambient = weight * (shading->ambient * contact.material->kd);
            rb_film_add_scaled(film, rays->pixel[i], ambient, contact.material->color);
        }
        if (reflected)
            spawn(scene, &contact, rays, i, reflected, refracted);
    }
}

static void light_surface(const struct rb_scene *scene, const struct rb_shading *shading,
                          const struct rb_surfaces *surfaces, uint32_t i,
                          const struct rb_light_sample *sample, struct rb_shadows *out)
{
    const struct rb_light *light = &scene->lights[sample->light];
    const struct rb_material *material = &scene->materials[surfaces->material[i]];
    struct rb_vec p = {surfaces->px[i], surfaces->py[i], surfaces->pz[i]};
    struct rb_vec n = {surfaces->nx[i], surfaces->ny[i], surfaces->nz[i]};
    struct rb_vec v = {surfaces->vx[i], surfaces->vy[i], surfaces->vz[i]};
    struct rb_vec target = rb_light_point(shading, rb_vec_of(light->position), sample,
                                          surfaces->pixel[i], surfaces->path[i]);
    struct rb_vec to_light = rb_vec_sub(target, p);
    float distance = sqrtf(rb_dot(to_light, to_light));
    struct rb_vec l = rb_vec_scale(to_light, 1.0f / distance);
    float cosine = rb_dot(n, l);
    if (!(cosine > 0.0f))
        return;
    if (surfaces->inside[i] && rb_shadows_itself(scene, surfaces->prim[i], p, l, distance))
        return;
    float share = shading->light_scale / (float)shading->light_samples * surfaces->weight[i];
    float diffuse = material->kd * cosine * share;
    float highlight = material->ks > 0.0f ? rb_highlight(shading, n, l, v, material->shine) : 0.0f;
    float specular = material->ks * highlight * share;
    uint32_t k = out->count++;
    out->ox[k] = p.x, out->oy[k] = p.y, out->oz[k] = p.z;
    out->dx[k] = l.x, out->dy[k] = l.y, out->dz[k] = l.z;
    out->distance[k] = distance;
    out->r[k] = (diffuse * material->color[0] + specular) * light->color[0];
    out->g[k] = (diffuse * material->color[1] + specular) * light->color[1];
    out->b[k] = (diffuse * material->color[2] + specular) * light->color[2];
    out->pixel[k] = surfaces->pixel[i];
    out->self[k] = surfaces->prim[i];
}

void RB_TWIN(rb_scalar_light)(const struct rb_world *world, const struct rb_shading *shading,
                              const struct rb_surfaces *surfaces,
                              const struct rb_light_sample *sample, struct rb_shadows *shadows)
{
    for (uint32_t i = 0; i < surfaces->count; i++) {
        uint32_t lit = shadows->count;
        RB_COUNT_BEGIN(i);
        RB_COUNT_RAYS(SHADINGS, 1, 1);
        light_surface(world->scene, shading, surfaces, i, sample, shadows);
        RB_COUNT_STEP(shadows->count - lit, 1);
    }
}
