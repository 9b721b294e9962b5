// The scene model: what an NFF file says, in the form the kernels read.
//
// A scene is built once (by the reader or a test), sealed by rb_scene_finish, and read-only from
// then on: any number of threads may read it. All lengths are world units.
//
// Every primitive has an id. Ids run over the spheres first, then the triangles, the cones and the
// planes; within a type they follow the order of the file. The id is what breaks ties between hits
// at equal distance (lowest wins) and what a secondary ray excludes.
#ifndef RB_SCENE_SCENE_H
#define RB_SCENE_SCENE_H

#include "base/memory.h"
#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

#define RB_NONE UINT32_MAX // "no primitive"

// Largest coordinate or radius a scene may hold. Triple products of such numbers (1e36) still fit
// single precision, so no kernel can overflow.
#define RB_COORDINATE_MAX 1e12

enum rb_kind { RB_SPHERE, RB_TRIANGLE, RB_CONE, RB_PLANE, RB_KIND_COUNT };

struct rb_camera {
    double from[3], at[3], up[3];
    double angle_deg; // between the outer edges of the image height
    double hither;    // read and kept, not used
    int width, height;
};

struct rb_light {
    float position[3];
    float color[3];
};

struct rb_material {
    float color[3];
    float kd, ks, shine; // diffuse, specular and mirror, Phong exponent
    float t, ior;        // transmittance; index of refraction, meaningful only where t > 0
    uint16_t medium;     // index into rb_scene.media; 0 (outside) where t == 0
};

struct rb_sphere {
    float center[3];
    float radius; // negative: visible from inside only; never 0
};

struct rb_triangle {
    float v[3][3]; // counter-clockwise seen from the front
};

// Open frustum of a cone, or a cylinder. The stored axis, height and slope are derived from base,
// apex and radii in double precision; the kernels use the stored values only.
struct rb_cone {
    float base[3], base_radius; // radii are >= 0 here
    float axis[3], height;      // unit vector from base to apex
    float slope;                // d radius / d height
    float inside;               // 1: visible from inside only (both radii were negative); else 0
    float low[3], high[3];      // bounding box
    float center[3];            // of the box, or the small end; the solver measures from near here
};

struct rb_plane {
    float normal[3]; // unit
    float distance;  // normal . p for every p on the plane
};

struct rb_scene {
    struct rb_camera camera;
    float background[3];

    struct rb_light *lights;
    struct rb_material *materials;
    float *media; // distinct indices of refraction; media[0] = 1.0 is the outside
    uint32_t light_count, material_count, media_count;

    struct rb_sphere *spheres;
    struct rb_triangle *triangles;
    float (*triangle_normals)[3];  // unit geometric normals, one per triangle
    uint32_t *triangle_smooth;     // index into smooth_normals or RB_NONE; NULL if none is smooth
    float (*smooth_normals)[3][3]; // one unit normal per vertex
    struct rb_cone *cones;
    struct rb_plane *planes;
    uint32_t count[RB_KIND_COUNT]; // primitives of each kind
    uint32_t first[RB_KIND_COUNT]; // id of the first primitive of each kind
    uint32_t primitive_count;
    uint32_t bounded_count; // all but the planes: ids below this have a bounding box

    uint32_t *material_of; // by primitive id
    uint64_t hash;         // of everything above: two scenes with equal hashes render alike
    size_t bytes;          // memory held

    void *storage[12]; // owned arrays, released by rb_scene_free
};

// Under construction: one growing array per kind. Zero-initialise, add, then rb_scene_finish.
struct rb_scene_builder {
    struct rb_camera camera;
    float background[3];
    struct rb_array lights, materials, media;
    struct rb_array primitives[RB_KIND_COUNT];
    struct rb_array primitive_materials[RB_KIND_COUNT];
    struct rb_array triangle_normals, triangle_smooth, smooth_normals;
    size_t degenerate_count; // primitives dropped because they have no extent
};

// Each rb_scene_add_* appends one thing in double precision; objects take the latest material.
// They return RB_FAILED without memory, and RB_INVALID with error->text set for values no scene may
// hold (coordinates beyond RB_COORDINATE_MAX, non-unit counts, negative Shine ...).
enum rb_status rb_scene_add_light(struct rb_scene_builder *, const double position[3],
                                  const double color[3], struct rb_error *);
enum rb_status rb_scene_add_material(struct rb_scene_builder *, const double color[3], double kd,
                                     double ks, double shine, double t, double ior,
                                     struct rb_error *);
enum rb_status rb_scene_add_sphere(struct rb_scene_builder *, const double center[3], double radius,
                                   struct rb_error *);
// `normals` is NULL for a flat triangle, else three vectors of non-zero length. A triangle without
// area is dropped and counted.
enum rb_status rb_scene_add_triangle(struct rb_scene_builder *, const double v[3][3],
                                     const double (*normals)[3], struct rb_error *);
enum rb_status rb_scene_add_cone(struct rb_scene_builder *, const double base[3],
                                 double base_radius, const double apex[3], double apex_radius,
                                 struct rb_error *);
// Through three points; the front is where they run counter-clockwise.
enum rb_status rb_scene_add_plane(struct rb_scene_builder *, const double p[3][3],
                                  struct rb_error *);

// RB_INVALID with a text for a camera that can see nothing: from equal to at, up parallel to the
// view or zero, angle outside (0, 180), a side of the image outside 1 .. 65536, over 2^28 pixels.
enum rb_status rb_scene_check_camera(const struct rb_camera *, struct rb_error *);

// Checks the camera (RB_INVALID with a text), moves everything out of the builder into `scene` and
// seals it. The builder is empty afterwards, whatever the outcome. Release with rb_scene_free.
enum rb_status rb_scene_finish(struct rb_scene_builder *, struct rb_scene *scene,
                               struct rb_error *);
void rb_scene_builder_release(struct rb_scene_builder *);
void rb_scene_free(struct rb_scene *);

// Which kind a primitive id is of.
static inline enum rb_kind rb_scene_kind(const struct rb_scene *scene, uint32_t id)
{
    if (id < scene->first[RB_TRIANGLE])
        return RB_SPHERE;
    if (id < scene->first[RB_CONE])
        return RB_TRIANGLE;
    return id < scene->first[RB_PLANE] ? RB_CONE : RB_PLANE;
}

// Bounding boxes, a function of the stored data alone. A hit counts only if the ray passes this
// very box (kernels/intersect.h), and trees are built over it. A cone stores its box.
static inline void rb_sphere_bounds(const struct rb_sphere *sphere, float low[3], float high[3])
{
    float r = sphere->radius < 0.0f ? -sphere->radius : sphere->radius;
    for (int k = 0; k < 3; k++) {
        low[k] = sphere->center[k] - r;
        high[k] = sphere->center[k] + r;
    }
}

static inline void rb_triangle_bounds(const struct rb_triangle *triangle, float low[3],
                                      float high[3])
{
    for (int k = 0; k < 3; k++) {
        float a = triangle->v[0][k], b = triangle->v[1][k], c = triangle->v[2][k];
        float ab_low = a < b ? a : b, ab_high = a > b ? a : b;
        low[k] = ab_low < c ? ab_low : c;
        high[k] = ab_high > c ? ab_high : c;
    }
}

// Any bounded primitive, by id.
void rb_scene_bounds(const struct rb_scene *scene, uint32_t id, float low[3], float high[3]);

#endif
