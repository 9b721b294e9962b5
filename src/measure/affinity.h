// Which processors a process may run on, and holding it on one. Linux; elsewhere nothing is pinned.
#ifndef RB_MEASURE_AFFINITY_H
#define RB_MEASURE_AFFINITY_H

// Fills `cpus` with the numbers of the processors this process may use, ascending, at most `room`.
// Returns how many there are; 0 where the system does not tell.
int rb_affinity_list(int *cpus, int room);

// Holds the calling thread, and those it will start, on one processor. Returns its number, or -1 if
// the system does not let us.
int rb_affinity_pin(int cpu);

// The processor the calling thread is on, or -1.
int rb_affinity_current(void);

#endif
