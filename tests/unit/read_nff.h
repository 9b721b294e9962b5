// Reads NFF from a string into `scene`, `error` and `warnings`, for the tests of the reader. The
// including file defines _POSIX_C_SOURCE, which fmemopen needs.
#ifndef TESTS_READ_NFF_H
#define TESTS_READ_NFF_H

#include "scene/nff.h"

#include <string.h>

// Seven lines; what follows begins at line 8.
#define VIEW "v\nfrom 2.1 1.3 1.7\nat 0 0 0\nup 0 0 1\nangle 45\nhither 0.01\nresolution 512 384\n"

static struct rb_scene scene;
static struct rb_error error;
static struct rb_error warnings[64];
static size_t warning_count;

static void keep_warning(void *user, const struct rb_error *warning)
{
    (void)user;
    if (warning_count < sizeof warnings / sizeof *warnings)
        warnings[warning_count] = *warning;
    warning_count++;
}

static enum rb_status read_bytes(const void *text, size_t length, bool strict)
{
    struct rb_nff_options options = {.strict = strict, .warn = keep_warning};
    FILE *stream = fmemopen((void *)(size_t)text, length, "rb");
    warning_count = 0;
    error = (struct rb_error){0};
    rb_scene_free(&scene);
    enum rb_status status = rb_nff_read(stream, "test.nff", &options, &scene, &error);
    fclose(stream);
    return status;
}

__attribute__((unused)) static enum rb_status read_text(const char *text)
{
    return read_bytes(text, strlen(text), false);
}

#endif
