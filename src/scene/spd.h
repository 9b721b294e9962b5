// What the generators of the Standard Procedural Databases share. Private to src/scene.
//
// Conventions of the original: vectors are rows (v' = v M), numbers are written with "%g", and a
// rotation by a positive angle turns x towards y. The order of every sum is part of the contract:
// it decides the last digit of the text.
#ifndef RB_SCENE_SPD_H
#define RB_SCENE_SPD_H

#include "scene/generate.h"

#define RB_SPD_PI 3.141592653589793

// Checks `size` against the table (RB_INVALID with a text).
enum rb_status rb_spd_begin(const char *generator, int size, struct rb_error *error);

// Flushes `out` and reports whether everything was written since rb_spd_begin (RB_FAILED).
enum rb_status rb_spd_end(FILE *out, struct rb_error *error);

// Rotation by `angle` radians about a unit vector.
void rb_spd_rotation(double matrix[3][3], const double axis[3], double angle);

// result = v matrix; the two may not overlap.
void rb_spd_transform(double result[3], const double v[3], double matrix[3][3]);

enum { RB_SPD_POINT_ROOM = 64 };

// Appends "x y z" at `out`, at most RB_SPD_POINT_ROOM bytes; returns the end.
char *rb_spd_format_point(char *out, const double point[3]);

void rb_spd_write_sphere(FILE *out, const double center[3], double radius);

enum rb_status rb_balls_write(FILE *out, int size, enum rb_dialect dialect, struct rb_error *error);
double rb_balls_count(int size);

enum rb_status rb_mount_write(FILE *out, int size, enum rb_dialect dialect, struct rb_error *error);
double rb_mount_count(int size);

#endif
