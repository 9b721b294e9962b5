// Shadow rays and what they would add, RB_LANES surface points at a time.
#ifndef RB_KERNELS_PACKET_LIGHT_H
#define RB_KERNELS_PACKET_LIGHT_H

#include "kernels/packet_lanes.h"

// rb_power
static inline vfloat vf_power(vfloat x, vfloat n)
{
    vint above = (vint)((vuint)vf_min(x, vf_set(1.0f)) - 0x3f3504f3u);
    vfloat m = (vfloat)((above & vi_set(0x7fffff)) + vi_set(0x3f3504f3));
    vfloat s = (m - 1.0f) / (m + 1.0f);
    vfloat y = n * (__builtin_convertvector(above >> 23, vfloat) + s * RB_LOG2_SERIES(s * s));
    vfloat whole = (y + RB_ROUND) - RB_ROUND, f = y - whole;
    // Lanes whose result is not taken must still convert to integers.
    vfloat bounded = vf_min(vf_max(whole, vf_set(-127.0f)), vf_set(127.0f));
    vuint scale = (vuint)(__builtin_convertvector(bounded, vint) + 127) << 23;
    vfloat power = (vfloat)scale * RB_EXP2_SERIES(f);
    vint tiny = ~(x >= FLT_MIN) | ~(y >= -126.0f);
    return vf_select(n == 0.0f, vf_set(1.0f), vf_select(tiny, vf_set(0.0f), power));
}

// rb_highlight
static inline vfloat highlight(const struct rb_shading *shading, struct vvec n, struct vvec l,
                               struct vvec v, vfloat shine)
{
    if (!shading->phong) {
        struct vvec half = {l.x + v.x, l.y + v.y, l.z + v.z};
        return vf_power(vv_dot(n, vv_normalize(half)), shine);
    }
    vfloat twice = 2.0f * vv_dot(n, l);
    struct vvec mirrored = {n.x * twice - l.x, n.y * twice - l.y, n.z * twice - l.z};
    return vf_power(vv_dot(mirrored, v), shine);
}

struct materials {
    vfloat kd, ks, shine;
    struct vvec color;
};

// Most packets see one material.
static inline struct materials gather_materials(const struct rb_scene *scene, vint index, vint mask)
{
    const struct rb_material *all = scene->materials, *first = &all[index[0]];
    if (!vi_any(mask & (index != vi_set((uint32_t)index[0]))))
        return (struct materials){vf_set(first->kd), vf_set(first->ks), vf_set(first->shine),
                                  vv_set(first->color)};
    return (struct materials){GATHER(all, index, mask, .kd), GATHER(all, index, mask, .ks),
                              GATHER(all, index, mask, .shine),
                              GATHER_VECTOR(all, index, mask, .color)};
}

// The points the packet's shadow rays aim at.
static struct vvec light_points(const struct rb_scene *scene, const struct rb_shading *shading,
                                const struct rb_surfaces *surfaces, uint32_t i, vint there,
                                const struct rb_light_sample *sample)
{
    const float *position = scene->lights[sample->light].position;
    struct vvec target = vv_set(position);
    for (unsigned rest = shading->light_edge > 0.0f ? vi_bits(there) : 0; rest; rest &= rest - 1) {
        int lane = __builtin_ctz(rest);
        uint32_t k = i + (uint32_t)lane;
        set_lane(&target, lane,
                 rb_light_point(shading, rb_vec_of(position), sample, surfaces->pixel[k],
                                surfaces->path[k]));
    }
    return target;
}

// Lanes of `facing` that lie inside of what they are on and in its shadow.
static unsigned shadowed_by_self(const struct rb_scene *scene, const struct rb_surfaces *surfaces,
                                 uint32_t i, struct vvec p, struct vvec l, vfloat distance,
                                 unsigned facing)
{
    unsigned shadowed = 0, inside = 0;
    for (uint32_t lane = 0; lane < RB_LANES; lane++)
        inside |= (unsigned)surfaces->inside[i + lane] << lane;
    for (unsigned rest = facing & inside; rest; rest &= rest - 1) {
        int lane = __builtin_ctz(rest);
        uint32_t k = i + (uint32_t)lane;
        RB_COUNT_LANE(lane);
        if (rb_shadows_itself(scene, surfaces->prim[k], lane_vec(p, lane), lane_vec(l, lane),
                              distance[lane]))
            shadowed |= 1u << lane;
        RB_COUNT_LANE(-lane);
    }
    return shadowed;
}

static void light(const struct rb_world *world, const struct rb_shading *shading,
                  const struct rb_surfaces *surfaces, const struct rb_light_sample *sample,
                  struct rb_shadows *out)
{
    const struct rb_scene *scene = world->scene;
    const float *color = scene->lights[sample->light].color;
    for (uint32_t i = 0; i < surfaces->count; i += RB_LANES) {
        vint there = vi_first(surfaces->count - i), index = vi_load(surfaces->material + i);
        struct vvec p = {vf_load(surfaces->px + i), vf_load(surfaces->py + i),
                         vf_load(surfaces->pz + i)};
        struct vvec n = {vf_load(surfaces->nx + i), vf_load(surfaces->ny + i),
                         vf_load(surfaces->nz + i)};
        struct vvec v = {vf_load(surfaces->vx + i), vf_load(surfaces->vy + i),
                         vf_load(surfaces->vz + i)};
        struct vvec to_light = vv_sub(light_points(scene, shading, surfaces, i, there, sample), p);
        vfloat distance = vf_sqrt(vv_dot(to_light, to_light)), scale = 1.0f / distance;
        struct vvec l = {to_light.x * scale, to_light.y * scale, to_light.z * scale};
        vfloat cosine = vv_dot(n, l);
        unsigned lit = vi_bits(there & (cosine > 0.0f));
        RB_COUNT_BEGIN(i);
        RB_COUNT_RAYS(SHADINGS, vi_bits(there), 1);
        lit &= ~shadowed_by_self(scene, surfaces, i, p, l, distance, lit);
        RB_COUNT_STEP(lit, RB_LANES);
        if (!lit)
            continue;
        struct materials m = gather_materials(scene, index, there);
        vfloat shine_on = vf_set(0.0f);
        if (vi_any(m.ks > 0.0f))
            shine_on = vf_select(m.ks > 0.0f, highlight(shading, n, l, v, m.shine), shine_on);
        vfloat share =
            shading->light_scale / (float)shading->light_samples * vf_load(surfaces->weight + i);
        vfloat diffuse = m.kd * cosine * share, specular = m.ks * shine_on * share;
        const struct column columns[] = {
            FLOATS(out->ox, p.x),
            FLOATS(out->oy, p.y),
            FLOATS(out->oz, p.z),
            FLOATS(out->dx, l.x),
            FLOATS(out->dy, l.y),
            FLOATS(out->dz, l.z),
            FLOATS(out->distance, distance),
            FLOATS(out->r, (diffuse * m.color.x + specular) * color[0]),
            FLOATS(out->g, (diffuse * m.color.y + specular) * color[1]),
            FLOATS(out->b, (diffuse * m.color.z + specular) * color[2]),
            WORDS(out->pixel, vi_load(surfaces->pixel + i)),
            WORDS(out->self, vi_load(surfaces->prim + i)),
        };
        APPEND(columns, out->count, lit);
        out->count += (uint32_t)__builtin_popcount(lit);
    }
}

#endif
