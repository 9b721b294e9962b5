#include "render/image.h"

#include <string.h>

#if RB_PNG
#include <png.h>
#endif

struct rb_image_format {
    const char *ending;
    bool (*write)(FILE *stream, float *pixels, int width, int height);
};

static unsigned char quantize(float value)
{
    float scaled = value * 255.0f + 0.5f;
    if (!(scaled >= 0.0f))
        return 0;
    return scaled >= 255.0f ? 255 : (unsigned char)scaled;
}

// In place: a byte never overtakes the float it is made from.
static unsigned char *quantize_all(float *pixels, int width, int height)
{
    size_t count = 3 * (size_t)width * (size_t)height;
    unsigned char *bytes = (unsigned char *)pixels;
    for (size_t i = 0; i < count; i++) {
        unsigned char byte = quantize(pixels[i]);
        memcpy(bytes + i, &byte, 1);
    }
    return bytes;
}

static bool write_ppm(FILE *stream, float *pixels, int width, int height)
{
    unsigned char *bytes = quantize_all(pixels, width, height);
    fprintf(stream, "P6\n%d %d\n255\n", width, height);
    fwrite(bytes, 3 * (size_t)width, (size_t)height, stream);
    return true;
}

// Rows from the bottom; the sign of the scale tells the byte order, negative is little-endian.
static bool write_pfm(FILE *stream, float *pixels, int width, int height)
{
    const union {
        unsigned short word;
        unsigned char bytes[2];
    } order = {1};
    fprintf(stream, "PF\n%d %d\n%s\n", width, height, order.bytes[0] ? "-1.0" : "1.0");
    for (int y = height - 1; y >= 0; y--)
        fwrite(pixels + 3 * (size_t)y * (size_t)width, 3 * sizeof *pixels, (size_t)width, stream);
    return true;
}

#if RB_PNG
static bool write_png(FILE *stream, float *pixels, int width, int height)
{
    png_image image = {
        .version = PNG_IMAGE_VERSION,
        .width = (png_uint_32)width,
        .height = (png_uint_32)height,
        .format = PNG_FORMAT_RGB,
    };
    return png_image_write_to_stdio(&image, stream, 0, quantize_all(pixels, width, height), 0,
                                    NULL);
}
#endif

static const struct rb_image_format formats[] = {
    {".ppm", write_ppm},
    {".pfm", write_pfm},
#if RB_PNG
    {".png", write_png},
#else
    {".png", NULL},
#endif
};

const struct rb_image_format *rb_image_format_of(const char *path, struct rb_error *error)
{
    if (strcmp(path, "-") == 0)
        return &formats[0];
    size_t length = strlen(path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        size_t ending = strlen(formats[i].ending);
        if (length <= ending || strcmp(path + length - ending, formats[i].ending) != 0)
            continue;
        if (formats[i].write)
            return &formats[i];
        rb_error_set(error, RB_INVALID,
                     "this build cannot write %s: install libpng-dev and build again, or use .ppm",
                     path);
        return NULL;
    }
    rb_error_set(error, RB_INVALID, "%s: the name of an image must end in .ppm, .pfm or .png",
                 path);
    return NULL;
}

bool rb_image_write(const struct rb_image_format *format, FILE *stream, float *pixels, int width,
                    int height)
{
    return format->write(stream, pixels, width, height) || ferror(stream);
}
