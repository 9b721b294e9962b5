// Replay of recorded batches: every row gives what was recorded, any difference is noticed, and
// batches of another scene are refused or do no harm.
#define _XOPEN_SOURCE 700
#include "base/hash.h"
#include "bench/replay/classes.h"
#include "bench/replay/record.h"
#include "render/queues.h"
#include "render/renderer.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/raybench-replay-XXXXXX";
static struct rb_scene scene;

static bool record(const char *name, struct rb_settings settings)
{
    struct rb_arguments arguments = {
        .positional = {name},
        .positional_count = 1,
        .settings = settings,
        .output = path,
        .quiet = true,
        .bench = {.classes = "all"},
    };
    return rb_command_record.run(&arguments) == 0;
}

// What is read of a record, with a renderer of a row.
struct player {
    struct rb_record record;
    struct rb_renderer *renderer;
    struct rb_replay replay;
    struct rb_error error;
};

static bool open_player(struct player *player, const char *row, enum rb_ray_class ray_class,
                        enum rb_stage kernel, int bounce)
{
    const struct rb_record_choice choice = {ray_class, kernel, bounce};
    *player = (struct player){.renderer = NULL};
    bool opened = rb_record_read(path, &choice, &player->record, &player->error) == RB_OK &&
                  rb_renderer_create(&scene, rb_variant_find(row), &player->record.header.settings,
                                     &player->renderer, &player->error) == RB_OK;
    player->replay =
        (struct rb_replay){kernel, player->record.batches.data, player->record.batches.count, 1};
    player->error = (struct rb_error){0};
    if (!opened)
        note("%s", player->error.text);
    return opened;
}

static void close_player(struct player *player)
{
    rb_renderer_free(player->renderer);
    rb_record_free(&player->record);
}

static enum rb_status verify(struct player *player)
{
    return rb_replay_verify(player->renderer, &player->replay, 0, player->replay.count,
                            &player->error);
}

static bool agrees(const char *row, enum rb_ray_class ray_class, enum rb_stage kernel)
{
    struct player player;
    bool same = open_player(&player, row, ray_class, kernel, -1) && player.replay.count &&
                rb_replay_check(player.renderer, &player.replay, &player.error) == RB_OK &&
                verify(&player) == RB_OK;
    if (!same)
        note("%s, %s, %s: %zu batches, %s", row, rb_ray_class_names[ray_class],
             rb_stage_names[kernel], player.replay.count, player.error.text);
    close_player(&player);
    return same;
}

static void check_rows(const char *what)
{
    for (const struct rb_variant *row = rb_variants; row->name; row++) {
        bool same = true;
        if (!rb_variant_available(row) || rb_variant_parallel(row) || !row->exact)
            continue;
        for (int kernel = 0; kernel < RB_KERNEL_COUNT; kernel++)
            same = agrees(row->name, RB_CLASS_IMAGE, (enum rb_stage)kernel) && same;
        for (int c = RB_CLASS_DIFFUSE; c < RB_CLASS_SHADOW; c++)
            same = agrees(row->name, (enum rb_ray_class)c, RB_STAGE_TRACE) && same;
        same = agrees(row->name, RB_CLASS_SHADOW, RB_STAGE_TRACE_SHADOW) && same;
        ok(same, "%s: %s gives what was recorded", what, row->name);
    }
}

// Rays, calls and laps of a replay are those of the kernel in a frame, `rounds` times, however many
// threads share them.
static void check_laps(const char *row)
{
    bool parallel = rb_variant_parallel(rb_variant_find(row));
    if (!rb_variant_available(rb_variant_find(row)))
        return;
    for (int kernel = 0; kernel < RB_KERNEL_COUNT; kernel++) {
        struct player player;
        struct rb_run_result frame, alone;
        open_player(&player, row, RB_CLASS_IMAGE, (enum rb_stage)kernel, -1);
        player.replay.rounds = 3;
        const struct rb_run_options how = {.replay = &player.replay};
        rb_renderer_run(player.renderer, NULL, &frame);
        rb_renderer_run(player.renderer, &how, &alone);
        bool same = true, nothing_else = true;
        for (int b = 0; b < RB_BOUNCE_MAX; b++)
            for (int k = 0; k < RB_STAGE_OTHER; k++) {
                const struct rb_tally *is = &alone.recorder.tally[k][b];
                const struct rb_tally *was = &frame.recorder.tally[k][b];
                if (k == kernel)
                    same = same && is->rays == 3 * was->rays && is->calls == 3 * was->calls;
                else
                    nothing_else = nothing_else && is->rays == 0 && is->calls == 0;
            }
        ok(same, "%s, %s: rays and calls as in a frame, three times", row, rb_stage_names[kernel]);
        ok(nothing_else && (parallel || alone.thread_count == 1), "and no other stage");
        close_player(&player);
    }
}

