// Hardware counters and energy: which devices there are, and whether they count for us. Only
// counting tells; a counter that opens may still never be scheduled.
#define _GNU_SOURCE
#include "bench/machine/machine_read.h"

#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEVICES "/sys/bus/event_source/devices"
#define POWER   DEVICES "/power"

#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/syscall.h>

static const char *reason(int cause)
{
    static const struct {
        int cause;
        const char *text;
    } reasons[] = {
        {EACCES, "forbidden: perf_event_paranoid, or a container's filter"},
        {EPERM, "forbidden: perf_event_paranoid, or a container's filter"},
        {ENOENT, "no such counter on this machine"},
        {ENODEV, "no such counter on this machine"},
        {EOPNOTSUPP, "no such counter on this machine"},
        {ENOSYS, "perf_event_open is not there"},
    };
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].cause == cause)
            return reasons[i].text;
    return strerror(cause);
}

// Counts an event for a moment, of this thread or, with cpu >= 0, of that whole CPU.
static void try_event(uint32_t type, uint64_t config, int cpu, struct rb_fact *fact)
{
    struct perf_event_attr attributes = {
        .type = type,
        .size = sizeof attributes,
        .config = config,
        .read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING,
        .exclude_kernel = cpu < 0,
        .exclude_hv = cpu < 0,
    };
    uint64_t counts[3] = {0}; // value, time enabled, time running
    pid_t pid = cpu < 0 ? 0 : -1;
    int fd = (int)syscall(SYS_perf_event_open, &attributes, pid, cpu, -1, PERF_FLAG_FD_CLOEXEC);
    if (fd < 0) {
        rb_fact_bool(fact, false, reason(errno));
        return;
    }
    for (volatile int work = 0; work < 100000; work++)
        ;
    bool counted = read(fd, counts, sizeof counts) == (ssize_t)sizeof counts && counts[2] > 0;
    close(fd);
    rb_fact_bool(fact, counted, counted ? "" : "opens, but never counts");
}
#else
enum { PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES };

static void try_event(uint32_t type, uint64_t config, int cpu, struct rb_fact *fact)
{
    (void)type, (void)config, (void)cpu;
    rb_fact_unknown(fact, "perf events are Linux's");
}
#endif

void rb_machine_cycles(const char *root, const char *path, struct rb_fact *fact)
{
    (void)path;
    if (root[0])
        rb_fact_unknown(fact, "not tried: a copy of a machine");
    else
        try_event(PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES, -1, fact);
}

// "cpu" on x86, "cpu_core" and "cpu_atom" on hybrids, "armv8_..." on AArch64.
void rb_machine_pmu(const char *root, const char *path, struct rb_fact *fact)
{
    char whole[RB_MACHINE_PATH_MAX], best[64] = "";
    (void)path;
    int length = snprintf(whole, sizeof whole, "%s" DEVICES, root);
    DIR *folder = length < (int)sizeof whole ? opendir(whole) : NULL;
    if (!folder) {
        rb_fact_unknown(fact, "cannot read " DEVICES);
        return;
    }
    for (struct dirent *entry; (entry = readdir(folder));) {
        const char *name = entry->d_name;
        bool hardware = strcmp(name, "cpu") == 0 || strcmp(name, "cpu_core") == 0 ||
                        strncmp(name, "armv8", 5) == 0;
        if (hardware && (!best[0] || strcmp(name, best) < 0)) // the same one every time
            snprintf(best, sizeof best, "%.63s", name);
    }
    closedir(folder);
    rb_fact_text(fact, best[0] ? best : "none");
}

void rb_machine_rapl_perf(const char *root, const char *path, struct rb_fact *fact)
{
    char event[64], cpus[128];
    double type;
    (void)path;
    if (!rb_machine_number(root, POWER "/type", &type)) {
        rb_fact_bool(fact, false, "no " POWER);
        return;
    }
    rb_machine_line(root, POWER "/events/energy-pkg", event, sizeof event);
    rb_machine_line(root, POWER "/cpumask", cpus, sizeof cpus);
    if (strncmp(event, "event=", 6) != 0)
        rb_fact_bool(fact, false, "no energy-pkg in " POWER "/events");
    else if (root[0])
        rb_fact_unknown(fact, "not tried: a copy of a machine");
    else
        try_event((uint32_t)type, strtoull(event + 6, NULL, 0), atoi(cpus), fact);
}

void rb_machine_rapl_powercap(const char *root, const char *path, struct rb_fact *fact)
{
    static const char file[] = "/sys/class/powercap/intel-rapl:0/energy_uj"; // AMD's as well
    char whole[RB_MACHINE_PATH_MAX];
    double energy_uj;
    (void)path;
    snprintf(whole, sizeof whole, "%s%s", root, file);
    bool read = rb_machine_number(root, file, &energy_uj);
    if (read && energy_uj > 0)
        rb_fact_bool(fact, true, "");
    else if (read)
        rb_fact_bool(fact, false, "energy_uj reads 0");
    else if (access(whole, F_OK) == 0)
        rb_fact_bool(fact, false, "energy_uj is not readable for this user");
    else
        rb_fact_bool(fact, false, "no zone in /sys/class/powercap");
}
