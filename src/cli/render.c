#include "base/file.h"
#include "base/memory.h"
#include "cli/commands.h"
#include "cli/progress.h"
#include "render/image.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"-o", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "image to write: .ppm, .pfm (linear), .png; - writes a PPM to standard output"},
    {"--hash", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, hash), 0, 0,
     "print the hashes of the image and of all hits"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0,
     "no warnings, no progress, no summary"},
    {.name = NULL},
};

const struct rb_command rb_command_render = {
    .name = "render",
    .summary = "render a scene to an image",
    .synopsis = "SCENE [-o FILE] [options]",
    .text = RB_HELP_SCENE
    "\n\n"
    "  raybench render balls_high -o balls.png\n"
    "  raybench render mount_low -o soft.png --aa 3 --light-size 20 --light-samples 16\n"
    "  raybench render balls6 --variant bvh --hash\n\n"
    "The image is the same bit for bit whatever the variant, tile size and number of threads;\n"
    "--hash proves it: `image H hits H`, two 64-bit hashes of the linear pixels and of\n"
    "(distance, primitive, u, v) of every ray. A file is written whole or not at all.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, rb_options_settings, rb_options_levels,
                                                rb_options_variant, rb_options_threads,
                                                rb_options_strict, NULL},
    .run = run,
};

static void print_summary(const struct rb_renderer *renderer, const struct rb_run_result *result)
{
    const struct rb_settings *settings = rb_renderer_settings(renderer);
    uint64_t rays = 0;
    for (int bounce = 0; bounce < settings->depth; bounce++)
        rays += result->recorder.tally[RB_STAGE_TRACE][bounce].rays +
                result->recorder.tally[RB_STAGE_TRACE_SHADOW][bounce].rays;
    double ms = (double)result->wall_ns * 1e-6;
    fprintf(stderr, "%d x %d in %.1f ms with %d thread%s: %" PRIu64 " rays, %.2f Mrays/s\n",
            settings->width, settings->height, ms, result->thread_count,
            result->thread_count == 1 ? "" : "s", rays, (double)rays / ms * 1e-3);
}

// Writes the image to `output` if there is a format, through `pixels`. False if the encoder has no
// memory.
static bool render(struct rb_renderer *renderer, const struct rb_arguments *arguments,
                   const struct rb_image_format *format, struct rb_output *output, float *pixels,
                   struct rb_run_result *result)
{
    const struct rb_settings *settings = rb_renderer_settings(renderer);
    struct rb_progress progress;
    rb_progress_start(&progress, arguments->quiet);
    struct rb_run_options how = {
        .hash_hits = arguments->hash,
        .progress = rb_progress_update,
        .user = &progress,
    };
    rb_renderer_run(renderer, &how, result);
    rb_progress_end(&progress);
    if (!format)
        return true;
    rb_renderer_pixels(renderer, pixels);
    return rb_image_write(format, output->stream, pixels, settings->width, settings->height);
}

// Everything that can fail for want of memory or permission is tried before the long work.
static int render_to_file(struct rb_renderer *renderer, const struct rb_arguments *arguments,
                          const struct rb_image_format *format)
{
    const struct rb_settings *settings = rb_renderer_settings(renderer);
    size_t pixel_count = (size_t)settings->width * (size_t)settings->height;
    struct rb_run_result result;
    struct rb_output output = {0};
    struct rb_error error = {0};
    enum rb_status status = RB_OK;
    float *pixels = rb_alloc(format ? pixel_count : 0, 3 * sizeof *pixels);
    if (!pixels)
        status = rb_error_memory(&error, "the image file");
    if (status == RB_OK && format)
        status = rb_output_open(&output, arguments->output, &error);
    if (status == RB_OK) {
        if (!render(renderer, arguments, format, &output, pixels, &result))
            status = rb_error_memory(&error, "the image file");
        else if (format)
            status = rb_output_commit(&output, &error);
    }
    if (status)
        rb_output_discard(&output);
    rb_free(pixels);
    if (status)
        return rb_report(status, &error);
    if (arguments->hash)
        printf("image %016" PRIx64 " hits %016" PRIx64 "\n", result.image_hash, result.hits_hash);
    if (!arguments->quiet)
        print_summary(renderer, &result);
    return 0;
}

static int run(const struct rb_arguments *arguments)
{
    const struct rb_image_format *format = NULL;
    struct rb_error error = {0};
    if (arguments->output) {
        format = rb_image_format_of(arguments->output, &error);
        if (!format)
            return rb_report(RB_INVALID, &error);
    }
    if (arguments->output && strcmp(arguments->output, "-") == 0 && arguments->hash) {
        rb_error_set(&error, RB_INVALID, "-o - and --hash both want standard output");
        return rb_report(RB_INVALID, &error);
    }
    struct rb_scene scene;
    struct rb_renderer *renderer;
    int code = rb_open_renderer(arguments, &scene, &renderer);
    if (code)
        return code;
    code = render_to_file(renderer, arguments, format);
    rb_renderer_free(renderer);
    rb_scene_free(&scene);
    return code;
}
