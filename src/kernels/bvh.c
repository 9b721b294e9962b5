// One ray at a time through a binary BVH, nearer child first. The order of the visits cannot change
// the answer: a subtree is skipped only if it starts beyond the closest hit so far, and its
// interval contains those of its primitives (intersect.h).
#include "accel/bvh.h"
#include "kernels/one_by_one.h"

static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(rb_kernels_bvh) = {
    .generate = RB_TWIN(rb_scalar_generate),
    .trace = trace,
    .surface = RB_TWIN(rb_scalar_surface),
    .light = RB_TWIN(rb_scalar_light),
    .trace_shadow = trace_shadow,
};

// A child that is still to be visited.
struct visit {
    uint32_t child, count; // as in rb_bvh_node
    float near;
};

// The same slabs as rb_box, for child `c` of a node.
static inline struct rb_interval child_interval(const struct rb_bvh_node *node, int c,
                                                const struct rb_ray *ray)
{
    struct rb_interval range = {0.0f, INFINITY};
    rb_slab(node->bounds[0][0][c], node->bounds[0][1][c], ray->o.x, ray->inv.x, &range);
    rb_slab(node->bounds[1][0][c], node->bounds[1][1][c], ray->o.y, ray->inv.y, &range);
    rb_slab(node->bounds[2][0][c], node->bounds[2][1][c], ray->o.z, ray->inv.z, &range);
    return range;
}

// Pushes the children that the ray reaches no farther than `limit`, the nearer one on top.
static inline int push_children(const struct rb_bvh_node *node, const struct rb_ray *ray,
                                float limit, struct visit *stack, int depth)
{
    struct rb_interval a = child_interval(node, 0, ray), b = child_interval(node, 1, ray);
    bool visit_a = a.near <= a.far && a.near <= limit, visit_b = b.near <= b.far && b.near <= limit;
    int far = a.near <= b.near;
    RB_COUNT_STEP(1, 1);
    RB_COUNT_RAYS(NODES, 1, 1);
    RB_COUNT_RAYS(BOXES, 1, 2);
    RB_COUNT_BYTES(TREE_BYTES, sizeof *node);
    if (visit_a && visit_b) {
        stack[depth++] = (struct visit){node->child[far], node->count[far], far ? b.near : a.near};
        visit_a = far, visit_b = !far;
    }
    if (visit_a)
        stack[depth++] = (struct visit){node->child[0], node->count[0], a.near};
    else if (visit_b)
        stack[depth++] = (struct visit){node->child[1], node->count[1], b.near};
    RB_COUNT_DEPTH(depth);
    return depth;
}

static struct rb_hit closest(const struct rb_world *world, const struct rb_ray *ray)
{
    const struct rb_bvh *bvh = world->bvh;
    struct rb_hit best = rb_planes_closest(world->scene, ray), hit;
    struct visit stack[RB_BVH_DEPTH_MAX + 2];
    int depth = 0;
    if (bvh->node_count)
        stack[depth++] = (struct visit){0, 0, 0.0f};
    while (depth > 0) {
        struct visit visit = stack[--depth];
        if (visit.near > best.t)
            continue;
        if (visit.count == 0)
            depth = push_children(&bvh->nodes[visit.child], ray, best.t, stack, depth);
        RB_COUNT_BYTES(TREE_BYTES, visit.count * sizeof *bvh->refs);
        for (uint32_t i = 0; i < visit.count; i++)
            if (rb_primitive_hit(world->scene, bvh->refs[visit.child + i], ray, &hit) &&
                rb_hit_closer(&hit, &best))
                best = hit;
    }
    return best;
}

static bool any(const struct rb_world *world, const struct rb_ray *ray, float distance)
{
    const struct rb_bvh *bvh = world->bvh;
    struct visit stack[RB_BVH_DEPTH_MAX + 2];
    int depth = 0;
    if (rb_planes_any(world->scene, ray, distance))
        return true;
    if (bvh->node_count)
        stack[depth++] = (struct visit){0, 0, 0.0f};
    while (depth > 0) {
        struct visit visit = stack[--depth];
        if (visit.count == 0)
            depth = push_children(&bvh->nodes[visit.child], ray, distance, stack, depth);
        RB_COUNT_BYTES(TREE_BYTES, visit.count * sizeof *bvh->refs);
        for (uint32_t i = 0; i < visit.count; i++) {
            struct rb_hit hit;
            if (rb_primitive_hit(world->scene, bvh->refs[visit.child + i], ray, &hit) &&
                hit.t < distance)
                return true;
        }
    }
    return false;
}

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    trace_one_by_one(world, rays, hits, closest);
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    trace_shadow_one_by_one(world, shadows, any);
}
