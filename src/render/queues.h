// The queues of one worker, in one block of memory sized for the second-level cache.
//
// Bounce d has a ray queue of its own; hits, surfaces and shadow rays are shared by all bounces,
// because a batch is finished with them before its children are traced. A batch of at most `batch`
// rays has at most twice as many children, which are traced as one or two batches: queues split,
// they never grow. Not thread-safe; one worker owns it.
#ifndef RB_RENDER_QUEUES_H
#define RB_RENDER_QUEUES_H

#include "base/status.h"
#include "kernels/part.h"

// Shadow rays wait until RB_SHADOW_BATCHES batches of them are together or the lights are done.
enum { RB_BATCH_MAX = 4096, RB_SHADOW_BATCHES = 2 };

struct rb_queues {
    uint32_t batch; // most rays a kernel gets at once
    struct rb_rays rays[RB_DEPTH_MAX];
    struct rb_hits hits;
    struct rb_surfaces surfaces;
    struct rb_shadows shadows;
    uint32_t *cost; // of each ray of a queue, where costs are asked for; zero between two stages
    void *memory;
    size_t bytes;
};

// `depth` levels of batches of `batch` rays. Release with rb_queues_free.
enum rb_status rb_queues_alloc(struct rb_queues *queues, uint32_t batch, int depth,
                               struct rb_error *error);
void rb_queues_free(struct rb_queues *queues);

// The arrays of a queue, for whoever treats them all alike: in the order in which they lie in
// memory, and in files of rays.
struct rb_member {
    const char *name;
    void *pointer; // to the pointer in the queue
    size_t size;   // of an element
};
enum { RB_MEMBERS_MAX = 16 };
struct rb_members {
    struct rb_member member[RB_MEMBERS_MAX];
    size_t count;
};
struct rb_members rb_rays_members(struct rb_rays *rays);
struct rb_members rb_hits_members(struct rb_hits *hits);
struct rb_members rb_shadows_members(struct rb_shadows *shadows);

// Gives every array room for `capacity` elements from `memory` on, which begins a cache line;
// returns the bytes taken. With memory NULL it only counts. The capacity is a multiple of
// RB_LANES_MAX.
size_t rb_members_place(const struct rb_members *members, char *memory, uint32_t capacity);

// Where an array begins.
char *rb_member_array(const struct rb_member *member);

// Moves `count` rays from index `from` down to index `to`.
void rb_rays_move(struct rb_rays *rays, uint32_t to, uint32_t from, uint32_t count);

#endif
