// The published ray counts of the SPD test scenes (Haines 1987, readme): balls 4 and mount 6 in the
// SPD dialect under SPD's rules. Limit: 0.1 %, what borderline rays may differ by.
#include "render/renderer.h"
#include "scene/generate.h"
#include "scene/nff.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>

static void check(const char *what, double counted, double published)
{
    double off = counted / published - 1.0;
    ok(fabs(off) <= 1e-3, "%s: %.0f, published %.0f, %+.4f %%", what, counted, published,
       off * 100);
}

// Counts of the whole frame.
static struct rb_recorder trace(const char *generator, int size)
{
    struct rb_recorder counts = {0};
    struct rb_error error = {0};
    struct rb_scene scene = {0};
    struct rb_renderer *renderer = NULL;
    struct rb_settings settings = {.spd = true};
    FILE *file = tmpfile();
    if (file && rb_generator_find(generator)->write(file, size, RB_DIALECT_SPD, &error) == RB_OK) {
        rewind(file);
        if (rb_nff_read(file, generator, NULL, &scene, &error) == RB_OK &&
            rb_renderer_create(&scene, rb_variant_fastest(), &settings, &renderer, &error) ==
                RB_OK) {
            struct rb_run_result result;
            rb_renderer_run(renderer, NULL, &result);
            counts = result.recorder;
        }
    }
    if (error.text[0])
        note("%s", error.text);
    if (file)
        fclose(file);
    rb_renderer_free(renderer);
    rb_scene_free(&scene);
    return counts;
}

static double sum(const uint64_t *by_bounce)
{
    double total = 0;
    for (int i = 0; i < RB_BOUNCE_MAX; i++)
        total += (double)by_bounce[i];
    return total;
}

static double shadow_rays(const struct rb_recorder *counts)
{
    double total = 0;
    for (int i = 0; i < RB_BOUNCE_MAX; i++)
        total += (double)counts->tally[RB_STAGE_TRACE_SHADOW][i].rays;
    return total;
}

int main(void)
{
    struct rb_recorder balls = trace("balls", 4);
    ok(balls.tally[RB_STAGE_TRACE][0].rays == 513 * 513, "513 x 513 eye rays");
    check("balls 4, eye rays that hit", (double)balls.hits[0], 263169);
    check("balls 4, reflection rays", sum(balls.reflected), 175095);
    check("balls 4, shadow rays", shadow_rays(&balls), 954368);
    struct rb_recorder mount = trace("mount", 6);
    check("mount 6, eye rays that hit", (double)mount.hits[0], 173125);
    check("mount 6, reflection rays", sum(mount.reflected), 354769);
    check("mount 6, refraction rays", sum(mount.refracted), 354769);
    check("mount 6, shadow rays", shadow_rays(&mount), 412922);
    return done();
}
