// libFuzzer target for the NFF reader: any bytes must give a sane scene or an error with a text,
// and leave no memory behind. `make fuzz` runs it; replay.c runs it over the corpus without clang.
#define _POSIX_C_SOURCE 200809L
#include "scene/nff.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(int condition)
{
    if (!condition)
        abort();
}

// One printable line.
static void check_text(const struct rb_error *error)
{
    require(error->text[0] != '\0');
    for (const char *c = error->text; *c; c++)
        require(*c >= ' ' && *c <= '~');
}

static void check_warning(void *user, const struct rb_error *warning)
{
    require(++*(int *)user < 100);
    check_text(warning);
}

static void check_scene(const struct rb_scene *scene)
{
    for (uint32_t id = 0; id < scene->primitive_count; id++) {
        require(scene->material_of[id] < scene->material_count);
        if (id >= scene->bounded_count)
            continue;
        float low[3], high[3];
        rb_scene_bounds(scene, id, low, high);
        for (int k = 0; k < 3; k++)
            require(isfinite(low[k]) && isfinite(high[k]) && low[k] <= high[k]);
    }
    for (uint32_t i = 0; i < scene->count[RB_TRIANGLE]; i++) {
        const float *n = scene->triangle_normals[i];
        require(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0f) < 1e-5f);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    for (int strict = 0; strict < 2; strict++) {
        int warning_count = 0;
        struct rb_nff_options options = {strict, check_warning, &warning_count};
        struct rb_scene scene;
        struct rb_error error = {0};
        long live = rb_memory_live_count();
        FILE *stream = fmemopen((void *)(uintptr_t)data, size, "rb");
        if (!stream)
            return 0;
        if (rb_nff_read(stream, "fuzz.nff", &options, &scene, &error) == RB_OK)
            check_scene(&scene);
        else
            check_text(&error);
        rb_scene_free(&scene);
        fclose(stream);
        require(rb_memory_live_count() == live);
    }
    return 0;
}
