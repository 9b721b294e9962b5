// Queues whose every array lies in memory of its own, right before a page that nobody may touch and
// behind another one: a kernel that reads or writes past the end crashes, and one that writes where
// it was not asked to is found out by a pattern.
//
// What a kernel may write: an appending one from the old count on, one that answers from element 0
// on; in both cases up to the number of elements it was promised room for, rounded up to
// RB_LANES_MAX. The guard page begins at the capacity rounded up to RB_LANES_MAX.
#ifndef TESTS_SUPPORT_GUARD_H
#define TESTS_SUPPORT_GUARD_H

#include "kernels/kernel.h"

#include <stdio.h>

// `bytes` usable bytes between two inaccessible pages. Ends the test program if it cannot be had.
struct guard {
    unsigned char *usable;
    size_t bytes; // a multiple of the page size
};
void guard_open(struct guard *guard, size_t bytes);
void guard_close(struct guard *guard);

// The last `bytes` bytes before the guard page.
void *guard_tail(const struct guard *guard, size_t bytes);

// On a crash prints what `describe` says, with the address, and ends the test program as failed.
void guard_catch_crashes(void (*describe)(void));

enum queue_kind { QUEUE_RAYS, QUEUE_HITS, QUEUE_SURFACES, QUEUE_SHADOWS };
enum { QUEUE_ARRAYS_MAX = 15 };

struct queue {
    enum queue_kind kind;
    union {
        struct rb_rays rays;
        struct rb_hits hits;
        struct rb_surfaces surfaces;
        struct rb_shadows shadows;
    };
    struct guard memory[QUEUE_ARRAYS_MAX];
    uint32_t before;   // elements it held when it was placed
    uint32_t promised; // elements a kernel may fill, `before` included
    uint32_t room;     // elements of every array
    unsigned char fill;
};

// Memory for up to `most` elements.
void queue_open(struct queue *queue, enum queue_kind kind, uint32_t most);
void queue_close(struct queue *queue);

// Room for `added` elements behind `before` ones, and a capacity of `spare` more than that.
// Everything is filled with bytes of `fill`.
void queue_place(struct queue *queue, uint32_t before, uint32_t added, uint32_t spare,
                 unsigned char fill);

// Hits have no count of their own: as many as promised.
uint32_t queue_count(const struct queue *queue);
void queue_set_count(struct queue *queue, uint32_t count);

// Copies elements [first, first + count) of `from` to element `at` on; counts stay as they are.
void queue_copy(struct queue *to, uint32_t at, const struct queue *from, uint32_t first,
                uint32_t count);

// What comes behind the count of an input up to a multiple of RB_LANES_MAX, which no result may
// depend on: bytes, or elements that look as valid as the others.
enum queue_padding { PADDING_ZEROS, PADDING_ONES, PADDING_PATTERN, PADDING_STALE, PADDING_COUNT };
void queue_pad(struct queue *queue, enum queue_padding padding);

// First element in which they differ, or the smaller count if only the counts differ, or RB_NONE.
// NaNs are equal, whatever their signs and payloads: which one an operation yields is up to the
// compiler's choice of operands, and none ever reaches an image.
uint32_t queue_difference(const struct queue *a, const struct queue *b);

// Name of an array that was written where it must not be, or NULL; *element counts from the start
// of the array and is negative before it.
const char *queue_trespass(const struct queue *queue, long *element);

// Element i as a C initialiser.
void queue_print(FILE *stream, const struct queue *queue, uint32_t i);

// A float as a C constant.
void float_print(FILE *stream, float x);

#endif
