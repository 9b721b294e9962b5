// Finds the scene a name stands for. Generated scenes go through text, so that a name and the file
// it would make give the same scene to the last bit.
#define _POSIX_C_SOURCE 200809L
#include "scene/load.h"

#include "base/fpenv.h"
#include "scene/generate.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static enum rb_status fail(enum rb_status status, const char *name, const char *what, int cause,
                           struct rb_error *error)
{
    if (error) {
        *error = (struct rb_error){0};
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, name);
    }
    return rb_error_set(error, status, "cannot %s: %s", what, strerror(cause));
}

// The generator's text, to be released with free(). It is made in the default floating-point
// environment, on which its last digits depend.
static enum rb_status generate(const struct rb_generator *generator, int size, const char *name,
                               char **text, size_t *length, struct rb_error *error)
{
    *text = NULL;
    FILE *stream = open_memstream(text, length);
    if (!stream)
        return fail(RB_FAILED, name, "generate the scene", errno, error);
    fenv_t saved;
    rb_fpenv_enter(&saved);
    enum rb_status status = generator->write(stream, size, RB_DIALECT_P3D, error);
    rb_fpenv_leave(&saved);
    if (status != RB_OK && error)
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, name);
    if (fclose(stream) != 0 && status == RB_OK)
        status = fail(RB_FAILED, name, "generate the scene", errno, error);
    return status;
}

static enum rb_status load_generated(const struct rb_generator *generator, int size,
                                     const char *name, const struct rb_nff_options *options,
                                     struct rb_scene *scene, struct rb_error *error)
{
    char *text;
    size_t length;
    enum rb_status status = generate(generator, size, name, &text, &length, error);
    if (status == RB_OK) {
        FILE *stream = fmemopen(text, length, "rb");
        if (stream) {
            status = rb_nff_read(stream, name, options, scene, error);
            fclose(stream);
        } else {
            status = fail(RB_FAILED, name, "read the generated scene", errno, error);
        }
    }
    free(text);
    return status;
}

static enum rb_status load_file(const char *name, const struct rb_nff_options *options,
                                struct rb_scene *scene, struct rb_error *error)
{
    FILE *stream = fopen(name, "rb");
    if (!stream) {
        int cause = errno;
        bool ours = cause == ENOMEM || cause == EMFILE || cause == ENFILE;
        enum rb_status status = fail(ours ? RB_FAILED : RB_INVALID, name, "open", cause, error);
        if (cause == ENOENT && !strchr(name, '/'))
            rb_error_set(error, status,
                         "no such file, and no scene goes by that name ('raybench list scenes' "
                         "names them)");
        return status;
    }
    enum rb_status status = rb_nff_read(stream, name, options, scene, error);
    fclose(stream);
    return status;
}

enum rb_status rb_scene_load(const char *name, const struct rb_nff_options *options,
                             struct rb_scene *scene, struct rb_error *error)
{
    const struct rb_generator *generator;
    int size;
    *scene = (struct rb_scene){0};
    if (rb_scene_name_parse(name, &generator, &size))
        return load_generated(generator, size, name, options, scene, error);
    if (strcmp(name, "-") == 0)
        return rb_nff_read(stdin, name, options, scene, error);
    return load_file(name, options, scene, error);
}
