// Kernel sets that trace through Embree's tree, in every way it has. Planes come first, outside of
// the tree; they shorten the rays. What Embree wants is set around its calls: denormals are zero,
// and contexts say whether rays are coherent.
//
// Compiled once per instruction set (Makefile): packets of 8 rays with AVX2, of 16 with AVX-512.
#include "embree/tree.h"

#include "kernels/intersect.h"
#include "kernels/simd.h"

#if RB_LANES == 16
#define PACKET RTCRayHit16
#define TABLE  rb_embree_avx512
#else
#define PACKET RTCRayHit8
#define TABLE  rb_embree_avx2
#endif

// Packets that go through at once: a stream has so many times RB_LANES rays. Embree 3 makes
// batches of 64 of them, by octant.
enum { STREAM_PACKETS = 256 / RB_LANES };

// Rays in the form that Embree reads; as wide as a vector.
struct packet {
    struct PACKET of;
    _Alignas(64) int valid[RB_LANES];
    vint plane; // id of the closest plane; for shadow rays lanes that a plane stops
};

// Rays from the light end so much of their length, eight ulps, ahead of the point.
static const float FAR_AHEAD = 0x1p-20f;

// How the rays of some packets are answered.
typedef void shoot_fn(RTCScene scene, struct RTCIntersectContext *context, struct packet *packets,
                      uint32_t count);

struct guard {
    unsigned csr;
};

static inline struct guard enter(void)
{
    struct guard guard = {_mm_getcsr()};
    _mm_setcsr(guard.csr | 0x8040); // flush to zero, denormals are zero
    return guard;
}

static inline void leave(struct guard guard)
{
    _mm_setcsr(guard.csr);
}

// Distance to a plane that the lanes of the result meet. rb_plane_test, for rays that see both
// sides.
static inline vint meet_plane(const struct rb_scene *scene, uint32_t index, struct vvec o,
                              struct vvec d, vint self, vfloat *t)
{
    const struct rb_plane *plane = &scene->planes[index];
    struct vvec n = vv_set(plane->normal);
    *t = (plane->distance - vv_dot(n, o)) / vv_dot(n, d);
    return (self != vi_set(scene->first[RB_PLANE] + index)) & (*t > 0.0f) & (*t < INFINITY);
}

// `start` and `end` bound the rays. Lanes that are not valid get an empty ray, for streams.
static inline void fill(struct packet *packet, struct vvec o, struct vvec d, vint self,
                        vfloat start, vfloat end, vint valid)
{
    struct PACKET *of = &packet->of;
    vf_store(of->ray.org_x, vf_select(valid, o.x, vf_set(0.0f)));
    vf_store(of->ray.org_y, vf_select(valid, o.y, vf_set(0.0f)));
    vf_store(of->ray.org_z, vf_select(valid, o.z, vf_set(0.0f)));
    vf_store(of->ray.dir_x, vf_select(valid, d.x, vf_set(1.0f)));
    vf_store(of->ray.dir_y, vf_select(valid, d.y, vf_set(0.0f)));
    vf_store(of->ray.dir_z, vf_select(valid, d.z, vf_set(0.0f)));
    vf_store(of->ray.tnear, vf_select(valid, start, vf_set(0.0f)));
    vf_store(of->ray.tfar, vf_select(valid, end, vf_set(-INFINITY)));
    vf_store(of->ray.time, vf_set(0.0f));
    vi_store(of->ray.mask, vi_set(UINT32_MAX));
    vi_store(of->ray.id, self);
    vi_store(of->ray.flags, vi_set(0));
    vi_store(of->hit.geomID, vi_set(RTC_INVALID_GEOMETRY_ID));
    vi_store(of->hit.primID, vi_set(RTC_INVALID_GEOMETRY_ID));
    vi_store(of->hit.instID[0], vi_set(RTC_INVALID_GEOMETRY_ID));
    vi_store((uint32_t *)packet->valid, valid);
}

static inline vfloat start_of(const struct rb_embree *embree, vint self)
{
    return vf_select(self == vi_set(RB_NONE), vf_set(0.0f), vf_set(embree->epsilon));
}

