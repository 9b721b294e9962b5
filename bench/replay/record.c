// `raybench record`: renders one frame and writes down what goes between the kernels.
#include "bench/replay/record.h"

#include "bench/data/names.h"
#include "bench/replay/classes.h"
#include "cli/commands.h"
#include "render/queues.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

static const struct rb_option options[] = {
    {"-o", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "file to write; 64 bytes a ray, 49 a shadow ray"},
    {"--classes", "image|diffuse|reflection|refraction|shadow|all,...", RB_OPTION_TEXT,
     BENCH(classes), 0, 0, "rays to record; default image"},
    {"--variant", "VARIANT", RB_OPTION_TEXT, offsetof(struct rb_arguments, variant), 0, 0,
     "serial row that renders; the rays are the same for every row; default bvh"},
    {"--tile", "N", RB_OPTION_INT, offsetof(struct rb_arguments, settings.tile), RB_BLOCK,
     RB_TILE_MAX, "edge of a tile in pixels, a multiple of 16: the size of batches; default 64"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0,
     "no warnings, no list of what was recorded"},
    {.name = NULL},
};

const struct rb_command rb_command_record = {
    .name = "record",
    .summary = "save the ray batches of every kernel and bounce, for replay",
    .synopsis = "SCENE -o FILE [options]",
    .text = RB_HELP_SCENE
    "\n\n"
    "  raybench record balls_high -o balls_high.rays\n"
    "  raybench record mount_high -o mount_high.rays --classes all\n\n"
    "A record holds the rays of the image with their hits, shadow rays with their answers, and\n"
    "the settings. Classes of rays beyond the image's own start from every primary hit:\n"
    "diffuse, reflection, refraction (index 1.2), shadow (to the first light). The scene is not\n"
    "in the file: replay loads it again by its name and compares its hash. The format is\n"
    "documented in bench/replay/record_file.h.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, rb_options_settings, rb_options_levels,
                                                rb_options_strict, NULL},
    .run = run,
};

struct recording {
    const struct rb_scene *scene;
    struct rb_renderer *renderer;
    bool wanted[RB_CLASS_COUNT];
    struct rb_class_batches classes;
    struct rb_record_writer writer;
};

static enum rb_status parse_classes(const char *list, bool wanted[RB_CLASS_COUNT],
                                    struct rb_error *error)
{
    char item[RB_NAME_MAX];
    list = list ? list : rb_ray_class_names[RB_CLASS_IMAGE];
    while (rb_names_next(&list, item)) {
        bool known = false;
        for (int c = 0; c < RB_CLASS_COUNT; c++)
            if (strcmp(item, rb_ray_class_names[c]) == 0 || strcmp(item, "all") == 0)
                wanted[c] = known = true;
        if (!known)
            return rb_error_set(error, RB_INVALID,
                                "--classes: there is no class '%.64s'; there are image, diffuse, "
                                "reflection, refraction, shadow, and all",
                                item);
    }
    return RB_OK;
}

static void record_class(struct recording *recording, enum rb_ray_class ray_class,
                         const struct rb_batch *camera)
{
    struct rb_batch *batch = &recording->classes.of[ray_class];
    rb_class_spawn(ray_class, recording->scene, rb_renderer_settings(recording->renderer)->seed,
                   camera, batch);
    if (rb_batch_count(batch) == 0)
        return;
    if (batch->kind == RB_BATCH_RAYS)
        rb_renderer_trace(recording->renderer, &batch->rays, &batch->hits);
    else
        rb_renderer_trace_shadow(recording->renderer, &batch->shadows);
    rb_record_put(&recording->writer, ray_class, batch);
}

static void traced(void *user, const struct rb_span *span, int bounce, const struct rb_rays *rays,
                   const struct rb_hits *hits)
{
    struct recording *recording = user;
    struct rb_batch batch = {
        .kind = RB_BATCH_RAYS, .bounce = bounce, .span = *span, .rays = *rays, .hits = *hits};
    if (recording->wanted[RB_CLASS_IMAGE])
        rb_record_put(&recording->writer, RB_CLASS_IMAGE, &batch);
    for (int c = 0; c < RB_CLASS_COUNT && bounce == 0; c++)
        if (recording->classes.of[c].memory)
            record_class(recording, (enum rb_ray_class)c, &batch);
}

