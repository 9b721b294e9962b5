#include "bench/replay/source.h"

#include "cli/commands.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

const struct rb_option rb_options_choice[] = {
    {"--kernel", "generate|trace|shade|trace_shadow", RB_OPTION_TEXT, BENCH(kernels), 0, 0,
     "kernel to run; default all four"},
    {"--bounce", "N", RB_OPTION_INT, BENCH(bounce), 0, RB_BOUNCE_MAX - 1,
     "bounce whose rays it gets; default all, one after the other"},
    {"--class", "image|diffuse|reflection|refraction|shadow|all", RB_OPTION_TEXT, BENCH(classes), 0,
     0, "rays it gets; default image"},
    {"--variant", "VARIANT", RB_OPTION_TEXT, offsetof(struct rb_arguments, variant), 0, 0,
     "serial row whose kernels run; default: the fastest available"},
    {.name = NULL},
};

const struct rb_variant *rb_replay_variant(const struct rb_arguments *arguments)
{
    const struct rb_variant *fastest = NULL;
    if (arguments->variant)
        return rb_open_variant(arguments);
    for (const struct rb_variant *row = rb_variants; row->name; row++)
        if (row->exact && !row->best_of && !rb_variant_parallel(row) && rb_variant_available(row))
            fastest = row;
    return fastest;
}

static bool is_given(const struct rb_arguments *arguments, const char *name)
{
    for (int i = 0; i < arguments->given_count; i++)
        if (strcmp(arguments->given[i].name, name) == 0)
            return true;
    return false;
}

// The index of `word` among `count` names, or -1.
static int find(const char *word, const char *const *names, int count)
{
    for (int i = 0; i < count; i++)
        if (strcmp(word, names[i]) == 0)
            return i;
    return -1;
}

enum rb_status rb_choice_parse(const struct rb_arguments *arguments, int *kernel, int *ray_class,
                               int *bounce, struct rb_error *error)
{
    const char *kernel_name = arguments->bench.kernels, *class_name = arguments->bench.classes;
    *bounce = is_given(arguments, "--bounce") ? arguments->bench.bounce : -1;
    *kernel = kernel_name ? find(kernel_name, rb_stage_names, RB_KERNEL_COUNT) : -1;
    *ray_class = RB_CLASS_IMAGE;
    if (class_name)
        *ray_class = strcmp(class_name, "all") == 0
                         ? RB_CLASS_COUNT
                         : find(class_name, rb_ray_class_names, RB_CLASS_COUNT);
    if (kernel_name && *kernel < 0)
        return rb_error_set(error, RB_INVALID,
                            "--kernel %.64s: there are generate, trace, shade, trace_shadow",
                            kernel_name);
    if (*ray_class < 0)
        return rb_error_set(error, RB_INVALID,
                            "--class %.64s: there are image, diffuse, reflection, refraction, "
                            "shadow, and all",
                            class_name);
    return RB_OK;
}

enum rb_batch_kind rb_kernel_batch_kind(enum rb_stage kernel)
{
    return kernel == RB_STAGE_TRACE_SHADOW ? RB_BATCH_SHADOWS : RB_BATCH_RAYS;
}

int rb_record_open_scene(const struct rb_record *record, const char *path,
                         const struct rb_arguments *arguments, struct rb_scene *scene)
{
    struct rb_error error = {0};
    int code = rb_open_scene(record->header.scene, arguments, scene);
    if (code || scene->hash == record->header.scene_hash)
        return code;
    snprintf(error.file, sizeof error.file, "%.255s", path);
    rb_error_set(&error, RB_INVALID,
                 "the scene %.200s is not the one recorded (hash %016" PRIx64 ", not %016" PRIx64
                 "); record it again",
                 record->header.scene, scene->hash, record->header.scene_hash);
    rb_scene_free(scene);
    return rb_report(RB_INVALID, &error);
}

static enum rb_status make_renderer(struct rb_replay_source *source,
                                    const struct rb_record_choice *choice, int threads,
                                    struct rb_error *error)
{
    struct rb_settings settings = source->record.header.settings;
    settings.threads = threads;
    if (threads > 1)
        source->row.schedule = rb_schedule_openmp;
    source->replay = (struct rb_replay){
        .kernel = choice->kernel,
        .batches = source->record.batches.data,
        .count = source->record.batches.count,
        .rounds = 1,
    };
    enum rb_status status =
        rb_renderer_create(&source->scene, &source->row, &settings, &source->renderer, error);
    if (status == RB_OK)
        status = rb_replay_check(source->renderer, &source->replay, error);
    return status;
}

int rb_replay_source_open(const char *path, const struct rb_record_choice *choice,
                          const struct rb_arguments *arguments, struct rb_replay_source *source)
{
    struct rb_error error = {0};
    *source = (struct rb_replay_source){.renderer = NULL};
    const struct rb_variant *variant = rb_replay_variant(arguments);
    if (!variant)
        return RB_INVALID;
    enum rb_status status = rb_record_read(path, choice, &source->record, &error);
    if (status)
        return rb_report(status, &error);
    int code = rb_record_open_scene(&source->record, path, arguments, &source->scene);
    if (code) {
        rb_record_free(&source->record);
        return code;
    }
    source->row = *variant;
    status = make_renderer(source, choice, arguments->settings.threads, &error);
    if (status == RB_OK)
        return 0;
    rb_replay_source_close(source);
    return rb_report(status, &error);
}

void rb_replay_source_close(struct rb_replay_source *source)
{
    rb_renderer_free(source->renderer);
    rb_scene_free(&source->scene);
    rb_record_free(&source->record);
}
