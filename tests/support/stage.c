// Setting a scene up or giving up, and rays from and to the kernels' queues.
#include "tests/support/stage.h"

#include <stdio.h>
#include <stdlib.h>

struct rb_error stage_failure;

void stage_give_up(const char *what)
{
    printf("Bail out! %s\n", what);
    exit(1);
}

void stage_check(enum rb_status status)
{
    if (status != RB_OK)
        stage_give_up(stage_failure.text);
}

static void prepare(struct stage *stage)
{
    stage_check(rb_bvh_build(&stage->scene, 1, &stage->bvh, &stage_failure));
    stage_check(rb_wide_build(&stage->scene, 1, &stage->wide, &stage_failure));
    if (!ref_world_build(&stage->scene, &stage->reference))
        stage_give_up("no memory");
    stage->world =
        (struct rb_world){.scene = &stage->scene, .bvh = &stage->bvh, .wide = &stage->wide};
}

void stage_build(struct stage *stage, struct rb_scene_builder *builder)
{
    stage_check(rb_scene_finish(builder, &stage->scene, &stage_failure));
    prepare(stage);
}

void stage_load(struct stage *stage, const char *name)
{
    stage_check(rb_scene_load(name, &(struct rb_nff_options){0}, &stage->scene, &stage_failure));
    prepare(stage);
}

void stage_close(struct stage *stage)
{
    rb_bvh_free(&stage->bvh);
    rb_wide_free(&stage->wide);
    ref_world_free(&stage->reference);
    rb_scene_free(&stage->scene);
}

void stage_push(struct rb_rays *rays, struct rb_vec o, struct rb_vec d)
{
    uint32_t i = rays->count++;
    rays->ox[i] = o.x, rays->oy[i] = o.y, rays->oz[i] = o.z;
    rays->dx[i] = d.x, rays->dy[i] = d.y, rays->dz[i] = d.z;
    rays->weight[i] = 1.0f;
    rays->pixel[i] = 0;
    rays->path[i] = 1;
    rays->self[i] = RB_NONE;
    rays->media[i] = 0;
}

struct ref_ray stage_ray(const struct rb_rays *rays, uint32_t i)
{
    return (struct ref_ray){
        .o = {(double)rays->ox[i], (double)rays->oy[i], (double)rays->oz[i]},
        .d = {(double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]},
        .self = rays->self[i],
    };
}
