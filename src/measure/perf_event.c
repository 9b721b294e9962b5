#define _GNU_SOURCE
#include "measure/perf_event.h"

#include <errno.h>
#include <unistd.h>

#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>

static int open_event(struct perf_event_attr *attributes, int pid, int cpu, int group)
{
    attributes->size = sizeof *attributes;
    return (int)syscall(SYS_perf_event_open, attributes, pid, cpu, group, PERF_FLAG_FD_CLOEXEC);
}

static int enable(int fd)
{
    return ioctl(fd, PERF_EVENT_IOC_ENABLE, PERF_IOC_FLAG_GROUP);
}

static size_t page_bytes(void)
{
    return (size_t)sysconf(_SC_PAGESIZE);
}

static const void *map(int fd)
{
    void *page = mmap(NULL, page_bytes(), PROT_READ, MAP_SHARED, fd, 0);
    return page == MAP_FAILED ? NULL : page;
}

static void unmap(const void *page)
{
    munmap((void *)page, page_bytes());
}
#else
static int open_event(struct perf_event_attr *attributes, int pid, int cpu, int group)
{
    (void)attributes, (void)pid, (void)cpu, (void)group;
    errno = ENOSYS;
    return -1;
}

static int enable(int fd)
{
    (void)fd;
    return -1;
}

static const void *map(int fd)
{
    (void)fd;
    return NULL;
}

static void unmap(const void *page)
{
    (void)page;
}
#endif

static long read_event(int fd, void *to, size_t bytes)
{
    return read(fd, to, bytes);
}

static uint64_t read_counter(uint32_t counter)
{
#if defined(__x86_64__)
    uint32_t low, high;
    __asm__ volatile("rdpmc" : "=a"(low), "=d"(high) : "c"(counter));
    return (uint64_t)high << 32 | low;
#else
    return counter; // never asked for: see events.c
#endif
}

static void close_event(int fd)
{
    close(fd);
}

const struct rb_perf_system rb_perf_kernel = {
    .open = open_event,
    .enable = enable,
    .read = read_event,
    .map = map,
    .unmap = unmap,
    .read_counter = read_counter,
    .close = close_event,
};

const struct rb_perf_system *rb_perf = &rb_perf_kernel;
