#define _POSIX_C_SOURCE 200809L
#include "measure/clock.h"

#include <time.h>

uint64_t rb_clock_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static uint64_t start_ns, start_ticks;

void rb_clock_begin(void)
{
    start_ns = rb_clock_ns();
    start_ticks = rb_clock_ticks();
}

double rb_clock_ns_per_tick(void)
{
    static double ns_per_tick;
    if (ns_per_tick > 0)
        return ns_per_tick;
    if (start_ns == 0)
        rb_clock_begin();
    uint64_t end_ns;
    do
        end_ns = rb_clock_ns();
    while (end_ns - start_ns < 20000000);
    ns_per_tick = (double)(end_ns - start_ns) / (double)(rb_clock_ticks() - start_ticks);
    return ns_per_tick;
}
