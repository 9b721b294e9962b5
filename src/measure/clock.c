#define _POSIX_C_SOURCE 200809L
#include "measure/clock.h"

#include <time.h>

uint64_t rb_clock_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

struct moment {
    uint64_t ns, ticks;
};

// Reads both clocks at one moment: of several tries the quickest, in case of a preemption between
// the two.
static struct moment read_both(void)
{
    struct moment best = {0, 0};
    uint64_t least = UINT64_MAX;
    for (int i = 0; i < 8; i++) {
        uint64_t before = rb_clock_ticks(), ns = rb_clock_ns(), after = rb_clock_ticks();
        if (after - before < least) {
            least = after - before;
            best = (struct moment){ns, before + least / 2};
        }
    }
    return best;
}

static struct moment start;

void rb_clock_begin(void)
{
    start = read_both();
}

double rb_clock_ns_per_tick(void)
{
    static double ns_per_tick;
    if (ns_per_tick > 0)
        return ns_per_tick;
    if (start.ns == 0)
        rb_clock_begin();
    while (rb_clock_ns() - start.ns < 20000000)
        ;
    struct moment end = read_both();
    ns_per_tick = (double)(end.ns - start.ns) / (double)(end.ticks - start.ticks);
    return ns_per_tick;
}
