// What a kernel set is: the queues between the pipeline's stages and the functions that fill them.
//
// generate -> [ trace -> surface -> light -> trace_shadow ] per bounce. `surface` and `light` are
// the two halves of the kernel the tables call `shade`. Queues are structures of arrays. Kernels
// return nothing, never allocate, fail, print or read a clock, and keep no state: one kernel set
// serves any number of threads, each with queues of its own.
//
// All kernel sets compute the same results bit for bit; intersect.h and shade.h hold the normative
// formulas. Distances are world units; directions are unit vectors up to rounding.
#ifndef RB_KERNELS_KERNEL_H
#define RB_KERNELS_KERNEL_H

#include "scene/scene.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rb_bvh;
struct rb_wide;
struct rb_embree;

// Arrays of all queues are rounded up to this many elements, the widest SIMD register there is in
// single precision, so that a kernel may read and write whole registers.
enum { RB_LANES_MAX = 16 };

// Deepest --depth. A path index needs one bit per bounce and must fit 32 bits.
enum { RB_DEPTH_MAX = 32 };

// Rays that look for their closest hit.
struct rb_rays {
    float *ox, *oy, *oz; // origin
    float *dx, *dy, *dz; // direction
    float *weight;       // what the colour found is multiplied by in its pixel
    uint32_t *pixel;     // y * width + x
    uint32_t *path;      // 1 for a camera ray; 2p reflects and 2p + 1 refracts path p
    uint32_t *self;      // primitive the ray starts on, or RB_NONE
    uint64_t *media;     // stack of the media entered, 16 bits each, innermost lowest; 0 = outside
    uint32_t count, capacity;
};

// Closest hits of a ray queue, same indices.
struct rb_hits {
    float *t;       // distance; infinite for a miss
    float *u, *v;   // barycentric coordinates on a triangle, else 0
    uint32_t *prim; // RB_NONE for a miss
};

// Hit points ready to be lit, compacted: misses have none.
struct rb_surfaces {
    float *px, *py, *pz; // point, on the viewer's side of the surface
    float *nx, *ny, *nz; // unit shading normal, turned towards the viewer
    float *vx, *vy, *vz; // unit vector to the viewer
    float *weight;       // of the ray
    uint32_t *pixel, *path, *prim, *material;
    uint8_t *inside; // 1 if the ray met the surface from behind
    uint32_t count, capacity;
};

// Shadow rays from surface points to points on lights, with what the light adds if nothing is in
// between. Rays of one light follow each other.
struct rb_shadows {
    float *ox, *oy, *oz;
    float *dx, *dy, *dz;
    float *distance;  // to the light
    float *r, *g, *b; // unoccluded contribution to the pixel
    uint32_t *pixel;
    uint32_t *self;    // primitive the ray starts on
    uint8_t *occluded; // the answer of trace_shadow: 1 if something is in between
    uint32_t count, capacity;
};

// 64-bit fixed-point sums, three per pixel, so that the order of additions cannot matter.
struct rb_film {
    uint64_t *rgb; // 3 * width * height, two's complement, RB_FILM_ONE units each
    int width, height;
    float limit; // largest contribution
};

// Affine camera: the direction through image position (x, y) is corner + x right + y down,
// normalised. (0, 0) is the outer top left corner of the image, pixel centres are at half integers.
struct rb_view {
    float from[3];
    float corner[3], right[3], down[3];
    int width, height;
    uint32_t aa;  // samples per pixel edge; 1 = one ray through the pixel centre
    float center; // where in the pixel the only sample lies: 0.5
    uint64_t seed;
};

// Pixels of a tile that one batch covers: [x0, x1) x [y0, y1), walked in blocks of RB_BLOCK pixels
// squared, these in cells of RB_CELL pixels squared, row by row inside a cell: whatever the width
// of vectors, neighbours in a queue are neighbours in the image. One AA sample of each pixel.
enum { RB_BLOCK = 16, RB_CELL = 4 };
struct rb_span {
    int x0, y0, x1, y1;
    uint32_t sample;
};

// Which shadow rays a light kernel makes: towards sample `sample` of light `light`, for AA sample
// `pixel_sample`.
struct rb_light_sample {
    uint32_t light, sample, pixel_sample;
};

// How surfaces look: everything a render chooses about shading.
struct rb_shading {
    float light_scale; // multiplies every light
    float ambient;
    float light_edge;
    uint32_t light_samples, strata_x, strata_y; // strata_x * strata_y == light_samples
    bool phong;                                 // R.V instead of Blinn's N.H
    uint64_t seed;
    float at[3]; // soft lights face this point
};

// What rays are traced in. Of `bvh`, `wide` and `embree` one is what the row's accelerator built,
// if any; the others are NULL.
struct rb_world {
    const struct rb_scene *scene;
    const struct rb_bvh *bvh;
    const struct rb_wide *wide;
    const struct rb_embree *embree;
    bool one_sided; // opaque surfaces are hit from their front only (SPD's rule)
};

