// The trees themselves, binary and wide: every primitive in exactly one leaf, boxes that contain
// what is below them, no node missed or used twice, depth within the traversal stack, and the same
// bytes whatever the number of threads.
#include "accel/bvh.h"
#include "accel/sah.h"
#include "accel/wide.h"
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

struct wide_audit {
    const struct rb_scene *scene;
    const struct rb_wide *wide;
    unsigned char *seen;                // by primitive
    uint32_t count[RB_WIDE_KIND_COUNT]; // of what was found in the tree
    int depth;
    bool contained, copied;
};

static bool sphere_copied(const struct rb_wide_spheres *block, int lane,
                          const struct rb_sphere *sphere)
{
    bool same = block->radius[lane] == sphere->radius;
    for (int k = 0; k < 3; k++)
        same = same && block->center[k][lane] == sphere->center[k];
    return same;
}

static bool triangle_copied(const struct rb_wide_triangles *block, int lane,
                            const struct rb_triangle *triangle)
{
    bool same = true;
    for (int k = 0; k < 9; k++)
        same = same && block->v[k / 3][k % 3][lane] == triangle->v[k / 3][k % 3];
    return same;
}

// A block against the primitives it was made of.
static void audit_block(struct wide_audit *audit, const struct rb_box *box, rb_wide_child child)
{
    const struct rb_scene *scene = audit->scene;
    const struct rb_wide *wide = audit->wide;
    uint32_t index = rb_wide_index_of(child);
    const uint32_t *ids = rb_wide_ids(wide, child);
    for (int lane = 0; lane < RB_WIDE && ids[lane] != RB_NONE; lane++) {
        uint32_t id = ids[lane];
        float low[3], high[3];
        rb_scene_bounds(scene, id, low, high);
        audit->seen[id]++;
        for (int k = 0; k < 3; k++)
            if (low[k] < box->low[k] || high[k] > box->high[k])
                audit->contained = false;
        if (rb_wide_kind_of(child) == RB_WIDE_SPHERES)
            audit->copied &= sphere_copied(&wide->spheres[index], lane, &scene->spheres[id]);
        if (rb_wide_kind_of(child) == RB_WIDE_TRIANGLES)
            audit->copied &= triangle_copied(&wide->triangles[index], lane,
                                             &scene->triangles[id - scene->first[RB_TRIANGLE]]);
    }
}

static void audit_wide(struct wide_audit *audit, uint32_t index, const struct rb_box *box,
                       int depth)
{
    const struct rb_wide_node *node = &audit->wide->nodes[index];
    audit->count[RB_WIDE_NODE]++;
    audit->depth = depth > audit->depth ? depth : audit->depth;
    for (uint32_t lane = 0; lane < node->count; lane++) {
        struct rb_box child;
        for (int k = 0; k < 3; k++) {
            child.low[k] = node->bounds[k][0][lane];
            child.high[k] = node->bounds[k][1][lane];
            if (child.low[k] < box->low[k] || child.high[k] > box->high[k])
                audit->contained = false;
        }
        enum rb_wide_kind kind = rb_wide_kind_of(node->child[lane]);
        if (kind == RB_WIDE_NODE) {
            audit_wide(audit, node->child[lane], &child, depth + 1);
        } else {
            audit->count[kind]++;
            audit_block(audit, &child, node->child[lane]);
        }
    }
}

// Have both trees the same bytes?
static bool same_wide(const struct rb_wide *a, const struct rb_wide *b)
{
    return memcmp(a->count, b->count, sizeof a->count) == 0 &&
           (a->count[RB_WIDE_NODE] == 0 ||
            (memcmp(a->nodes, b->nodes, a->count[RB_WIDE_NODE] * sizeof *a->nodes) == 0 &&
             memcmp(a->spheres, b->spheres, a->count[RB_WIDE_SPHERES] * sizeof *a->spheres) == 0 &&
             memcmp(a->triangles, b->triangles,
                    a->count[RB_WIDE_TRIANGLES] * sizeof *a->triangles) == 0 &&
             memcmp(a->others, b->others, a->count[RB_WIDE_OTHERS] * sizeof *a->others) == 0));
}

static void check_wide(const struct rb_scene *scene, const char *name)
{
    struct rb_wide wide, again;
    struct rb_error error = {0};
    if (!ok(rb_wide_build(scene, 1, &wide, &error) == RB_OK, "%s, wide: built", name))
        return;
    struct wide_audit audit = {.scene = scene, .wide = &wide, .contained = true, .copied = true};
    struct rb_box everything = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    audit.seen = rb_alloc(scene->bounded_count, 1);
    if (wide.count[RB_WIDE_NODE])
        audit_wide(&audit, 0, &everything, 0);
    bool once = true;
    for (uint32_t id = 0; id < scene->bounded_count; id++)
        once = once && audit.seen[id] == 1;
    ok(once, "%s, wide: every primitive is in exactly one leaf", name);
    ok(audit.contained, "%s, wide: boxes contain what is below them", name);
    ok(audit.copied, "%s, wide: blocks hold what the scene holds", name);
    ok(memcmp(audit.count, wide.count, sizeof wide.count) == 0,
       "%s, wide: all %u nodes and all blocks are reachable", name, wide.count[RB_WIDE_NODE]);
    ok(audit.depth < RB_BVH_DEPTH_MAX, "%s, wide: depth %d fits the stack", name, audit.depth);
    uint32_t children = 0;
    for (int kind = 0; kind < RB_WIDE_KIND_COUNT; kind++)
        children += wide.count[kind];
    double filled = (double)children / wide.count[RB_WIDE_NODE];
    if (wide.count[RB_WIDE_NODE] > 64)
        ok(filled > 5.0, "%s, wide: %.1f children a node", name, filled);
    rb_free(audit.seen);
    rb_wide_build(scene, 3, &again, &error);
    ok(same_wide(&wide, &again), "%s, wide: three threads build the same tree", name);
    rb_wide_free(&again);
    rb_wide_free(&wide);
}

static void check_trees(const struct rb_scene *scene, const char *name)
{
    check_tree(scene, name);
    check_wide(scene, name);
}

static void check_named(const char *name)
{
    struct rb_scene scene;
    struct rb_error error = {0};
    if (ok(rb_scene_load(name, NULL, &scene, &error) == RB_OK, "%s: loaded", name))
        check_trees(&scene, name);
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
        check_trees(&scene, name);
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
