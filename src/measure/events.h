// Performance events between the laps of a thread, by kernel and bounce.
//
// A group of events is opened in the thread that it counts and stays enabled; each lap reads it
// once and books the difference. Reading is by rdpmc where the kernel allows that for every event
// of the group, else by read(2). Nothing is multiplexed: the group is pinned, so that it counts all
// the time or not at all, and what happened is told apart (rb_event_state).
//
// Reading costs 0.2 to 2 us. That is measured in each thread and kept with the counts, and so is
// what a lap counts that has nothing in it, for those who subtract it.
//
// Sources: perf_event_open(2); tools/lib/perf/mmap.c of Linux, for reading in user space.
#ifndef RB_MEASURE_EVENTS_H
#define RB_MEASURE_EVENTS_H

#include "measure/probe.h"

#include <stdbool.h>

enum { RB_EVENTS_MAX = 12 };

// An event, as perf_event_open wants it.
struct rb_event {
    uint32_t type;
    uint64_t config, config1, config2;
    bool kernel; // counts what the kernel does for the thread as well
};

// Counted together; the first one leads.
struct rb_event_group {
    struct rb_event of[RB_EVENTS_MAX];
    int count;
    bool by_read; // not by rdpmc, which would give something else
};

// What became of an event, from good to bad.
enum rb_event_state {
    RB_EVENT_UNTRIED,
    RB_EVENT_COUNTED,
    RB_EVENT_MULTIPLEXED, // a part of the time: others had the counters in between
    RB_EVENT_UNSCHEDULED, // never got a counter, or lost it
    RB_EVENT_UNFIT,       // the group is refused as a combination, or there are no descriptors
    RB_EVENT_ABSENT,      // the processor, or the virtual machine, has no such event
    RB_EVENT_FORBIDDEN,
    RB_EVENT_NO_PERF, // no such system call, or a filter on it
    RB_EVENT_STATE_COUNT,
};

// What it means and what to do about it, in a line without a full stop.
const char *rb_event_state_text(enum rb_event_state state);

// What a failed opening means, by its errno.
enum rb_event_state rb_event_state_of(int problem);

// Of one thread, or of several together.
struct rb_event_table {
    uint64_t count[RB_STAGE_COUNT][RB_BOUNCE_MAX][RB_EVENTS_MAX];
    uint64_t laps[RB_STAGE_COUNT][RB_BOUNCE_MAX];
    enum rb_event_state state[RB_EVENTS_MAX]; // of several threads: the worst
    bool in_user_space;                       // read by rdpmc, in all threads
    // Of one lap with nothing in it, the least of 100, and of several threads the most:
    uint64_t cost_ticks, empty[RB_EVENTS_MAX];
};

void rb_event_table_add(struct rb_event_table *to, const struct rb_event_table *from);

// One thread's; no other may touch it.
struct rb_event_counter {
    struct rb_event_table table;
    int count;                       // of events that could be opened
    int index[RB_EVENTS_MAX];        // of each of them in the group
    int fd[RB_EVENTS_MAX];           // the first one leads
    const void *page[RB_EVENTS_MAX]; // mapped, where all of them are to be read by rdpmc
    uint64_t last[RB_EVENTS_MAX];
    uint64_t enabled, running; // ns, when it began
};

// Opens what can be opened for the calling thread, measures what a lap costs, and begins the first
// lap. Never fails: the states say what is wrong. To be closed by the same thread.
void rb_events_open(struct rb_event_counter *counter, const struct rb_event_group *group);

// Books what was counted since the last lap on a stage.
void rb_events_lap(struct rb_event_counter *counter, enum rb_stage stage, int bounce);

// Decides the states and closes the group.
void rb_events_close(struct rb_event_counter *counter);

#endif
