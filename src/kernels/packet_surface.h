// From hits to surface points and secondary rays, RB_LANES at a time.
#ifndef RB_KERNELS_PACKET_SURFACE_H
#define RB_KERNELS_PACKET_SURFACE_H

#include "kernels/packet_lanes.h"

// rb_point, lane by lane.
struct points {
    struct vvec p, geometric, shading;
    vfloat offset;
    vint curved;
};

static inline void keep_points(struct points *points, vint mask, const struct points *of_kind)
{
    points->p = vv_select(mask, of_kind->p, points->p);
    points->geometric = vv_select(mask, of_kind->geometric, points->geometric);
    points->shading = points->geometric;
    points->offset = vf_select(mask, of_kind->offset, points->offset);
}

// rb_point_on_sphere
static void points_on_spheres(const struct rb_scene *scene, struct vvec p, vint prim, vint mask,
                              struct points *points)
{
    struct vvec c = GATHER_VECTOR(scene->spheres, prim, mask, .center);
    vfloat radius = vf_abs(GATHER(scene->spheres, prim, mask, .radius));
    struct points on;
    on.geometric = vv_normalize(vv_sub(p, c));
    on.p = vv_mad(c, radius, on.geometric);
    on.offset = RB_CURVED_OFFSET_SCALE * vf_max(vv_reach(on.p), radius);
    keep_points(points, mask, &on);
}

// rb_point_on_triangle, but for interpolated normals
static void points_on_triangles(const struct rb_scene *scene, vfloat u, vfloat v, vint prim,
                                vint mask, struct points *points)
{
    vint index = prim - vi_set(scene->first[RB_TRIANGLE]);
    struct vvec v0 = GATHER_VECTOR(scene->triangles, index, mask, .v[0]);
    struct vvec e1 = vv_sub(GATHER_VECTOR(scene->triangles, index, mask, .v[1]), v0);
    struct vvec e2 = vv_sub(GATHER_VECTOR(scene->triangles, index, mask, .v[2]), v0);
    struct points on = {.offset = {0}};
    on.p = vv_mad(vv_mad(v0, u, e1), v, e2);
    on.geometric = GATHER_VECTOR(scene->triangle_normals, index, mask, );
    on.offset = RB_OFFSET_SCALE * vf_max(vv_reach(on.p), vf_max(vv_reach(e1), vv_reach(e2)));
    keep_points(points, mask, &on);
}

// rb_point_on_plane
static void points_on_planes(const struct rb_scene *scene, struct vvec p, vint prim, vint mask,
                             struct points *points)
{
    vint index = prim - vi_set(scene->first[RB_PLANE]);
    vfloat distance = GATHER(scene->planes, index, mask, .distance);
    struct points on;
    on.geometric = GATHER_VECTOR(scene->planes, index, mask, .normal);
    on.p = vv_mad(p, -(vv_dot(on.geometric, p) - distance), on.geometric);
    on.offset = RB_OFFSET_SCALE * vv_reach(on.p);
    keep_points(points, mask, &on);
}

// What the rays of a packet met.
static struct points points_of_hits(const struct rb_scene *scene, struct vvec o, struct vvec d,
                                    const struct rb_hits *hits, uint32_t i, vint met)
{
    vfloat t = vf_load(hits->t + i), u = vf_load(hits->u + i), v = vf_load(hits->v + i);
    vint prim = vi_load(hits->prim + i), kind = vi_set(0), smooth = vi_set(0);
    for (unsigned rest = vi_bits(met); rest; rest &= rest - 1) {
        int lane = __builtin_ctz(rest);
        uint32_t id = (uint32_t)prim[lane];
        kind[lane] = (int32_t)rb_scene_kind(scene, id);
        if (kind[lane] == RB_TRIANGLE && scene->triangle_smooth)
            smooth[lane] = -(scene->triangle_smooth[id - scene->first[RB_TRIANGLE]] != RB_NONE);
    }
    struct points points = {.curved = (kind == RB_SPHERE) | (kind == RB_CONE)};
    struct vvec p = vv_mad(o, t, d);
    vint spheres = met & (kind == RB_SPHERE), triangles = met & (kind == RB_TRIANGLE);
    vint planes = met & (kind == RB_PLANE), others = (met & (kind == RB_CONE)) | smooth;
    if (vi_any(spheres))
        points_on_spheres(scene, p, prim, spheres, &points);
    if (vi_any(triangles))
        points_on_triangles(scene, u, v, prim, triangles, &points);
    if (vi_any(planes))
        points_on_planes(scene, p, prim, planes, &points);
    for (unsigned rest = vi_bits(others); rest; rest &= rest - 1) { // rare: one by one
        int lane = __builtin_ctz(rest);
        struct rb_hit hit = {t[lane], u[lane], v[lane], (uint32_t)prim[lane]};
        struct rb_point point = rb_point_of_hit(scene, lane_vec(o, lane), lane_vec(d, lane), &hit);
        set_lane(&points.p, lane, point.p);
        set_lane(&points.geometric, lane, point.geometric);
        set_lane(&points.shading, lane, point.shading);
        points.offset[lane] = point.offset;
    }
    return points;
}

