#include "measure/simulate.h"

#include <stdio.h>

#if RB_VALGRIND
#include <valgrind/callgrind.h>
#else
#define RUNNING_ON_VALGRIND             0
#define CALLGRIND_START_INSTRUMENTATION ((void)0)
#define CALLGRIND_TOGGLE_COLLECT        ((void)0)
#define CALLGRIND_ZERO_STATS            ((void)0)
#define CALLGRIND_DUMP_STATS_AT(label)  ((void)(label))
#endif

static bool collecting;

bool rb_simulate_built(void)
{
    return RB_VALGRIND;
}

bool rb_simulate_running(void)
{
    return RUNNING_ON_VALGRIND != 0;
}

void rb_simulate_start(void)
{
    CALLGRIND_START_INSTRUMENTATION;
}

static void toggle(void)
{
    CALLGRIND_TOGGLE_COLLECT;
    collecting = !collecting;
}

void rb_simulate_begin(void)
{
    CALLGRIND_ZERO_STATS;
    toggle();
}

// The digits that end before `end`, all of them. By hand: printf would push the kernels' data out
// of the simulated L1 cache between any two stages.
static void put_hex(char *end, uint64_t number)
{
    for (; end[-1] != '='; number >>= 4)
        *--end = "0123456789abcdef"[number & 15];
}

void rb_simulate_lap(enum rb_stage stage, int bounce, uint64_t rays)
{
    static char label[] = RB_SIMULATE_LAP;
    enum { STAGE_END = sizeof "stage=0" - 1, BOUNCE_END = sizeof "stage=0 bounce=00" - 1 };
    if (!collecting)
        return;
    toggle();
    put_hex(label + STAGE_END, (uint64_t)stage);
    put_hex(label + BOUNCE_END, (uint64_t)bounce);
    put_hex(label + sizeof label - 1, rays);
    CALLGRIND_DUMP_STATS_AT(label);
    toggle();
}

void rb_simulate_stop(void)
{
    if (collecting)
        toggle();
    CALLGRIND_ZERO_STATS;
}

void rb_simulate_end(uint64_t hits, const char *row)
{
    char label[80];
    snprintf(label, sizeof label, RB_SIMULATE_END, (unsigned long long)hits, row);
    CALLGRIND_DUMP_STATS_AT(label);
}