static inline void load_rays(const struct rb_world *world, const struct rb_rays *rays, uint32_t i,
                             struct packet *packet)
{
    struct vvec o = {vf_load(rays->ox + i), vf_load(rays->oy + i), vf_load(rays->oz + i)};
    struct vvec d = {vf_load(rays->dx + i), vf_load(rays->dy + i), vf_load(rays->dz + i)};
    vint self = vi_load(rays->self + i);
    vfloat end = vf_set(INFINITY), t;
    packet->plane = vi_set(RB_NONE);
    for (uint32_t p = 0; p < world->scene->count[RB_PLANE]; p++) {
        vint met = meet_plane(world->scene, p, o, d, self, &t) & (t < end);
        end = vf_select(met, t, end);
        packet->plane = vi_select(met, vi_set(world->scene->first[RB_PLANE] + p), packet->plane);
    }
    fill(packet, o, d, self, start_of(world->embree, self), end,
         vi_first(rays->count - i) & vv_finite(o) & vv_finite(d));
}

static inline void store_hits(const struct rb_world *world, const struct packet *packet,
                              struct rb_hits *hits, uint32_t i)
{
    const struct PACKET *of = &packet->of;
    vint valid = vi_load((const uint32_t *)packet->valid), geom = vi_load(of->hit.geomID);
    vint triangle = valid & (geom == vi_set(RB_TRIANGLE));
    vint prim = vi_load(of->hit.primID);
    prim += triangle & vi_set(world->scene->first[RB_TRIANGLE]);
    prim += (geom == vi_set(RB_CONE)) & vi_set(world->scene->first[RB_CONE]);
    prim = vi_select(geom == vi_set(RTC_INVALID_GEOMETRY_ID), packet->plane, prim);
    vf_store(hits->t + i, vf_select(valid, vf_load(of->ray.tfar), vf_set(INFINITY)));
    vf_store(hits->u + i, vf_select(triangle, vf_load(of->hit.u), vf_set(0.0f)));
    vf_store(hits->v + i, vf_select(triangle, vf_load(of->hit.v), vf_set(0.0f)));
    vi_store(hits->prim + i, vi_select(valid, prim, vi_set(RB_NONE)));
}

static inline void load_shadows(const struct rb_world *world, const struct rb_shadows *shadows,
                                uint32_t i, bool from_light, struct packet *packet)
{
    struct vvec o = {vf_load(shadows->ox + i), vf_load(shadows->oy + i), vf_load(shadows->oz + i)};
    struct vvec d = {vf_load(shadows->dx + i), vf_load(shadows->dy + i), vf_load(shadows->dz + i)};
    vint self = vi_load(shadows->self + i);
    vint valid = vi_first(shadows->count - i) & vv_finite(o) & vv_finite(d);
    vfloat start = start_of(world->embree, self), end = vf_load(shadows->distance + i), t;
    packet->plane = vi_set(0);
    for (uint32_t p = 0; p < world->scene->count[RB_PLANE]; p++)
        packet->plane |= valid & meet_plane(world->scene, p, o, d, self, &t) & (t < end);
    if (from_light) {
        vfloat zero = vf_set(0.0f);
        o = vv_mad(o, end, d);
        d = vv_sub((struct vvec){zero, zero, zero}, d);
        end = end - start - end * FAR_AHEAD;
        start = zero;
    }
    fill(packet, o, d, self, start, end, valid & ~packet->plane);
}

static inline void store_occluded(const struct packet *packet, struct rb_shadows *shadows,
                                  uint32_t i)
{
    vint valid = vi_load((const uint32_t *)packet->valid);
    unsigned stopped = vi_bits(valid & (vf_load(packet->of.ray.tfar) < 0.0f));
    stopped |= vi_bits(packet->plane);
    for (uint32_t lane = 0; lane < RB_LANES && i + lane < shadows->count; lane++)
        shadows->occluded[i + lane] = stopped >> lane & 1;
}

