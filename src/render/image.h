// Image files: PPM (P6, 8 bits), PFM (linear single precision) and, where libpng was found, PNG.
#ifndef RB_RENDER_IMAGE_H
#define RB_RENDER_IMAGE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

// The image formats by the ending of a file name. "-" stands for standard output, written as PPM.
struct rb_image_format;

// NULL with an error for an ending nobody knows or a format this build cannot write.
const struct rb_image_format *rb_image_format_of(const char *path, struct rb_error *error);

// Writes linear RGB pixels, rows from the top, to a stream; `pixels` may be overwritten in the
// course (so that no memory is needed). 8-bit formats hold value x 255, rounded and clamped,
// without gamma. Write errors show in the stream; false only if the encoder has no memory.
bool rb_image_write(const struct rb_image_format *format, FILE *stream, float *pixels, int width,
                    int height);

#endif
