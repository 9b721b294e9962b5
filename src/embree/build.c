// Embree's tree over a scene. Triangles are copied, as Embree wants to read beyond the last one;
// its leaves hold copies of their own, so neither is read while tracing. Spheres are read where the
// scene has them.
#include "embree/tree.h"

#include "base/memory.h"
#include "measure/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Rays that leave a primitive start this far ahead, times the largest coordinate of the scene.
// At 2^-17 at most 0.013 % of the rays of a class of the scenes for speed are answered otherwise
// than the norm has it, shadow rays from the light apart.
static const float EPSILON = 0x1p-17f;

const char *rb_embree_version(void)
{
    return RTC_VERSION_STRING;
}

static bool count_bytes(void *user, ssize_t bytes, bool post)
{
    struct rb_embree *embree = user;
    (void)post;
    atomic_fetch_add(&embree->bytes, bytes);
    return true;
}

static void sphere_bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const struct rb_scene *scene = arguments->geometryUserPtr;
    struct RTCBounds *box = arguments->bounds_o;
    float low[3], high[3];
    rb_sphere_bounds(&scene->spheres[arguments->primID], low, high);
    box->lower_x = low[0], box->lower_y = low[1], box->lower_z = low[2];
    box->upper_x = high[0], box->upper_y = high[1], box->upper_z = high[2];
}

static void cone_bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const struct rb_scene *scene = arguments->geometryUserPtr;
    const struct rb_cone *cone = &scene->cones[arguments->primID];
    struct RTCBounds *box = arguments->bounds_o;
    box->lower_x = cone->low[0], box->lower_y = cone->low[1], box->lower_z = cone->low[2];
    box->upper_x = cone->high[0], box->upper_y = cone->high[1], box->upper_z = cone->high[2];
}

static RTCGeometry make_user(struct rb_embree *embree, uint32_t count, RTCBoundsFunction bounds,
                             RTCIntersectFunctionN intersect, RTCOccludedFunctionN occluded)
{
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, count);
    rtcSetGeometryUserData(geometry, (void *)(uintptr_t)embree->source);
    rtcSetGeometryBoundsFunction(geometry, bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occluded);
    return geometry;
}

static RTCGeometry make_points(struct rb_embree *embree)
{
    const struct rb_scene *scene = embree->source;
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               scene->spheres, 0, sizeof *scene->spheres, scene->count[RB_SPHERE]);
    rtcSetGeometryOccludedFilterFunction(geometry, rb_embree_spheres_filter);
    return geometry;
}

static RTCGeometry make_triangles(struct rb_embree *embree)
{
    const struct rb_scene *scene = embree->source;
    size_t count = scene->count[RB_TRIANGLE];
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                              RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * count);
    uint32_t *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), count);
    if (!vertices || !indices)
        return geometry; // the device knows the error
    memcpy(vertices, scene->triangles, count * sizeof *scene->triangles);
    for (uint32_t i = 0; i < 3 * count; i++)
        indices[i] = i;
    return geometry;
}

static void attach(struct rb_embree *embree, RTCGeometry geometry, enum rb_kind kind)
{
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree->scene, geometry, (unsigned)kind);
    rtcReleaseGeometry(geometry);
}

static void attach_all(struct rb_embree *embree, bool native)
{
    const uint32_t *count = embree->source->count;
    if (count[RB_SPHERE])
        attach(embree,
               native ? make_points(embree)
                      : make_user(embree, count[RB_SPHERE], sphere_bounds,
                                  rb_embree_spheres_intersect, rb_embree_spheres_occluded),
               RB_SPHERE);
    if (count[RB_TRIANGLE])
        attach(embree, make_triangles(embree), RB_TRIANGLE);
    if (count[RB_CONE])
        attach(embree,
               make_user(embree, count[RB_CONE], cone_bounds, rb_embree_cones_intersect,
                         rb_embree_cones_occluded),
               RB_CONE);
}

static float largest_coordinate(RTCScene scene)
{
    struct RTCBounds box;
    rtcGetSceneBounds(scene, &box);
    float reach = fmaxf(fmaxf(fabsf(box.lower_x), fabsf(box.upper_x)),
                        fmaxf(fabsf(box.lower_y), fabsf(box.upper_y)));
    reach = fmaxf(reach, fmaxf(fabsf(box.lower_z), fabsf(box.upper_z)));
    return isfinite(reach) ? reach : 0.0f; // an empty scene has an empty box
}

static void commit(struct rb_embree *embree, const struct rb_embree_tree *how,
                   struct rb_embree_cost *cost)
{
    attach_all(embree, how->native);
    rtcSetSceneBuildQuality(embree->scene,
                            how->high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    long long before = atomic_load(&embree->bytes);
    uint64_t start_ns = rb_clock_ns();
    rtcCommitScene(embree->scene);
    cost->build_ns = rb_clock_ns() - start_ns;
    cost->bytes = (size_t)(atomic_load(&embree->bytes) - before) +
                  embree->source->count[RB_SPHERE] * sizeof *embree->source->spheres +
                  embree->source->count[RB_CONE] * sizeof *embree->source->cones;
    embree->epsilon = EPSILON * largest_coordinate(embree->scene);
}

enum rb_status rb_embree_build(const struct rb_scene *scene, const struct rb_embree_tree *how,
                               int threads, struct rb_embree **embree, struct rb_embree_cost *cost,
                               struct rb_error *error)
{
    char config[64];
    *embree = NULL;
    struct rb_embree *made = rb_alloc(1, sizeof *made);
    if (!made)
        return rb_error_memory(error, "Embree's tree");
    snprintf(config, sizeof config, "threads=%d%s%s", threads, how->isa ? ",max_isa=" : "",
             how->isa ? how->isa : "");
    made->source = scene;
    made->device = rtcNewDevice(config);
    if (made->device) {
        rtcSetDeviceMemoryMonitorFunction(made->device, count_bytes, made);
        made->scene = rtcNewScene(made->device);
        commit(made, how, cost);
    }
    enum RTCError code = rtcGetDeviceError(made->device);
    if (code != RTC_ERROR_NONE) {
        rb_embree_free(made);
        return rb_error_set(error, RB_FAILED, "Embree cannot build its tree: error %d%s", (int)code,
                            code == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : "");
    }
    *embree = made;
    return RB_OK;
}

void rb_embree_free(struct rb_embree *embree)
{
    if (!embree)
        return;
    if (embree->scene)
        rtcReleaseScene(embree->scene);
    if (embree->device)
        rtcReleaseDevice(embree->device);
    rb_free(embree);
}