// One ray out of a packet, and its answer back.
static inline void take_ray(const struct packet *packet, int lane, struct RTCRay *ray)
{
    const struct PACKET *of = &packet->of;
    *ray = (struct RTCRay){
        .org_x = of->ray.org_x[lane],
        .org_y = of->ray.org_y[lane],
        .org_z = of->ray.org_z[lane],
        .tnear = of->ray.tnear[lane],
        .dir_x = of->ray.dir_x[lane],
        .dir_y = of->ray.dir_y[lane],
        .dir_z = of->ray.dir_z[lane],
        .tfar = of->ray.tfar[lane],
        .mask = UINT32_MAX,
        .id = of->ray.id[lane],
    };
}

static inline void take(const struct packet *packet, int lane, struct RTCRayHit *single)
{
    take_ray(packet, lane, &single->ray);
    single->hit.geomID = RTC_INVALID_GEOMETRY_ID;
    single->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

static inline void put_back(struct packet *packet, int lane, const struct RTCRayHit *single)
{
    struct PACKET *of = &packet->of;
    of->ray.tfar[lane] = single->ray.tfar;
    of->hit.u[lane] = single->hit.u;
    of->hit.v[lane] = single->hit.v;
    of->hit.primID[lane] = single->hit.primID;
    of->hit.geomID[lane] = single->hit.geomID;
}

static void intersect_single(RTCScene scene, struct RTCIntersectContext *context,
                             struct packet *packets, uint32_t count)
{
    for (uint32_t p = 0; p < count; p++)
        for (int lane = 0; lane < RB_LANES; lane++) {
            struct RTCRayHit single;
            if (!packets[p].valid[lane])
                continue;
            take(&packets[p], lane, &single);
            rtcIntersect1(scene, context, &single);
            put_back(&packets[p], lane, &single);
        }
}

static void occluded_single(RTCScene scene, struct RTCIntersectContext *context,
                            struct packet *packets, uint32_t count)
{
    for (uint32_t p = 0; p < count; p++)
        for (int lane = 0; lane < RB_LANES; lane++) {
            struct RTCRay ray;
            if (!packets[p].valid[lane])
                continue;
            take_ray(&packets[p], lane, &ray);
            rtcOccluded1(scene, context, &ray);
            packets[p].of.ray.tfar[lane] = ray.tfar;
        }
}

static void intersect_packet(RTCScene scene, struct RTCIntersectContext *context,
                             struct packet *packets, uint32_t count)
{
    for (uint32_t p = 0; p < count; p++)
#if RB_LANES == 16
        rtcIntersect16(packets[p].valid, scene, context, &packets[p].of);
#else
        rtcIntersect8(packets[p].valid, scene, context, &packets[p].of);
#endif
}

static void occluded_packet(RTCScene scene, struct RTCIntersectContext *context,
                            struct packet *packets, uint32_t count)
{
    for (uint32_t p = 0; p < count; p++)
#if RB_LANES == 16
        rtcOccluded16(packets[p].valid, scene, context, &packets[p].of.ray);
#else
        rtcOccluded8(packets[p].valid, scene, context, &packets[p].of.ray);
#endif
}

static void intersect_stream(RTCScene scene, struct RTCIntersectContext *context,
                             struct packet *packets, uint32_t count)
{
    struct RTCRayHit rays[STREAM_PACKETS * RB_LANES];
    for (uint32_t i = 0; i < count * RB_LANES; i++)
        take(&packets[i / RB_LANES], (int)(i % RB_LANES), &rays[i]);
    rtcIntersect1M(scene, context, rays, count * RB_LANES, sizeof *rays);
    for (uint32_t i = 0; i < count * RB_LANES; i++)
        put_back(&packets[i / RB_LANES], (int)(i % RB_LANES), &rays[i]);
}

static void occluded_stream(RTCScene scene, struct RTCIntersectContext *context,
                            struct packet *packets, uint32_t count)
{
    struct RTCRay rays[STREAM_PACKETS * RB_LANES];
    for (uint32_t i = 0; i < count * RB_LANES; i++)
        take_ray(&packets[i / RB_LANES], (int)(i % RB_LANES), &rays[i]);
    rtcOccluded1M(scene, context, rays, count * RB_LANES, sizeof *rays);
    for (uint32_t i = 0; i < count * RB_LANES; i++)
        packets[i / RB_LANES].of.ray.tfar[i % RB_LANES] = rays[i].tfar;
}

static inline void closest(const struct rb_world *world, const struct rb_rays *rays,
                           struct rb_hits *hits, shoot_fn *shoot, uint32_t most,
                           enum RTCIntersectContextFlags coherence)
{
    struct packet packets[STREAM_PACKETS];
    struct RTCIntersectContext context;
    struct guard guard = enter();
    rtcInitIntersectContext(&context);
    context.flags = coherence;
    for (uint32_t i = 0; i < rays->count;) {
        uint32_t first = i, count = 0;
        for (; count < most && i < rays->count; i += RB_LANES)
            load_rays(world, rays, i, &packets[count++]);
        shoot(world->embree->scene, &context, packets, count);
        for (uint32_t p = 0; p < count; p++)
            store_hits(world, &packets[p], hits, first + p * RB_LANES);
    }
    leave(guard);
}

static inline void any(const struct rb_world *world, struct rb_shadows *shadows, shoot_fn *shoot,
                       uint32_t most, enum RTCIntersectContextFlags coherence, bool from_light)
{
    struct packet packets[STREAM_PACKETS];
    struct RTCIntersectContext context;
    struct guard guard = enter();
    rtcInitIntersectContext(&context);
    context.flags = coherence;
    for (uint32_t i = 0; i < shadows->count;) {
        uint32_t first = i, count = 0;
        for (; count < most && i < shadows->count; i += RB_LANES)
            load_shadows(world, shadows, i, from_light, &packets[count++]);
        shoot(world->embree->scene, &context, packets, count);
        for (uint32_t p = 0; p < count; p++)
            store_occluded(&packets[p], shadows, first + p * RB_LANES);
    }
    leave(guard);
}

#define COHERENT   RTC_INTERSECT_CONTEXT_FLAG_COHERENT
#define INCOHERENT RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT

// The functions of one way: trace_WAY, point_WAY, light_WAY.
#define WAY(way, kind, most, coherence)                                                            \
    static void trace_##way(const struct rb_world *world, const struct rb_rays *rays,              \
                            struct rb_hits *hits)                                                  \
    {                                                                                              \
        closest(world, rays, hits, intersect_##kind, most, coherence);                             \
    }                                                                                              \
    static void point_##way(const struct rb_world *world, struct rb_shadows *shadows)              \
    {                                                                                              \
        any(world, shadows, occluded_##kind, most, coherence, false);                              \
    }                                                                                              \
    static void light_##way(const struct rb_world *world, struct rb_shadows *shadows)              \
    {                                                                                              \
        any(world, shadows, occluded_##kind, most, coherence, true);                               \
    }

WAY(single, single, 1, INCOHERENT)
WAY(packet, packet, 1, INCOHERENT)
WAY(packet_coherent, packet, 1, COHERENT)
WAY(stream, stream, STREAM_PACKETS, INCOHERENT)
WAY(stream_coherent, stream, STREAM_PACKETS, COHERENT)

#define SET(way, from)                                                                             \
    {                                                                                              \
        rb_scalar_generate, trace_##way, rb_scalar_surface, rb_scalar_light, from##_##way          \
    }
#define SETS(way)                                                                                  \
    {                                                                                              \
        SET(way, point), SET(way, light)                                                           \
    }

const struct rb_kernels TABLE[RB_EMBREE_WAY_COUNT][2] = {
    [RB_EMBREE_SINGLE] = SETS(single),
    [RB_EMBREE_PACKET] = SETS(packet),
    [RB_EMBREE_PACKET_COHERENT] = SETS(packet_coherent),
    [RB_EMBREE_STREAM] = SETS(stream),
    [RB_EMBREE_STREAM_COHERENT] = SETS(stream_coherent),
};
