// What a render chooses, beside the scene. Zero means default everywhere.
#ifndef RB_RENDER_SETTINGS_H
#define RB_RENDER_SETTINGS_H

#include "base/status.h"
#include "kernels/kernel.h"

#include <stdbool.h>
#include <stdint.h>

struct rb_settings {
    int width, height;  // pixels; default: the scene's resolution
    int depth;          // levels of the ray tree, 1 to RB_DEPTH_MAX; default 5
    int aa;             // samples per pixel edge, stratified; default 1, the pixel centre
    int light_samples;  // shadow rays per light, stratified; default 1
    double light_size;  // edge of the square light, world units; default 0, a point
    double light_scale; // multiplies every light; default 1 / sqrt(number of lights)
    double ambient;     // times Kd times colour is added to every hit; default 0
    bool phong;         // R.V instead of N.H
    bool spd;           // SPD's test rules: rays at pixel corners, one-sided opaque surfaces
    uint64_t seed;      // of all random numbers; default 0
    int tile;           // edge in pixels, a multiple of 16 up to 256; default 64
    int threads;        // default: as many as OpenMP would use. Serial rows use one.
};

enum { RB_TILE_DEFAULT = 64, RB_TILE_MAX = 256, RB_DEPTH_DEFAULT = 5, RB_AA_MAX = 64 };
enum { RB_LIGHT_SAMPLES_MAX = 4096, RB_THREADS_MAX = 1024, RB_SIZE_MAX = 65536 };

// Fills in the defaults; RB_INVALID with a text where a value is out of range.
enum rb_status rb_settings_complete(struct rb_settings *settings, const struct rb_scene *scene,
                                    struct rb_error *error);

// The camera of `scene` at these (complete) settings.
struct rb_view rb_view_make(const struct rb_scene *scene, const struct rb_settings *settings);

struct rb_shading rb_shading_make(const struct rb_scene *scene, const struct rb_settings *settings);

#endif