static void shadowed(void *user, const struct rb_span *span, int bounce,
                     const struct rb_shadows *shadows)
{
    struct recording *recording = user;
    const struct rb_batch batch = {
        .kind = RB_BATCH_SHADOWS, .bounce = bounce, .span = *span, .shadows = *shadows};
    if (recording->wanted[RB_CLASS_IMAGE])
        rb_record_put(&recording->writer, RB_CLASS_IMAGE, &batch);
}

void rb_record_print(const struct rb_record_header *header,
                     const struct rb_record_contents *contents)
{
    static const char *const kinds[] = {"rays", "shadow rays"};
    printf("%s: %d x %d, depth %d; rendered by %s\n", header->scene, header->settings.width,
           header->settings.height, header->settings.depth, header->row);
    printf("  %-12s %-12s %6s %10s %8s\n", "class", "kind", "bounce", "rays", "batches");
    for (int c = 0; c < RB_CLASS_COUNT; c++)
        for (int kind = 0; kind < RB_BATCH_KIND_COUNT; kind++)
            for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
                if (contents->of[c][kind][bounce].rays)
                    printf("  %-12s %-12s %6d %10" PRIu64 " %8" PRIu64 "\n", rb_ray_class_names[c],
                           kinds[kind], bounce, contents->of[c][kind][bounce].rays,
                           contents->of[c][kind][bounce].batches);
}

static enum rb_status record(struct recording *recording, const struct rb_arguments *arguments,
                             const char *row, struct rb_error *error)
{
    struct rb_record_header header = {
        .scene_hash = recording->scene->hash,
        .settings = *rb_renderer_settings(recording->renderer),
    };
    const struct rb_observer observer = {recording, traced, shadowed};
    const struct rb_run_options how = {.hash_hits = true, .observer = &observer};
    struct rb_run_result result;
    snprintf(header.scene, sizeof header.scene, "%s", arguments->positional[0]);
    snprintf(header.row, sizeof header.row, "%s", row);
    enum rb_status status =
        rb_class_batches_alloc(&recording->classes, recording->wanted, RB_BATCH_MAX, error);
    if (status == RB_OK)
        status = rb_record_create(&recording->writer, arguments->output, &header, error);
    if (status == RB_OK) {
        rb_renderer_run(recording->renderer, &how, &result);
        status = rb_record_finish(&recording->writer, result.image_hash, result.hits_hash, error);
    }
    if (status == RB_OK && !arguments->quiet)
        rb_record_print(&header, &recording->writer.contents);
    rb_class_batches_free(&recording->classes);
    return status;
}

static enum rb_status check(const struct rb_arguments *arguments, struct recording *recording,
                            struct rb_error *error)
{
    const char *scene = arguments->positional[0];
    if (!arguments->output)
        return rb_error_set(error, RB_INVALID, "record: -o FILE says where the rays go");
    if (strcmp(arguments->output, "-") == 0)
        return rb_error_set(error, RB_INVALID, "record: -o takes a file, which replay reads again");
    if (strcmp(scene, "-") == 0 || strlen(scene) >= RB_RECORD_SCENE_MAX)
        return rb_error_set(error, RB_INVALID,
                            "record: replay loads the scene again: give a file with a name of at "
                            "most %d bytes, not standard input",
                            RB_RECORD_SCENE_MAX - 1);
    return parse_classes(arguments->bench.classes, recording->wanted, error);
}

static int run(const struct rb_arguments *arguments)
{
    static struct recording recording;
    struct rb_error error = {0};
    struct rb_arguments copy = *arguments;
    struct rb_scene scene;
    copy.variant = arguments->variant ? arguments->variant : "bvh";
    enum rb_status status = check(arguments, &recording, &error);
    if (status)
        return rb_report(status, &error);
    const struct rb_variant *variant = rb_open_variant(&copy);
    if (!variant)
        return RB_INVALID;
    if (rb_variant_parallel(variant)) {
        rb_error_set(&error, RB_INVALID,
                     "record: the threads of %s would mix up their batches; "
                     "take a serial row: the rays are the same",
                     variant->name);
        return rb_report(RB_INVALID, &error);
    }
    int code = rb_open_renderer(&copy, &scene, &recording.renderer);
    if (code)
        return code;
    recording.scene = &scene;
    status = record(&recording, arguments, variant->name, &error);
    rb_renderer_free(recording.renderer);
    rb_scene_free(&scene);
    return status ? rb_report(status, &error) : 0;
}
