#define _GNU_SOURCE
#include "measure/affinity.h"

#ifdef __linux__
#include <sched.h>
#include <stddef.h>

int rb_affinity_list(int *cpus, int room)
{
    cpu_set_t set;
    int count = 0;
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        return 0;
    for (int cpu = 0; cpu < CPU_SETSIZE && count < room; cpu++)
        if (CPU_ISSET((size_t)cpu, &set))
            cpus[count++] = cpu;
    return count;
}

int rb_affinity_pin(int cpu)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    if (cpu < 0 || cpu >= CPU_SETSIZE)
        return -1;
    CPU_SET((size_t)cpu, &set);
    return sched_setaffinity(0, sizeof set, &set) == 0 ? cpu : -1;
}

int rb_affinity_current(void)
{
    return sched_getcpu();
}
#else
int rb_affinity_list(int *cpus, int room)
{
    (void)cpus, (void)room;
    return 0;
}

int rb_affinity_pin(int cpu)
{
    (void)cpu;
    return -1;
}

int rb_affinity_current(void)
{
    return -1;
}
#endif
