// In place of the other files where the library is not found (Makefile).
#include "embree/embree.h"

const char *rb_embree_version(void)
{
    return NULL;
}

enum rb_status rb_embree_build(const struct rb_scene *scene, const struct rb_embree_tree *how,
                               int threads, struct rb_embree **embree, struct rb_embree_cost *cost,
                               struct rb_error *error)
{
    (void)scene, (void)how, (void)threads, (void)cost;
    *embree = NULL;
    return rb_error_set(error, RB_INVALID, "this program was built without libembree");
}

void rb_embree_free(struct rb_embree *embree)
{
    (void)embree;
}
