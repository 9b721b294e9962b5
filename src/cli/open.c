#include "cli/commands.h"

#include "scene/load.h"

#include <stdio.h>

int rb_report(enum rb_status status, const struct rb_error *error)
{
    fprintf(stderr, "raybench: ");
    if (error->file[0] && error->line)
        fprintf(stderr, "%s:%lu:%lu: ", error->file, error->line, error->column);
    else if (error->file[0])
        fprintf(stderr, "%s: ", error->file);
    fprintf(stderr, "%s\n", error->text);
    return (int)status;
}

static void warn(void *user, const struct rb_error *warning)
{
    const struct rb_arguments *arguments = user;
    struct rb_error copy = *warning;
    if (arguments->quiet)
        return;
    snprintf(copy.text, sizeof copy.text, "warning: %.360s", warning->text);
    rb_report(RB_OK, &copy);
}

int rb_open_scene(const char *name, const struct rb_arguments *arguments, struct rb_scene *scene)
{
    struct rb_error error = {0};
    struct rb_nff_options options = {
        .strict = arguments->strict,
        .warn = warn,
        .user = (void *)arguments,
    };
    enum rb_status status = rb_scene_load(name, &options, scene, &error);
    return status ? rb_report(status, &error) : 0;
}

const struct rb_variant *rb_open_variant(const struct rb_arguments *arguments)
{
    if (!arguments->variant)
        return rb_variant_fastest();
    const struct rb_variant *variant = rb_variant_find(arguments->variant);
    if (!variant)
        fprintf(stderr, "raybench: there is no variant '%s'; see raybench list variants\n",
                arguments->variant);
    return variant;
}

static void warn_ineffective(const struct rb_arguments *arguments, const struct rb_variant *variant)
{
    if (arguments->quiet)
        return;
    if (arguments->settings.threads > 1 && !rb_variant_parallel(variant))
        fprintf(stderr, "raybench: warning: %s is serial and uses one thread; try %s+omp\n",
                variant->name, variant->name);
    if (arguments->settings.light_samples > 1 && arguments->settings.light_size == 0)
        fprintf(stderr, "raybench: warning: --light-samples without --light-size repeats the same "
                        "shadow ray\n");
}

int rb_open_renderer(const struct rb_arguments *arguments, struct rb_scene *scene,
                     struct rb_renderer **renderer)
{
    const struct rb_variant *variant = rb_open_variant(arguments);
    if (!variant)
        return RB_INVALID;
    warn_ineffective(arguments, variant);
    int code = rb_open_scene(arguments->positional[0], arguments, scene);
    if (code)
        return code;
    struct rb_error error = {0};
    enum rb_status status =
        rb_renderer_create(scene, variant, &arguments->settings, renderer, &error);
    if (status)
        rb_scene_free(scene);
    return status ? rb_report(status, &error) : 0;
}