// The rays of a packet and the surfaces they met, as the secondary rays need them.
struct surface_packet {
    const struct rb_rays *rays;
    uint32_t first; // index of lane 0 in the queue
    struct vvec d, n, near, far;
    vint prim, material, entering;
};

static void append_secondaries(struct rb_rays *out, const struct surface_packet *s, struct vvec o,
                               struct vvec d, vfloat factor, int32_t child,
                               const uint64_t media[RB_LANES], unsigned bits)
{
    const struct rb_rays *rays = s->rays;
    const struct column columns[] = {
        FLOATS(out->ox, o.x),
        FLOATS(out->oy, o.y),
        FLOATS(out->oz, o.z),
        FLOATS(out->dx, d.x),
        FLOATS(out->dy, d.y),
        FLOATS(out->dz, d.z),
        FLOATS(out->weight, vf_load(rays->weight + s->first) * factor),
        WORDS(out->pixel, vi_load(rays->pixel + s->first)),
        WORDS(out->path, (vint)((vuint)vi_load(rays->path + s->first) * 2u + (uint32_t)child)),
        WORDS(out->self, s->prim),
    };
    APPEND(columns, out->count, bits);
    for (unsigned rest = bits; rest; rest &= rest - 1)
        out->media[out->count++] = media[__builtin_ctz(rest)];
}

// rb_reflect
static inline struct vvec vv_reflect(struct vvec d, struct vvec n)
{
    return vv_normalize(vv_mad(d, -2.0f * vv_dot(d, n), n));
}

// Glass: Snell's law and the media, one ray after the other.
static void refract_lanes(const struct rb_scene *scene, const struct surface_packet *s,
                          vfloat transmittance, unsigned glass, struct rb_rays *refracted)
{
    struct vvec direction = s->d;
    uint64_t media[RB_LANES];
    unsigned passing = 0;
    for (unsigned rest = glass; rest; rest &= rest - 1) {
        int lane = __builtin_ctz(rest);
        const struct rb_material *material = &scene->materials[s->material[lane]];
        struct rb_crossing crossing = rb_media_cross(
            scene, material, s->rays->media[s->first + (uint32_t)lane], s->entering[lane] != 0);
        struct rb_vec d;
        if (!rb_refract(lane_vec(s->d, lane), lane_vec(s->n, lane), crossing.from, crossing.to, &d))
            continue;
        set_lane(&direction, lane, d);
        media[lane] = crossing.media;
        passing |= 1u << lane;
    }
    append_secondaries(refracted, s, s->far, direction, transmittance, 1, media, passing);
}

static void spawn_lanes(const struct rb_scene *scene, const struct surface_packet *s, vint met,
                        struct rb_rays *reflected, struct rb_rays *refracted)
{
    vfloat ks = GATHER(scene->materials, s->material, met, .ks);
    vfloat t = GATHER(scene->materials, s->material, met, .t);
    unsigned mirror = vi_bits(met & ((ks > 0.0f) | (t > 0.0f))), glass = vi_bits(met & (t > 0.0f));
    uint64_t media[RB_LANES];
    memcpy(media, s->rays->media + s->first, sizeof media);
    if (mirror)
        append_secondaries(reflected, s, s->near, vv_reflect(s->d, s->n), ks, 0, media, mirror);
    if (glass)
        refract_lanes(scene, s, t, glass, refracted);
}

