#include "base/file.h"
#include "cli/commands.h"

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--size", "N", RB_OPTION_COUNT, offsetof(struct rb_arguments, size), 0, 0,
     "size of the scene, exponential in objects"},
    {"--dialect", "p3d|spd", RB_OPTION_DIALECT, offsetof(struct rb_arguments, dialect), 0, 0,
     "the course's files (default) or the original database's"},
    {"-o", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "file to write; default: standard output"},
    {.name = NULL},
};

const struct rb_command rb_command_scene = {
    .name = "scene",
    .summary = "generate a scene as an NFF file",
    .synopsis = "balls|mount --size N [--dialect p3d|spd] [-o FILE]",
    .text = "Generators of the Standard Procedural Databases (Eric Haines, 1987).\n\n"
            "  raybench scene balls --size 4 -o balls_high.nff\n"
            "  raybench scene mount --size 6 --dialect spd | raybench render - --spd --hash\n\n"
            "In the p3d dialect balls 1, 2, 4 and mount 1, 5, 7 are the six scenes of the 2019\n"
            "report. A preset name (balls_high) stands for its generator and size.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

static int run(const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    struct rb_output output;
    const char *name = arguments->positional[0];
    const struct rb_generator *generator = rb_generator_find(name);
    int size = arguments->size;
    if (!generator && !rb_scene_name_parse(name, &generator, &size)) {
        rb_error_set(&error, RB_INVALID, "there is no generator '%s'; see raybench list scenes",
                     name);
        return rb_report(RB_INVALID, &error);
    }
    if (rb_generator_find(name) && !arguments->size_given) {
        rb_error_set(&error, RB_INVALID, "%s needs --size N, from %d to %d", name,
                     generator->size_min, generator->size_max);
        return rb_report(RB_INVALID, &error);
    }
    enum rb_status status =
        rb_output_open(&output, arguments->output ? arguments->output : "-", &error);
    if (status == RB_OK) {
        status = generator->write(output.stream, size, arguments->dialect, &error);
        if (status)
            rb_output_discard(&output);
        else
            status = rb_output_commit(&output, &error);
    }
    return status ? rb_report(status, &error) : 0;
}
