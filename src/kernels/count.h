// Exact counts of what the kernels do: why they cost what they cost, on any machine, the same in
// every run and whatever the number of threads.
//
// Every kernel file is compiled a second time with -DRB_COUNTING into a twin of the kernel set that
// counts (Makefile, kernel.h). The macros below are the places where; in the plain kernels they are
// nothing. Counts go to the calling thread's own rb_counting, which whoever called the kernel takes
// from there.
#ifndef RB_KERNELS_COUNT_H
#define RB_KERNELS_COUNT_H

#include <stdbool.h>
#include <stdint.h>

// "Rays" below are rays that take part: the lanes of a packet that are active. A packet that visits
// a node for 3 of its 8 rays counts 3 nodes, 1 step, 3 active lanes and 8 possible ones. Where the
// lanes are 8 boxes or primitives, the active ones are those there are.
enum rb_counter {
    RB_COUNT_NODES,           // inner nodes visited, by rays
    RB_COUNT_BOXES,           // boxes tested, by rays: of a node's children, and a primitive's own
    RB_COUNT_SPHERES,         // primitives tested, by rays: those whose own box the ray passes;
    RB_COUNT_TRIANGLES,       // or all of a block of the wide tree, whose boxes come second
    RB_COUNT_CONES,           //
    RB_COUNT_PLANES,          //
    RB_COUNT_HITS,            // rays that hit something (trace)
    RB_COUNT_OCCLUDED,        // rays that are occluded (trace_shadow)
    RB_COUNT_STEPS,           // nodes, primitives, surfaces handled by one operation for all lanes
    RB_COUNT_LANES_ACTIVE,    // in these steps: lanes whose result was needed
    RB_COUNT_LANES_POSSIBLE,  // and lanes there were
    RB_COUNT_TREE_BYTES,      // read from nodes and leaves, once a step
    RB_COUNT_PRIMITIVE_BYTES, // read from primitives, once a step
    RB_COUNT_STACK,           // deepest stack of a ray's traversal, entries, summed over rays
    RB_COUNT_SHADINGS,        // surface points lit by a light sample
    RB_COUNTER_COUNT
};

struct rb_counts {
    uint64_t of[RB_COUNTER_COUNT];
    uint64_t stack_max; // deepest stack of all rays, entries
};

extern const char *const rb_counter_names[RB_COUNTER_COUNT]; // "nodes"

// What a thread is counting.
struct rb_counting {
    struct rb_counts counts;
    uint32_t first;         // index of the ray in lane 0
    const uint32_t *places; // where rays of that index are in their queue; NULL: `base` further
    uint32_t base;
    uint64_t deepest; // stack of the running traversal
    uint32_t *cost;   // not NULL: what `chosen` counts is added up here, by ray
    uint32_t chosen;  // bit c: counter c
};
extern _Thread_local struct rb_counting rb_counting;

// Adds what the calling thread has counted since the last call to `to`.
void rb_counts_take(struct rb_counts *to);
bool rb_counter_is_of_rays(enum rb_counter counter);           // or of steps, which rays share
double rb_counts_lane_use_pct(const struct rb_counts *counts); // NaN if there were no steps
void rb_counts_add(struct rb_counts *to, const struct rb_counts *from);

// What the macros below do; bit i of `bits` is the ray in lane i.
void rb_counting_begin(uint32_t index);
void rb_counting_rays(enum rb_counter counter, unsigned bits, uint32_t each);
void rb_counting_step(unsigned bits, uint32_t lanes);
void rb_counting_depth(uint64_t depth);
void rb_counting_end(unsigned bits);

#ifdef RB_COUNTING
#define RB_COUNTS      1
#define RB_COUNT(what) ((void)(what))
#else
#define RB_COUNTS      0                            // for loops that do nothing else
#define RB_COUNT(what) (0 ? (void)(what) : (void)0) // compiled, never run
#endif

// The kernel that is called next gets rays that have such places in their queue, or those from
// `base` on. Or: the work that follows is that of the rays from `index` on, the first of them in
// lane 0; and it is done, for the rays of `bits`.
#define RB_COUNT_PLACES(at)   RB_COUNT(rb_counting.places = (at))
#define RB_COUNT_BASE(from)   RB_COUNT(rb_counting.base = (from))
#define RB_COUNT_BEGIN(index) RB_COUNT(rb_counting_begin(index))
#define RB_COUNT_END(bits)    RB_COUNT(rb_counting_end(bits))

// The work that follows is that of the rays from `index` on, but has begun before; that of the ray
// `lane` lanes further.
#define RB_COUNT_AT(index)  RB_COUNT(rb_counting.first = (index))
#define RB_COUNT_LANE(lane) RB_COUNT(rb_counting.first += (uint32_t)(lane))

// `each` more for every ray of `bits`; an operation of `lanes` lanes for the rays of `bits`; bytes;
// entries on the traversal stack.
#define RB_COUNT_RAYS(counter, bits, each)                                                         \
    RB_COUNT(rb_counting_rays(RB_COUNT_##counter, (bits), (each)))
#define RB_COUNT_STEP(bits, lanes) RB_COUNT(rb_counting_step((bits), (lanes)))
#define RB_COUNT_BYTES(counter, bytes)                                                             \
    RB_COUNT(rb_counting.counts.of[RB_COUNT_##counter] += (bytes))
#define RB_COUNT_DEPTH(depth) RB_COUNT(rb_counting_depth((uint64_t)(depth)))

#endif
