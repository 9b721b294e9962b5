#define _DEFAULT_SOURCE
#include "base/memory.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

// Of one transparent huge page.
enum { HUGE_BYTES = 2 << 20 };

static atomic_long fail_countdown;
static atomic_long live_count;

static bool must_fail(void)
{
    if (atomic_load_explicit(&fail_countdown, memory_order_relaxed) == 0)
        return false;
    return atomic_fetch_sub(&fail_countdown, 1) == 1;
}

// Asks for huge pages: an array of some MiB has more of the small ones than a processor knows by
// heart, and each costs a page fault.
static void ask_for_huge_pages(char *block, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    size_t ahead = -(uintptr_t)block % HUGE_BYTES;
    if (bytes >= ahead + HUGE_BYTES)
        madvise(block + ahead, (bytes - ahead) / HUGE_BYTES * HUGE_BYTES, MADV_HUGEPAGE);
#else
    (void)block, (void)bytes;
#endif
}

// calloc has large blocks of pages that are zero already and appear when they are first written to,
// by whichever thread does it. Where a block began stands before what is aligned of it.
void *rb_alloc_sparse(size_t count, size_t size)
{
    if (size != 0 && count > (SIZE_MAX - 2 * RB_CACHE_LINE) / size)
        return NULL;
    size_t bytes = (count * size + RB_CACHE_LINE - 1) / RB_CACHE_LINE * RB_CACHE_LINE;
    char *block = must_fail() ? NULL : calloc(1, bytes + RB_CACHE_LINE);
    if (!block)
        return NULL;
    void **memory = (void **)(block + RB_CACHE_LINE - (uintptr_t)block % RB_CACHE_LINE);
    memory[-1] = block;
    atomic_fetch_add_explicit(&live_count, 1, memory_order_relaxed);
    return memory;
}

void *rb_alloc(size_t count, size_t size)
{
    void *memory = rb_alloc_sparse(count, size);
    if (memory)
        ask_for_huge_pages(memory, count * size);
    return memory;
}

void rb_free(void *memory)
{
    if (!memory)
        return;
    atomic_fetch_sub_explicit(&live_count, 1, memory_order_relaxed);
    free(((void **)memory)[-1]);
}

bool rb_array_reserve(struct rb_array *array, size_t extra, size_t size)
{
    if (extra <= array->capacity - array->count)
        return true;
    if (extra > SIZE_MAX - array->count || array->capacity > SIZE_MAX / 2)
        return false;
    size_t need = array->count + extra;
    size_t capacity = array->capacity * 2 > need ? array->capacity * 2 : need;
    if (capacity < 16)
        capacity = 16;
    void *data = rb_alloc(capacity, size);
    if (!data)
        return false;
    if (array->count)
        memcpy(data, array->data, array->count * size);
    rb_free(array->data);
    array->data = data;
    array->capacity = capacity;
    return true;
}

bool rb_array_push(struct rb_array *array, const void *element, size_t size)
{
    if (!rb_array_reserve(array, 1, size))
        return false;
    memcpy((char *)array->data + array->count * size, element, size);
    array->count++;
    return true;
}

void rb_array_release(struct rb_array *array)
{
    rb_free(array->data);
    *array = (struct rb_array){0};
}

void rb_memory_fail_at(long n)
{
    atomic_store(&fail_countdown, n);
}

long rb_memory_live_count(void)
{
    return atomic_load(&live_count);
}
