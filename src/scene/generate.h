// The SPD generators `balls` (sphereflake) and `mount` (fractal mountain), written as NFF text, and
// the names scenes go by. SPD = Standard Procedural Databases (Eric Haines, 1987).
#ifndef RB_SCENE_GENERATE_H
#define RB_SCENE_GENERATE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

// The two dialects differ in materials, the floor and how lights are written; same geometry.
enum rb_dialect {
    RB_DIALECT_P3D, // the Lisbon course's files: infinite plane, coloured lights, ior 1.2
    RB_DIALECT_SPD, // as the original database writes it
};

struct rb_generator {
    const char *name;    // "balls"
    const char *summary; // one line for listings
    int size_min, size_max;
    enum rb_status (*write)(FILE *out, int size, enum rb_dialect dialect, struct rb_error *error);
    // Objects (spheres, polygons, planes) that size holds.
    double (*object_count)(int size);
};

// A name for one size of a generator: the six scenes of the 2019 report.
struct rb_preset {
    const char *name; // "balls_high"
    const char *generator;
    int size;
    double paper_s; // render time in Table 1 of the report
};

extern const struct rb_generator rb_generators[]; // ends with a NULL name
extern const struct rb_preset rb_presets[];       // ends with a NULL name

const struct rb_generator *rb_generator_find(const char *name);

// Resolves a preset ("balls_high") or a generator with a size ("balls6"). False if it is neither;
// a size the generator cannot make is reported by its write function.
bool rb_scene_name_parse(const char *name, const struct rb_generator **generator, int *size);

#endif
