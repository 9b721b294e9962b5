// The trees of both sides over a scene: our wide one, and Embree's as the targets mean it, of
// medium quality with spheres as user geometry. Built in turn, as often as an interval needs.
#include "bench/versus/versus.h"

#include "accel/wide.h"
#include "bench/versus/pages.h"
#include "embree/embree.h"

enum { BUILDS = 6 };
static const double LEVEL = 0.95;

static enum rb_status build_ours(const struct rb_scene *scene, struct rb_versus_trees *trees,
                                 double *ns, struct rb_error *error)
{
    struct rb_wide wide;
    uint64_t start_ns = rb_clock_ns();
    enum rb_status status = rb_wide_build(scene, trees->threads, &wide, error);
    *ns = (double)(rb_clock_ns() - start_ns);
    trees->bytes[0] = wide.bytes;
    trees->huge_pct[0] = rb_versus_huge_pct();
    rb_wide_free(&wide);
    return status;
}

static enum rb_status build_embree(const struct rb_scene *scene, struct rb_versus_trees *trees,
                                   double *ns, struct rb_error *error)
{
    static const struct rb_embree_tree medium = {.high = false};
    struct rb_embree_cost cost = {0};
    struct rb_embree *embree;
    enum rb_status status = rb_embree_build(scene, &medium, trees->threads, &embree, &cost, error);
    *ns = (double)cost.build_ns;
    trees->bytes[1] = cost.bytes;
    trees->huge_pct[1] = rb_versus_huge_pct();
    rb_embree_free(embree);
    return status;
}

enum rb_status rb_versus_build(const struct rb_scene *scene, int threads,
                               struct rb_versus_trees *trees, struct rb_error *error)
{
    double ns[2][BUILDS];
    enum rb_status status = RB_OK;
    *trees = (struct rb_versus_trees){.threads = threads};
    for (int i = 0; i < 2 * BUILDS && status == RB_OK; i++) {
        int build = i / 2, side = (i + build) % 2;
        status = (side ? build_embree : build_ours)(scene, trees, &ns[side][build], error);
    }
    if (status)
        return status;
    trees->ratio = rb_stats_paired_ratio(ns[0], ns[1], BUILDS, LEVEL);
    for (int side = 0; side < 2; side++)
        trees->build_ns[side] = rb_stats_median_at(ns[side], BUILDS, LEVEL).value;
    return RB_OK;
}
