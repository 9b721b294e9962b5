// No memory, at every allocation in turn: loading and rendering a scene must fail cleanly, say so
// and leak nothing.
#include "base/memory.h"
#include "render/renderer.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <string.h>

enum { ATTEMPTS_MAX = 10000 };

static enum rb_status load_and_render(const char *name, const struct rb_variant *variant,
                                      struct rb_error *error)
{
    struct rb_settings settings = {.width = 20, .height = 20, .threads = 2, .tile = 16};
    struct rb_renderer *renderer = NULL;
    struct rb_run_result result;
    struct rb_scene scene = {0};
    enum rb_status status = rb_scene_load(name, NULL, &scene, error);
    if (status == RB_OK)
        status = rb_renderer_create(&scene, variant, &settings, &renderer, error);
    if (status == RB_OK)
        rb_renderer_run(renderer, NULL, &result);
    rb_renderer_free(renderer);
    rb_scene_free(&scene);
    return status;
}

static void check(const char *name, const struct rb_variant *variant)
{
    long before = rb_memory_live_count();
    bool clean = true;
    int n = 1;
    for (; n < ATTEMPTS_MAX; n++) {
        struct rb_error error = {0};
        rb_memory_fail_at(n);
        enum rb_status status = load_and_render(name, variant, &error);
        rb_memory_fail_at(0);
        if (rb_memory_live_count() != before) {
            note("allocation %d leaks", n);
            clean = false;
        }
        if (status == RB_OK)
            break;
        if (status != RB_FAILED || !strstr(error.text, "memory")) {
            note("allocation %d: status %d, '%s'", n, status, error.text);
            clean = false;
        }
    }
    ok(clean && n > 5 && n < ATTEMPTS_MAX, "%s with %s: each of %d allocations may fail", name,
       variant->name, n - 1);
}

static void check_arrays(void)
{
    struct rb_array array = {0};
    bool pushed = true;
    for (int i = 0; i < 1000; i++)
        pushed = pushed && rb_array_push(&array, &i, sizeof i);
    bool kept = true;
    for (int i = 0; i < 1000; i++)
        kept = kept && ((int *)array.data)[i] == i;
    ok(pushed && kept && array.count == 1000, "an array keeps what is pushed");
    ok(!rb_array_reserve(&array, SIZE_MAX / 2, sizeof(int)) && array.count == 1000,
       "a reserve that cannot be is refused and changes nothing");
    ok(rb_alloc(SIZE_MAX / 4, 8) == NULL, "a size that overflows is refused");
    rb_array_release(&array);
}

int main(void)
{
    check_arrays();
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++) {
        if (!rb_variant_available(variant))
            continue;
        check("balls_low", variant);
        check("mount_low", variant);
    }
    return done();
}