// A kernel alone counts what it counts in a frame.
static void check_kernel_counts(const char *row)
{
    static struct rb_count_table frame, alone;
    bool same = true, any = true;
    for (int kernel = 0; kernel < RB_KERNEL_COUNT; kernel++) {
        struct player player;
        struct rb_run_result result;
        open_player(&player, row, RB_CLASS_IMAGE, (enum rb_stage)kernel, -1);
        const struct rb_run_options in_place = {.counts = &frame};
        const struct rb_run_options how = {.replay = &player.replay, .counts = &alone};
        frame = alone = (struct rb_count_table){0};
        rb_renderer_run(player.renderer, &in_place, &result);
        rb_renderer_run(player.renderer, &how, &result);
        same = same && memcmp(frame.at[kernel], alone.at[kernel], sizeof alone.at[kernel]) == 0;
        any = any && alone.at[kernel][0].of[RB_COUNT_STEPS] > 0;
        close_player(&player);
    }
    ok(same && any, "%s: every kernel counts what it does in a frame", row);
}

// Changes an element of an array of a batch and expects to be told about it.
static void check_change(enum rb_stage kernel, struct player *player, struct rb_members members,
                         const char *member, uint32_t ray)
{
    for (size_t i = 0; i < members.count; i++) {
        if (strcmp(members.member[i].name, member) != 0)
            continue;
        char *byte = rb_member_array(&members.member[i]) + ray * members.member[i].size;
        char expected[64];
        snprintf(expected, sizeof expected, "ray %u: %s is not as recorded", ray, member);
        *byte = (char)(*byte ^ 1);
        enum rb_status status = verify(player);
        ok(status == RB_INVALID && strstr(player->error.text, expected), "%s: %s",
           rb_stage_names[kernel], player->error.text);
        *byte = (char)(*byte ^ 1);
    }
}

