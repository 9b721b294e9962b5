// Counting: the twins of the kernels do the same work, their counts repeat exactly and agree with
// what is known from elsewhere.
#include "render/renderer.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <string.h>

static const struct rb_settings settings = {.width = 72, .height = 56, .tile = 32};

struct counted {
    struct rb_run_result plain, result;
    struct rb_count_table table;
    uint64_t heat[72 * 56];
    uint64_t left; // what the plain kernels have counted
};

static const uint32_t of_work = 1u << RB_COUNT_BOXES | 1u << RB_COUNT_SPHERES;
static const uint32_t of_answers = 1u << RB_COUNT_HITS | 1u << RB_COUNT_OCCLUDED;

static void render(const struct rb_scene *scene, const struct rb_variant *variant, int threads,
                   uint32_t heat_of, struct counted *counted)
{
    struct rb_renderer *renderer;
    struct rb_error error = {0};
    struct rb_settings wanted = settings;
    memset(counted, 0, sizeof *counted);
    wanted.threads = threads;
    struct rb_run_options plain = {.hash_hits = true};
    struct rb_run_options how = {
        .hash_hits = true, .counts = &counted->table, .heat = counted->heat, .heat_of = heat_of};
    if (rb_renderer_create(scene, variant, &wanted, &renderer, &error)) {
        note("%s", error.text);
        return;
    }
    rb_renderer_run(renderer, &plain, &counted->plain);
    for (int i = 0; i < RB_COUNTER_COUNT; i++)
        counted->left += rb_counting.counts.of[i];
    rb_renderer_run(renderer, &how, &counted->result);
    rb_renderer_free(renderer);
}

static uint64_t sum_heat(const struct counted *counted)
{
    uint64_t total = 0;
    for (size_t i = 0; i < sizeof counted->heat / sizeof *counted->heat; i++)
        total += counted->heat[i];
    return total;
}

static uint64_t sum(const struct rb_count_table *table, enum rb_counter counter)
{
    uint64_t total = 0;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            total += table->at[stage][bounce].of[counter];
    return total;
}

static uint64_t sum_rays(const struct rb_run_result *result, enum rb_stage stage)
{
    uint64_t total = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        total += result->recorder.tally[stage][bounce].rays;
    return total;
}

static bool hits_agree(const struct counted *counted)
{
    bool agree = true;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        agree = agree && counted->table.at[RB_STAGE_TRACE][bounce].of[RB_COUNT_HITS] ==
                             counted->result.recorder.hits[bounce];
    return agree;
}

// What every counted frame must fulfil.
static void check_identities(const struct counted *c, const char *scene, const char *row)
{
    const struct rb_count_table *t = &c->table;
    ok(c->result.hits_hash == c->plain.hits_hash && c->result.image_hash == c->plain.image_hash,
       "%s, %s: counted and plain kernels make the same hits and image", scene, row);
    ok(c->left == 0, "%s, %s: plain kernels count nothing", scene, row);
    ok(hits_agree(c), "%s, %s: hits are those the pipeline sees", scene, row);
    ok(t->at[RB_STAGE_GENERATE][0].of[RB_COUNT_LANES_ACTIVE] ==
           sum_rays(&c->result, RB_STAGE_GENERATE),
       "%s, %s: generate has a lane for every ray", scene, row);
    ok(sum(t, RB_COUNT_OCCLUDED) < sum_rays(&c->result, RB_STAGE_TRACE_SHADOW) &&
           sum(t, RB_COUNT_OCCLUDED) > 0,
       "%s, %s: some shadow rays are occluded, some are not", scene, row);
    ok(sum(t, RB_COUNT_SHADINGS) >= sum_rays(&c->result, RB_STAGE_TRACE_SHADOW),
       "%s, %s: no shadow ray without a shading", scene, row);
    ok(sum_heat(c) == sum(t, RB_COUNT_BOXES) + sum(t, RB_COUNT_SPHERES),
       "%s, %s: the pixels' costs add up to the counts", scene, row);
    ok(sum(t, RB_COUNT_LANES_ACTIVE) <= sum(t, RB_COUNT_LANES_POSSIBLE) &&
           sum(t, RB_COUNT_LANES_POSSIBLE) >= sum(t, RB_COUNT_STEPS),
       "%s, %s: no more lanes active than there are", scene, row);
}

static void check_naive(const struct rb_scene *scene, const struct counted *c, const char *name)
{
    uint64_t rays = sum_rays(&c->result, RB_STAGE_TRACE), boxes = 0, planes = 0, nodes = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
        boxes += c->table.at[RB_STAGE_TRACE][bounce].of[RB_COUNT_BOXES];
        nodes += c->table.at[RB_STAGE_TRACE][bounce].of[RB_COUNT_NODES];
        planes += c->table.at[RB_STAGE_TRACE][bounce].of[RB_COUNT_PLANES];
    }
    ok(boxes == rays * scene->bounded_count && nodes == 0,
       "%s: naive tests every box with every ray and visits no node", name);
    ok(planes <= rays * scene->count[RB_PLANE], "%s: and no plane more than once", name);
    ok(sum(&c->table, RB_COUNT_STEPS) == sum(&c->table, RB_COUNT_LANES_POSSIBLE),
       "%s: a step of naive has one lane", name);
}

static void check_bvh(const struct counted *naive, const struct counted *bvh, const char *name)
{
    uint64_t nodes = sum(&bvh->table, RB_COUNT_NODES), boxes = sum(&bvh->table, RB_COUNT_BOXES);
    ok(nodes > 0 && boxes > 2 * nodes, "%s: bvh tests two boxes a node and those of primitives",
       name);
    ok(boxes < sum(&naive->table, RB_COUNT_BOXES), "%s: and fewer than naive", name);
    ok(sum(&bvh->table, RB_COUNT_HITS) == sum(&naive->table, RB_COUNT_HITS) &&
           sum(&bvh->table, RB_COUNT_OCCLUDED) == sum(&naive->table, RB_COUNT_OCCLUDED) &&
           sum(&bvh->table, RB_COUNT_SHADINGS) == sum(&naive->table, RB_COUNT_SHADINGS),
       "%s: hits, occluded rays and shadings do not depend on the row", name);
}

static void check_scene(const char *name)
{
    static struct counted naive, first, again;
    struct rb_scene scene;
    struct rb_error error = {0};
    struct rb_nff_options options = {0};
    if (rb_scene_load(name, &options, &scene, &error)) {
        ok(false, "%s", error.text);
        return;
    }
    render(&scene, rb_variant_find("naive"), 1, of_answers, &naive);
    check_naive(&scene, &naive, name);
    for (const struct rb_variant *v = rb_variants; v->name; v++) {
        if (!rb_variant_available(v) || v->best_of || !v->exact)
            continue;
        ok(v->counted != NULL, "%s has a twin that counts", v->name);
        render(&scene, v, 1, of_work, &first);
        render(&scene, v, 3, of_answers, &again);
        check_identities(&first, name, v->name);
        ok(memcmp(&first.table, &again.table, sizeof first.table) == 0,
           "%s, %s: counts repeat exactly, whatever the threads", name, v->name);
        ok(memcmp(naive.heat, again.heat, sizeof naive.heat) == 0,
           "%s, %s: what is counted belongs to the pixel it is said to", name, v->name);
        if (strcmp(v->name, "bvh") == 0)
            check_bvh(&naive, &first, name);
    }
    rb_scene_free(&scene);
}

int main(void)
{
    check_scene("balls_low");
    check_scene("mount3");
    return done();
}
