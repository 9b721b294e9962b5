// User geometry for Embree: the sphere of intersect.h against eight rays at once, or one; cones one
// by one. Both leave out the primitive that a ray starts on, or take its far root, by RTCRay.id.
// Normals and instances are left alone: nobody reads them.
//
// Compiled with AVX2 (Makefile), for Embree's packets of 8; those of 16 come as two.
#include "embree/tree.h"

#include "kernels/intersect.h"
#include "kernels/simd.h"

// The arrays of a packet of N rays, RTCRayHitN, one after the other.
enum { ORG_X, ORG_Y, ORG_Z, TNEAR, DIR_X, DIR_Y, DIR_Z, TIME, TFAR, MASK, ID, FLAGS };
enum { PRIM_ID = FLAGS + 6, GEOM_ID };
enum { HIT_PRIM_ID = 5 }; // of RTCHitN

static inline float *floats(void *packet, int field, unsigned n)
{
    return (float *)packet + (size_t)field * n;
}

static inline uint32_t *words(void *packet, int field, unsigned n)
{
    return (uint32_t *)packet + (size_t)field * n;
}

// What both kinds of callback get.
struct call {
    const struct rb_scene *scene;
    uint32_t prim; // within its kind
    int *valid;
    void *packet;
    unsigned n;
    bool occlusion;
};

static inline struct vvec load(const struct call *call, int field, unsigned i)
{
    return (struct vvec){vf_load(floats(call->packet, field, call->n) + i),
                         vf_load(floats(call->packet, field + 1, call->n) + i),
                         vf_load(floats(call->packet, field + 2, call->n) + i)};
}

// Rays i and following that the sphere stops, and where.
static inline vint meet_sphere(const struct call *call, unsigned i, vfloat *t)
{
    const struct rb_sphere *sphere = &call->scene->spheres[call->prim];
    vint valid = vi_load((const uint32_t *)call->valid + i) != vi_set(0);
    struct vvec d = load(call, DIR_X, i), l = vv_sub(vv_set(sphere->center), load(call, ORG_X, i));
    vfloat b = vv_dot(l, d);
    struct vvec apart = vv_mad(l, -b, d);
    vfloat discriminant = sphere->radius * sphere->radius - vv_dot(apart, apart);
    vint reached = valid & (discriminant >= 0.0f);
    if (!vi_any(reached))
        return reached;
    vfloat start = vf_load(floats(call->packet, TNEAR, call->n) + i);
    vfloat end = vf_load(floats(call->packet, TFAR, call->n) + i);
    vint own = vi_load(words(call->packet, ID, call->n) + i) == vi_set(call->prim);
    vfloat root = vf_sqrt(discriminant), near = b - root, far = vf_select(own, b + b, b + root);
    vint take_near = (near > start) & ~own;
    if (call->occlusion)
        reached &= ~own;
    else if (sphere->radius < 0.0f)
        take_near = vi_set(0);
    *t = vf_select(take_near, near, far);
    return reached & (*t > start) & (*t < end);
}

static inline bool meet_sphere_1(const struct call *call, float *t)
{
    const struct rb_sphere *sphere = &call->scene->spheres[call->prim];
    const struct RTCRay *ray = call->packet;
    struct rb_vec d = {ray->dir_x, ray->dir_y, ray->dir_z};
    struct rb_vec o = {ray->org_x, ray->org_y, ray->org_z};
    struct rb_vec l = rb_vec_sub(rb_vec_of(sphere->center), o);
    float b = rb_dot(l, d);
    struct rb_vec apart = rb_vec_mad(l, -b, d);
    float discriminant = sphere->radius * sphere->radius - rb_dot(apart, apart);
    bool own = ray->id == call->prim;
    if (!(discriminant >= 0.0f) || (own && call->occlusion))
        return false;
    float root = sqrtf(discriminant), near = b - root;
    bool inside_only = sphere->radius < 0.0f && !call->occlusion;
    bool take_near = near > ray->tnear && !own && !inside_only;
    *t = take_near ? near : own ? b + b : b + root;
    return *t > ray->tnear && *t < ray->tfar;
}

