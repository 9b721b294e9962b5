// The only allocator of the project: zeroed, cache-line aligned, overflow-checked, and able to fail
// on demand so that tests can walk through every out-of-memory path.
//
// All functions are thread-safe.
#ifndef RB_BASE_MEMORY_H
#define RB_BASE_MEMORY_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { RB_CACHE_LINE = 64 };

// `count` zeroed elements of `size` bytes, aligned to RB_CACHE_LINE. NULL when there is no memory.
// A count of 0 gives a valid pointer. Release with rb_free. Large arrays ask for huge pages, where
// the system leaves that to its programs (Linux: /sys/kernel/mm/transparent_hugepage/enabled).
void *rb_alloc(size_t count, size_t size);

// The same for arrays that remain empty for the most part, on small pages.
void *rb_alloc_sparse(size_t count, size_t size);

// Accepts NULL.
void rb_free(void *memory);

// A growing array: data, number of elements in use, room. Zero-initialised means empty.
struct rb_array {
    void *data;
    size_t count;
    size_t capacity;
};

// Room for `extra` more elements of `size` bytes; grows by doubling, keeps the content. False when
// there is no memory; the array is then unchanged.
bool rb_array_reserve(struct rb_array *array, size_t extra, size_t size);

// Appends a copy of the element at `element`.
bool rb_array_push(struct rb_array *array, const void *element, size_t size);

// Frees the data and empties the array.
void rb_array_release(struct rb_array *array);

// For tests: the n-th allocation from now on fails (1 = the next), once. 0 switches it off.
void rb_memory_fail_at(long n);

// Allocations made and not yet freed, of the whole process.
long rb_memory_live_count(void);

#endif
