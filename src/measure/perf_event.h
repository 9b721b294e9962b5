// The system calls behind performance events, as a table, so that tests can be the kernel.
// Linux; elsewhere opening fails with ENOSYS.
#ifndef RB_MEASURE_PERF_EVENT_H
#define RB_MEASURE_PERF_EVENT_H

#include <stddef.h>
#include <stdint.h>

struct perf_event_attr;

struct rb_perf_system {
    // A descriptor, or -1 and errno. `pid` 0: the calling thread; -1: everybody on `cpu`. `group`:
    // the descriptor of a group's first event, or -1.
    int (*open)(struct perf_event_attr *attributes, int pid, int cpu, int group);
    int (*enable)(int fd);                        // the group
    long (*read)(int fd, void *to, size_t bytes); // as read(2)
    const void *(*map)(int fd);                   // struct perf_event_mmap_page, or NULL
    void (*unmap)(const void *page);
    uint64_t (*read_counter)(uint32_t counter); // the instruction rdpmc
    void (*close)(int fd);
};

extern const struct rb_perf_system rb_perf_kernel; // the real one
extern const struct rb_perf_system *rb_perf;       // the one in use; for tests to set

#endif