static inline void spheres(const struct call *call, unsigned geometry)
{
    for (unsigned i = 0; call->n % RB_LANES == 0 && i < call->n; i += RB_LANES) {
        vfloat t;
        vint met = meet_sphere(call, i, &t);
        if (!vi_any(met))
            continue;
        float *end = floats(call->packet, TFAR, call->n) + i;
        vf_store(end, vf_select(met, call->occlusion ? vf_set(-INFINITY) : t, vf_load(end)));
        if (call->occlusion)
            continue;
        uint32_t *prim = words(call->packet, PRIM_ID, call->n) + i;
        uint32_t *geom = words(call->packet, GEOM_ID, call->n) + i;
        vi_store(prim, vi_select(met, vi_set(call->prim), vi_load(prim)));
        vi_store(geom, vi_select(met, vi_set(geometry), vi_load(geom)));
    }
}

// One ray of a packet of any size, taken out and put back.
typedef bool meet_fn(const struct call *call, float *t);

static inline void one_by_one(const struct call *call, unsigned geometry, meet_fn *meet)
{
    for (unsigned i = 0; i < call->n; i++) {
        struct call single = *call;
        struct RTCRay ray;
        float t;
        if (!call->valid[i])
            continue;
        for (int field = 0; field <= FLAGS && call->n > 1; field++)
            memcpy((char *)&ray + (size_t)field * sizeof(float),
                   floats(call->packet, field, call->n) + i, sizeof(float));
        if (call->n > 1)
            single.packet = &ray;
        if (!meet(&single, &t))
            continue;
        floats(call->packet, TFAR, call->n)[i] = call->occlusion ? -INFINITY : t;
        if (call->occlusion)
            continue;
        words(call->packet, PRIM_ID, call->n)[i] = call->prim;
        words(call->packet, GEOM_ID, call->n)[i] = geometry;
    }
}

static inline bool meet_cone_1(const struct call *call, float *t)
{
    const struct RTCRay *from = call->packet;
    struct rb_vec o = {from->org_x, from->org_y, from->org_z};
    struct rb_vec d = {from->dir_x, from->dir_y, from->dir_z};
    enum rb_sides sides = call->occlusion ? RB_SIDES_BOTH : RB_SIDES_VISIBLE;
    struct rb_ray ray = rb_ray_make(o, d, from->id, sides);
    struct rb_hit hit;
    if (!rb_cone_hit(call->scene, call->prim, &ray, &hit))
        return false;
    *t = hit.t;
    return hit.t > from->tnear && hit.t < from->tfar;
}

static inline void meet_spheres(const struct call *call, unsigned geometry)
{
    if (call->n % RB_LANES == 0)
        spheres(call, geometry);
    else
        one_by_one(call, geometry, meet_sphere_1);
}

void rb_embree_spheres_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const struct call call = {a->geometryUserPtr, a->primID, a->valid, a->rayhit, a->N, false};
    meet_spheres(&call, a->geomID);
}

void rb_embree_spheres_occluded(const struct RTCOccludedFunctionNArguments *a)
{
    const struct call call = {a->geometryUserPtr, a->primID, a->valid, a->ray, a->N, true};
    meet_spheres(&call, a->geomID);
}

// A shadow ray passes the sphere it starts on.
void rb_embree_spheres_filter(const struct RTCFilterFunctionNArguments *a)
{
    for (unsigned i = 0; i < a->N; i++)
        if (words(a->ray, ID, a->N)[i] == words(a->hit, HIT_PRIM_ID, a->N)[i])
            a->valid[i] = 0;
}

void rb_embree_cones_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const struct call call = {a->geometryUserPtr, a->primID, a->valid, a->rayhit, a->N, false};
    one_by_one(&call, a->geomID, meet_cone_1);
}

void rb_embree_cones_occluded(const struct RTCOccludedFunctionNArguments *a)
{
    const struct call call = {a->geometryUserPtr, a->primID, a->valid, a->ray, a->N, true};
    one_by_one(&call, a->geomID, meet_cone_1);
}