static void check_differences(void)
{
    static const struct {
        enum rb_stage kernel;
        size_t batch;
        const char *member;
    } cases[] = {
        {RB_STAGE_GENERATE, 0, "dx"},
        {RB_STAGE_GENERATE, 0, "path"},
        {RB_STAGE_TRACE, 0, "t"},
        {RB_STAGE_TRACE, 0, "prim"},
        {RB_STAGE_SHADE, 1, "distance"},
        {RB_STAGE_SHADE, 1, "r"},
        {RB_STAGE_TRACE_SHADOW, 0, "occluded"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct player player;
        open_player(&player, "bvh", RB_CLASS_IMAGE, cases[i].kernel, 0);
        struct rb_batch *batch = (struct rb_batch *)player.record.batches.data + cases[i].batch;
        struct rb_members members =
            batch->kind == RB_BATCH_SHADOWS     ? rb_shadows_members(&batch->shadows)
            : cases[i].kernel == RB_STAGE_TRACE ? rb_hits_members(&batch->hits)
                                                : rb_rays_members(&batch->rays);
        check_change(cases[i].kernel, &player, members, cases[i].member, 7);
        close_player(&player);
    }
}

// Shadow rays missing from the record, or too many of them.
static void check_counts(void)
{
    struct player player;
    open_player(&player, "bvh", RB_CLASS_IMAGE, RB_STAGE_SHADE, 0);
    struct rb_batch *batches = player.record.batches.data;
    ok(batches[0].kind == RB_BATCH_RAYS && batches[1].kind == RB_BATCH_SHADOWS,
       "shadow rays follow the rays");
    batches[1].shadows.count--;
    ok(verify(&player) == RB_INVALID, "one less: %s", player.error.text);
    batches[1].shadows.count++;
    player.replay.count = 1;
    ok(verify(&player) == RB_INVALID, "none: %s", player.error.text);
    struct rb_batch more[3] = {batches[0], batches[1], batches[1]};
    player.replay.batches = more;
    player.replay.count = 3;
    ok(verify(&player) == RB_INVALID, "twice: %s", player.error.text);
    player.replay.batches = batches + 1;
    ok(rb_replay_check(player.renderer, &player.replay, &player.error) == RB_INVALID,
       "without rays: %s", player.error.text);
    close_player(&player);
}

// Random bytes in random places of all arrays, and a random span: batches are refused, or the
// kernel runs on them. What it gives may be anything.
static void check_nonsense(enum rb_stage kernel, const char *row)
{
    struct player player;
    struct rb_run_result result;
    const struct rb_run_options how = {.replay = &player.replay};
    uint64_t random = (uint64_t)kernel;
    int refused = 0, run = 0;
    open_player(&player, row, RB_CLASS_IMAGE, kernel, 0);
    struct rb_batch *batches = player.record.batches.data;
    for (int trial = 0; trial < 400; trial++) {
        struct rb_batch kept = batches[trial % (int)player.replay.count];
        struct rb_batch *batch = &batches[trial % (int)player.replay.count];
        struct rb_members queues[2] = {rb_rays_members(&batch->rays),
                                       rb_hits_members(&batch->hits)};
        if (batch->kind == RB_BATCH_SHADOWS)
            queues[0] = queues[1] = rb_shadows_members(&batch->shadows);
        random = rb_mix(random + 1);
        const struct rb_members *members = &queues[random % 2];
        const struct rb_member *member = &members->member[random / 2 % members->count];
        size_t at = random / 64 % (rb_batch_count(batch) * member->size);
        char *byte = rb_member_array(member) + at, old = *byte;
        *byte = (char)(random >> 56);
        if (trial % 10 == 0)
            (&batch->span.x0)[random % 5] = (int)(random >> 40) - (1 << 20);
        if (rb_replay_check(player.renderer, &player.replay, &player.error)) {
            refused++;
        } else {
            run++;
            verify(&player);
            rb_renderer_run(player.renderer, &how, &result);
        }
        *byte = old;
        batch->span = kept.span;
    }
    ok(refused > 5 && run > 5, "%s, %s: of 400 mistakes %d refused, %d run", rb_stage_names[kernel],
       row, refused, run);
    close_player(&player);
}

// Directions are unit vectors on the side they should be; mean of cosines of diffuse rays 2/3.
static void check_classes(void)
{
    struct player camera, diffuse, mirror;
    open_player(&camera, "bvh", RB_CLASS_IMAGE, RB_STAGE_TRACE, 0);
    open_player(&diffuse, "bvh", RB_CLASS_DIFFUSE, RB_STAGE_TRACE, 1);
    open_player(&mirror, "bvh", RB_CLASS_REFLECTION, RB_STAGE_TRACE, 1);
    const struct rb_batch *parents = camera.record.batches.data, *d = diffuse.record.batches.data;
    const struct rb_batch *m = mirror.record.batches.data;
    uint32_t child = 0;
    bool same = true, unit = true;
    double cosines = 0, mirrored = 0;
    for (uint32_t i = 0; i < parents->rays.count; i++) {
        if (parents->hits.prim[i] == RB_NONE)
            continue;
        const struct rb_rays *a = &parents->rays, *b = &d->rays, *c = &m->rays;
        double n[3] = {(double)(c->dx[child] - a->dx[i]), (double)(c->dy[child] - a->dy[i]),
                       (double)(c->dz[child] - a->dz[i])}; // mirrored - original is along n
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double x = (double)b->dx[child], y = (double)b->dy[child], z = (double)b->dz[child];
        cosines += (n[0] * x + n[1] * y + n[2] * z) / length;
        mirrored += length / 2;
        unit = unit && fabs(x * x + y * y + z * z - 1) < 1e-5;
        same = same && b->pixel[child] == a->pixel[i] && b->self[child] == parents->hits.prim[i] &&
               c->self[child] == b->self[child];
        child++;
    }
    ok(child == d->rays.count && child == m->rays.count && child > 500,
       "a diffuse and a mirrored ray for each of %u hits", child);
    ok(same && unit, "that start where it is and are unit vectors");
    ok(fabs(cosines / child - 2.0 / 3.0) < 0.03, "diffuse: mean cosine %.3f of 2/3",
       cosines / child);
    ok(mirrored / child > 0.1, "mirrored: mean cosine %.3f", mirrored / child);
    close_player(&camera);
    close_player(&diffuse);
    close_player(&mirror);
}

int main(void)
{
    const struct rb_settings plain = {.width = 40, .height = 40};
    const struct rb_settings rich = {.width = 20,
                                     .height = 20,
                                     .aa = 2,
                                     .light_samples = 4,
                                     .light_size = 0.5,
                                     .ambient = 0.1,
                                     .phong = true,
                                     .seed = 7,
                                     .tile = 16};
    static const char *const names[] = {"balls2", "mount3"};
    struct rb_error error = {0};
    const char *fastest = rb_variant_fastest()->name;
    char serial[64];
    snprintf(serial, sizeof serial, "%.*s", (int)strcspn(fastest, "+"), fastest);
    close(mkstemp(path));
    for (int i = 0; i < 2; i++) {
        ok(rb_scene_load(names[i], NULL, &scene, &error) == RB_OK && record(names[i], rich),
           "%s, soft shadows", names[i]);
        check_rows(names[i]);
        ok(record(names[i], plain), "%s", names[i]);
        check_rows(names[i]);
        check_laps("bvh");
        check_laps("bvh+omp");
        check_kernel_counts("bvh");
        check_kernel_counts(serial);
        check_classes();
        check_differences();
        check_counts();
        for (int kernel = 0; kernel < RB_KERNEL_COUNT; kernel++) {
            check_nonsense((enum rb_stage)kernel, "bvh");
            check_nonsense((enum rb_stage)kernel, serial);
        }
        rb_scene_free(&scene);
    }
    unlink(path);
    return done();
}
