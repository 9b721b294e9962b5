#define _POSIX_C_SOURCE 200809L
#include "scene/load.h"

#include "base/fpenv.h"
#include "scene/generate.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static enum rb_status fail(enum rb_status status, const char *name, const char *what,
                           struct rb_error *error)
{
    int cause = errno;
    if (error)
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, name);
    return rb_error_set(error, status, "cannot %s: %s", what, strerror(cause));
}

// Through text, so that a name and the file it would make give the same scene to the last bit.
static enum rb_status load_generated(const struct rb_generator *generator, int size,
                                     const char *name, const struct rb_nff_options *options,
                                     struct rb_scene *scene, struct rb_error *error)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (!stream)
        return fail(RB_FAILED, name, "generate", error);
    enum rb_status status = generator->write(stream, size, RB_DIALECT_P3D, error);
    if (fclose(stream) != 0 && status == RB_OK)
        status = fail(RB_FAILED, name, "generate", error);
    if (status == RB_OK) {
        stream = fmemopen(text, length, "rb");
        status = stream ? rb_nff_read(stream, name, options, scene, error)
                        : fail(RB_FAILED, name, "generate", error);
        if (stream)
            fclose(stream);
    }
    free(text);
    return status;
}

enum rb_status rb_scene_load(const char *name, const struct rb_nff_options *options,
                             struct rb_scene *scene, struct rb_error *error)
{
    const struct rb_generator *generator;
    int size;
    if (rb_scene_name_parse(name, &generator, &size))
        return load_generated(generator, size, name, options, scene, error);
    if (strcmp(name, "-") == 0)
        return rb_nff_read(stdin, "standard input", options, scene, error);
    FILE *stream = fopen(name, "rb");
    if (!stream)
        return fail(RB_INVALID, name, "open", error);
    enum rb_status status = rb_nff_read(stream, name, options, scene, error);
    fclose(stream);
    return status;
}
