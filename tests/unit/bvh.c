// The tree itself: every primitive in exactly one leaf, boxes that contain what is below them, no
// node missed or used twice, depth within the traversal stack, and the same bytes whatever the
// number of threads.
#include "accel/bvh.h"
#include "base/random.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <string.h>

struct audit {
    const struct rb_scene *scene;
    const struct rb_bvh *bvh;
    unsigned char *seen; // by primitive
    uint32_t nodes;
    int depth;
    bool contained;
};

static void audit_leaf(struct audit *audit, const struct rb_bvh_node *node, int c)
{
    for (uint32_t i = 0; i < node->count[c]; i++) {
        uint32_t id = audit->bvh->refs[node->child[c] + i];
        float low[3], high[3];
        rb_scene_bounds(audit->scene, id, low, high);
        audit->seen[id]++;
        for (int k = 0; k < 3; k++)
            if (low[k] < node->bounds[k][0][c] || high[k] > node->bounds[k][1][c])
                audit->contained = false;
    }
}

static void audit_node(struct audit *audit, uint32_t index, int depth)
{
    const struct rb_bvh_node *node = &audit->bvh->nodes[index];
    audit->nodes++;
    audit->depth = depth > audit->depth ? depth : audit->depth;
    for (int c = 0; c < 2; c++) {
        if (node->bounds[0][0][c] > node->bounds[0][1][c])
            continue; // no such child
        if (node->count[c]) {
            audit_leaf(audit, node, c);
            continue;
        }
        const struct rb_bvh_node *child = &audit->bvh->nodes[node->child[c]];
        for (int k = 0; k < 3; k++)
            for (int g = 0; g < 2; g++)
                if (child->bounds[k][0][g] <= child->bounds[k][1][g] &&
                    (child->bounds[k][0][g] < node->bounds[k][0][c] ||
                     child->bounds[k][1][g] > node->bounds[k][1][c]))
                    audit->contained = false;
        audit_node(audit, node->child[c], depth + 1);
    }
}

static void check_tree(const struct rb_scene *scene, const char *name)
{
    struct rb_bvh bvh, again;
    struct rb_error error = {0};
    if (!ok(rb_bvh_build(scene, 1, &bvh, &error) == RB_OK, "%s: built", name))
        return;
    struct audit audit = {.scene = scene, .bvh = &bvh, .contained = true};
    audit.seen = rb_alloc(scene->bounded_count, 1);
    if (bvh.node_count)
        audit_node(&audit, 0, 0);
    bool once = true;
    for (uint32_t id = 0; id < scene->bounded_count; id++)
        once = once && audit.seen[id] == 1;
    ok(once, "%s: every primitive is in exactly one leaf", name);
    ok(audit.contained, "%s: boxes contain what is below them", name);
    ok(audit.nodes == bvh.node_count, "%s: all %u nodes are reachable", name, bvh.node_count);
    ok(audit.depth < RB_BVH_DEPTH_MAX, "%s: depth %d fits the stack", name, audit.depth);
    rb_free(audit.seen);
    rb_bvh_build(scene, 3, &again, &error);
    ok(again.node_count == bvh.node_count &&
           (bvh.node_count == 0 ||
            (memcmp(again.nodes, bvh.nodes, bvh.node_count * sizeof *bvh.nodes) == 0 &&
             memcmp(again.refs, bvh.refs, bvh.ref_count * sizeof *bvh.refs) == 0)),
       "%s: three threads build the same tree", name);
    rb_bvh_free(&again);
    rb_bvh_free(&bvh);
}

static void check_named(const char *name)
{
    struct rb_scene scene;
    struct rb_error error = {0};
    if (ok(rb_scene_load(name, NULL, &scene, &error) == RB_OK, "%s: loaded", name))
        check_tree(&scene, name);
    rb_scene_free(&scene);
}

static struct rb_camera plain_camera(void)
{
    return (struct rb_camera){
        .from = {0, 0, 5}, .up = {0, 1, 0}, .angle_deg = 45, .width = 8, .height = 8};
}

// Scenes that leave the surface area heuristic nothing to go by.
static void check_degenerate(const char *name, uint32_t count, double spread)
{
    struct rb_scene_builder builder = {.camera = plain_camera()};
    struct rb_scene scene;
    struct rb_error error = {0};
    for (uint32_t i = 0; i < count; i++) {
        double x = spread * (double)rb_random(1, i, 0, 1, 0);
        // Exponentially spread: each split cuts off one sphere, as deep as a tree can get.
        double center[3] = {spread < 0 ? exp2(-(double)i) : x, 0, 0};
        rb_scene_add_sphere(&builder, center, 1e-9, &error);
    }
    if (ok(rb_scene_finish(&builder, &scene, &error) == RB_OK, "%s: made", name))
        check_tree(&scene, name);
    rb_scene_free(&scene);
}

int main(void)
{
    check_named("balls_low");
    check_named("balls_high");
    check_named("mount_low");
    check_named("mount7");
    check_degenerate("no sphere", 0, 0);
    check_degenerate("one sphere", 1, 0);
    check_degenerate("two spheres", 2, 1);
    check_degenerate("5000 equal spheres", 5000, 0);
    check_degenerate("spheres on a line", 5000, 1);
    check_degenerate("exponentially spaced spheres", 120, -1);
    return done();
}
