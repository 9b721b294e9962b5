#include "base/memory.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static atomic_long fail_countdown;
static atomic_long live_count;

static bool must_fail(void)
{
    if (atomic_load_explicit(&fail_countdown, memory_order_relaxed) == 0)
        return false;
    return atomic_fetch_sub(&fail_countdown, 1) == 1;
}

void *rb_alloc(size_t count, size_t size)
{
    if (size != 0 && count > (SIZE_MAX - RB_CACHE_LINE) / size)
        return NULL;
    size_t bytes = count * size;
    bytes = (bytes + RB_CACHE_LINE - 1) / RB_CACHE_LINE * RB_CACHE_LINE;
    if (bytes == 0)
        bytes = RB_CACHE_LINE;
    void *memory = must_fail() ? NULL : aligned_alloc(RB_CACHE_LINE, bytes);
    if (!memory)
        return NULL;
    memset(memory, 0, bytes);
    atomic_fetch_add_explicit(&live_count, 1, memory_order_relaxed);
    return memory;
}

void rb_free(void *memory)
{
    if (!memory)
        return;
    atomic_fetch_sub_explicit(&live_count, 1, memory_order_relaxed);
    free(memory);
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