static void append_surfaces(struct rb_surfaces *out, const struct surface_packet *s, unsigned met)
{
    const struct column columns[] = {
        FLOATS(out->px, s->near.x),
        FLOATS(out->py, s->near.y),
        FLOATS(out->pz, s->near.z),
        FLOATS(out->nx, s->n.x),
        FLOATS(out->ny, s->n.y),
        FLOATS(out->nz, s->n.z),
        FLOATS(out->vx, -s->d.x),
        FLOATS(out->vy, -s->d.y),
        FLOATS(out->vz, -s->d.z),
        FLOATS(out->weight, vf_load(s->rays->weight + s->first)),
        WORDS(out->pixel, vi_load(s->rays->pixel + s->first)),
        WORDS(out->path, vi_load(s->rays->path + s->first)),
        WORDS(out->prim, s->prim),
        WORDS(out->material, s->material),
    };
    APPEND(columns, out->count, met);
    for (unsigned rest = met; rest; rest &= rest - 1)
        out->inside[out->count++] = s->entering[__builtin_ctz(rest)] == 0;
}

// Background for misses, ambient light for hits.
static void light_film(const struct rb_scene *scene, const struct rb_shading *shading,
                       const struct surface_packet *s, unsigned met, unsigned missed,
                       struct rb_film *film)
{
    for (unsigned rest = missed; rest; rest &= rest - 1) {
        uint32_t i = s->first + (uint32_t)__builtin_ctz(rest);
        rb_film_add_scaled(film, s->rays->pixel[i], s->rays->weight[i], scene->background);
    }
    for (unsigned rest = shading->ambient != 0.0f ? met : 0; rest; rest &= rest - 1) {
        int lane = __builtin_ctz(rest);
        uint32_t i = s->first + (uint32_t)lane;
        const struct rb_material *material = &scene->materials[s->material[lane]];
        float ambient = s->rays->weight[i] * (shading->ambient * material->kd);
        rb_film_add_scaled(film, s->rays->pixel[i], ambient, material->color);
    }
}

static void surface(const struct rb_world *world, const struct rb_shading *shading,
                    const struct rb_rays *rays, const struct rb_hits *hits,
                    struct rb_surfaces *surfaces, struct rb_rays *reflected,
                    struct rb_rays *refracted, struct rb_film *film)
{
    const struct rb_scene *scene = world->scene;
    for (uint32_t i = 0; i < rays->count; i += RB_LANES) {
        struct vvec o = {vf_load(rays->ox + i), vf_load(rays->oy + i), vf_load(rays->oz + i)};
        struct vvec d = {vf_load(rays->dx + i), vf_load(rays->dy + i), vf_load(rays->dz + i)};
        struct surface_packet s = {.rays = rays, .first = i, .d = d};
        s.prim = vi_load(hits->prim + i);
        vint there = vi_first(rays->count - i), met = there & (s.prim != vi_set(RB_NONE));
        unsigned bits = vi_bits(met);
        RB_COUNT_STEP(bits, RB_LANES);
        struct points points = points_of_hits(scene, o, d, hits, i, met);
        for (unsigned rest = bits; rest; rest &= rest - 1) {
            int lane = __builtin_ctz(rest);
            s.material[lane] = (int32_t)scene->material_of[(uint32_t)s.prim[lane]];
        }
        struct vvec side = vv_turned(points.geometric, d);
        s.n = vv_turned(points.shading, d);
        s.entering = vv_dot(d, points.geometric) < 0.0f;
        vfloat zero = vf_set(0.0f);
        s.near =
            vv_mad(points.p, vf_select(points.curved & ~s.entering, zero, points.offset), side);
        s.far = vv_mad(points.p, -vf_select(points.curved, zero, points.offset), side);
        light_film(scene, shading, &s, bits, vi_bits(there) & ~bits, film);
        append_surfaces(surfaces, &s, bits);
        if (reflected)
            spawn_lanes(scene, &s, met, reflected, refracted);
    }
}

#endif
