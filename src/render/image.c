#include "render/image.h"

#include "base/file.h"
#include "base/memory.h"

#include <string.h>

#if RB_PNG
#include <png.h>
#endif

struct rb_image_format {
    const char *ending;
    // Writes the whole image; false without memory. Write errors show in the stream.
    bool (*write)(FILE *stream, const float *pixels, int width, int height);
};

static unsigned char quantize(float value)
{
    float scaled = value * 255.0f + 0.5f;
    if (!(scaled >= 0.0f))
        return 0;
    return scaled >= 255.0f ? 255 : (unsigned char)scaled;
}

static unsigned char *quantize_all(const float *pixels, int width, int height)
{
    size_t count = 3 * (size_t)width * (size_t)height;
    unsigned char *bytes = rb_alloc(count, 1);
    for (size_t i = 0; bytes && i < count; i++)
        bytes[i] = quantize(pixels[i]);
    return bytes;
}

static bool write_ppm(FILE *stream, const float *pixels, int width, int height)
{
    unsigned char *bytes = quantize_all(pixels, width, height);
    if (!bytes)
        return false;
    fprintf(stream, "P6\n%d %d\n255\n", width, height);
    fwrite(bytes, 3 * (size_t)width, (size_t)height, stream);
    rb_free(bytes);
    return true;
}

// Rows from the bottom; the sign of the scale tells the byte order, negative is little-endian.
static bool write_pfm(FILE *stream, const float *pixels, int width, int height)
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
static bool write_png(FILE *stream, const float *pixels, int width, int height)
{
    unsigned char *bytes = quantize_all(pixels, width, height);
    if (!bytes)
        return false;
    png_image image = {
        .version = PNG_IMAGE_VERSION,
        .width = (png_uint_32)width,
        .height = (png_uint_32)height,
        .format = PNG_FORMAT_RGB,
    };
    bool written = png_image_write_to_stdio(&image, stream, 0, bytes, 0, NULL);
    rb_free(bytes);
    return written || ferror(stream); // a failed write is reported with its errno
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

enum rb_status rb_image_write(const struct rb_image_format *format, const char *path,
                              const float *pixels, int width, int height, struct rb_error *error)
{
    struct rb_output output;
    enum rb_status status = rb_output_open(&output, path, error);
    if (status)
        return status;
    if (!format->write(output.stream, pixels, width, height)) {
        rb_output_discard(&output);
        return rb_error_memory(error, "the image file");
    }
    return rb_output_commit(&output, error);
}