// Appends the camera rays of `span` to `out`, which has room for them.
typedef void rb_generate_fn(const struct rb_view *view, const struct rb_span *span,
                            struct rb_rays *out);

// Closest hit of every ray; ties go to the lowest primitive id. A ray with a component that is not
// finite misses.
typedef void rb_trace_fn(const struct rb_world *world, const struct rb_rays *rays,
                         struct rb_hits *hits);

// From hits to surface points; adds background and ambient light to the film. Where `reflected` and
// `refracted` are not NULL (below the depth limit), appends the secondary rays in the order of the
// hits. All outputs have room for one element per ray.
typedef void rb_surface_fn(const struct rb_world *world, const struct rb_shading *shading,
                           const struct rb_rays *rays, const struct rb_hits *hits,
                           struct rb_surfaces *surfaces, struct rb_rays *reflected,
                           struct rb_rays *refracted, struct rb_film *film);

// Appends one shadow ray for every surface point that faces this light sample and is not in the
// shadow of its own primitive.
typedef void rb_light_fn(const struct rb_world *world, const struct rb_shading *shading,
                         const struct rb_surfaces *surfaces, const struct rb_light_sample *sample,
                         struct rb_shadows *shadows);

// Decides `occluded` for every shadow ray; its own primitive does not exist for it. A ray with a
// component that is not finite is not occluded.
typedef void rb_trace_shadow_fn(const struct rb_world *world, struct rb_shadows *shadows);

struct rb_kernels {
    rb_generate_fn *generate;
    rb_trace_fn *trace;
    rb_surface_fn *surface;
    rb_light_fn *light;
    rb_trace_shadow_fn *trace_shadow;
};

// Every file of kernels is compiled a second time, with -DRB_COUNTING (count.h). What it exports
// then is called NAME_counted, so that both fit one program; RB_TWIN(NAME) is the one that belongs
// to the file at hand.
#ifdef RB_COUNTING
#define RB_TWIN(name)  RB_TWIN_(name)
#define RB_TWIN_(name) name##_counted
#else
#define RB_TWIN(name) name
#endif

// The kernel sets, one per file, and their twins.
#define RB_KERNEL_SET(name) extern const struct rb_kernels name, name##_counted
RB_KERNEL_SET(rb_kernels_naive);
RB_KERNEL_SET(rb_kernels_bvh);
RB_KERNEL_SET(rb_kernels_frustum_sse2);
RB_KERNEL_SET(rb_kernels_frustum_avx2);
RB_KERNEL_SET(rb_kernels_frustum_avx512);
RB_KERNEL_SET(rb_kernels_frustum_neon);
RB_KERNEL_SET(rb_kernels_packet_sse2); // one source, an object per instruction set;
RB_KERNEL_SET(rb_kernels_packet_avx2); // those of other processors are not linked
RB_KERNEL_SET(rb_kernels_packet_avx512);
RB_KERNEL_SET(rb_kernels_packet_neon);
RB_KERNEL_SET(rb_kernels_wide_sse2);
RB_KERNEL_SET(rb_kernels_wide_avx2);
RB_KERNEL_SET(rb_kernels_wide_neon);
RB_KERNEL_SET(rb_kernels_stream_sse2);
RB_KERNEL_SET(rb_kernels_stream_avx2);
RB_KERNEL_SET(rb_kernels_stream_neon);

// The scalar bodies that sets without a better one share (scalar.c).
rb_generate_fn rb_scalar_generate, rb_scalar_generate_counted;
rb_surface_fn rb_scalar_surface, rb_scalar_surface_counted;
rb_light_fn rb_scalar_light, rb_scalar_light_counted;

// Fixed point: 2^32 units are 1.0, so sums hold values up to 2^31 with a resolution of 2.3e-10, a
// 17 millionth of one step of an 8-bit image. A contribution is cut off at 2^25 over the number of
// AA samples: 64 that large fit in every sample of a pixel. NaN counts as nothing.
#define RB_FILM_ONE   0x1p32f
#define RB_FILM_RANGE 0x1p25f

static inline uint64_t rb_film_fixed(float value, float limit)
{
    float limited = fabsf(value) <= limit ? value : copysignf(limit, value);
    return value == value ? (uint64_t)(int64_t)(limited * RB_FILM_ONE) : 0;
}

static inline void rb_film_add(struct rb_film *film, uint32_t pixel, float r, float g, float b)
{
    uint64_t *sum = film->rgb + (size_t)pixel * 3;
    sum[0] += rb_film_fixed(r, film->limit);
    sum[1] += rb_film_fixed(g, film->limit);
    sum[2] += rb_film_fixed(b, film->limit);
}

static inline void rb_film_add_scaled(struct rb_film *film, uint32_t pixel, float weight,
                                      const float color[3])
{
    rb_film_add(film, pixel, weight * color[0], weight * color[1], weight * color[2]);
}

#endif
