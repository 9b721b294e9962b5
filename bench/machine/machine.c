// The table of facts, and the readers of single files. Most facts are one file and one of a few
// ways to read it; the others have readers in machine_*.c.
#define _POSIX_C_SOURCE 200809L
#include "bench/machine/machine.h"

#include "bench/machine/machine_read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

static void read_text(const char *root, const char *path, struct rb_fact *fact)
{
    char line[RB_MACHINE_LINE_MAX];
    if (rb_machine_line(root, path, line, sizeof line) && line[0])
        rb_fact_text(fact, line);
    else
        rb_fact_unknown(fact, "cannot read %s", path);
}

static void read_number(const char *root, const char *path, struct rb_fact *fact)
{
    double number;
    if (rb_machine_number(root, path, &number))
        rb_fact_number(fact, number);
    else
        rb_fact_unknown(fact, "no number in %s", path);
}

static void read_flag(const char *root, const char *path, struct rb_fact *fact)
{
    double number;
    if (rb_machine_number(root, path, &number))
        rb_fact_bool(fact, number > 0, "");
    else
        rb_fact_unknown(fact, "no number in %s", path);
}

static void read_list_count(const char *root, const char *path, struct rb_fact *fact)
{
    char line[RB_MACHINE_LINE_MAX];
    int count = rb_machine_line(root, path, line, sizeof line) ? rb_machine_list_count(line) : 0;
    if (count)
        rb_fact_number(fact, count);
    else
        rb_fact_unknown(fact, "no list in %s", path);
}

static void read_isolated(const char *root, const char *path, struct rb_fact *fact)
{
    char line[RB_MACHINE_LINE_MAX];
    if (rb_machine_line(root, path, line, sizeof line))
        rb_fact_text(fact, line[0] ? line : "none");
    else
        rb_fact_unknown(fact, "cannot read %s", path);
}

// "always [madvise] never": the word in brackets.
static void read_choice(const char *root, const char *path, struct rb_fact *fact)
{
    char line[256];
    rb_machine_line(root, path, line, sizeof line);
    char *open = strchr(line, '['), *close = open ? strchr(open, ']') : NULL;
    if (!close) {
        rb_fact_unknown(fact, "no choice in %s", path);
        return;
    }
    *close = '\0';
    rb_fact_text(fact, open + 1);
}

static void read_os(const char *root, const char *path, struct rb_fact *fact)
{
    char value[RB_FACT_TEXT_MAX];
    if (!rb_machine_value(root, path, "PRETTY_NAME", value, sizeof value)) {
        rb_fact_unknown(fact, "no PRETTY_NAME in %s", path);
        return;
    }
    char *name = value + (value[0] == '"');
    name[strcspn(name, "\"")] = '\0';
    rb_fact_text(fact, name);
}

static void read_arch(const char *root, const char *path, struct rb_fact *fact)
{
    struct utsname system;
    read_text(root, path, fact); // since Linux 6.1
    if (fact->kind == RB_FACT_IS_UNKNOWN && !root[0] && uname(&system) >= 0)
        rb_fact_text(fact, system.machine);
}

// "0.98 0.78 0.71 1/87 16330": load averages, runnable over all threads, the last process.
static void read_runnable(const char *root, const char *path, struct rb_fact *fact)
{
    char line[128];
    int runnable;
    rb_machine_line(root, path, line, sizeof line);
    if (sscanf(line, "%*s %*s %*s %9d/", &runnable) == 1)
        rb_fact_number(fact, runnable);
    else
        rb_fact_unknown(fact, "%s has no count of runnable threads", path);
}

// "cpu user nice system idle iowait irq softirq steal guest guest_nice" in ticks; the guests are
// part of user and nice.
static void read_steal(const char *root, const char *path, struct rb_fact *fact)
{
    char value[512], *at = value, *end = value;
    double total = 0, ticks = 0;
    int fields = 0;
    rb_machine_value(root, path, "cpu", value, sizeof value);
    for (; fields < 8; fields++, at = end) {
        ticks = (double)strtoull(at, &end, 10);
        if (end == at)
            break;
        total += ticks;
    }
    if (fields == 8 && total > 0)
        rb_fact_number(fact, 100 * ticks / total);
    else
        rb_fact_unknown(fact, "%s does not count steal", path);
}

static bool memory_bytes(const char *root, const char *key, double *bytes)
{
    char value[64], *end;
    if (!rb_machine_value(root, "/proc/meminfo", key, value, sizeof value))
        return false;
    *bytes = 1024.0 * (double)strtoull(value, &end, 10);
    return end != value;
}

static void read_memory(const char *root, const char *key, struct rb_fact *fact)
{
    double bytes;
    if (memory_bytes(root, key, &bytes))
        rb_fact_number(fact, bytes);
    else
        rb_fact_unknown(fact, "no %s in /proc/meminfo", key);
}

static void read_swap_used(const char *root, const char *key, struct rb_fact *fact)
{
    double total, unused;
    if (memory_bytes(root, "SwapTotal", &total) && memory_bytes(root, key, &unused))
        rb_fact_number(fact, total - unused);
    else
        rb_fact_unknown(fact, "no %s in /proc/meminfo", key);
}

static void read_cpuinfo(const char *root, const char *keys, struct rb_fact *fact)
{
    char value[RB_FACT_TEXT_MAX], x86_key[32];
    size_t length = strcspn(keys, "|"); // "key on x86|key on AArch64"
    snprintf(x86_key, sizeof x86_key, "%.*s", (int)length, keys);
    if (rb_machine_value(root, "/proc/cpuinfo", x86_key, value, sizeof value) ||
        (keys[length] &&
         rb_machine_value(root, "/proc/cpuinfo", keys + length + 1, value, sizeof value)))
        rb_fact_text(fact, value);
    else
        rb_fact_unknown(fact, "no %s in /proc/cpuinfo", x86_key);
}

static void read_affinity(const char *root, const char *path, struct rb_fact *fact)
{
    char value[RB_MACHINE_LINE_MAX];
    int count = rb_machine_value(root, path, "Cpus_allowed_list", value, sizeof value)
                    ? rb_machine_list_count(value)
                    : 0;
    if (count)
        rb_fact_number(fact, count);
    else
        rb_fact_unknown(fact, "no Cpus_allowed_list in %s", path);
}

#define SYS_CPU   "/sys/devices/system/cpu/"
#define SYS_CLOCK "/sys/devices/system/clocksource/clocksource0/"
#define SYS_FREQ  SYS_CPU "cpu0/cpufreq/"
#define SYS_THP   "/sys/kernel/mm/transparent_hugepage/"
#define PROC_KERN "/proc/sys/kernel/"

static const struct row {
    struct rb_fact_name name;
    void (*read)(const char *root, const char *path, struct rb_fact *fact);
    const char *path; // or what else the reader wants to know
} rows[RB_FACT_COUNT] = {
    [RB_FACT_HOST_NAME] = {{"host", "name"}, read_text, PROC_KERN "hostname"},
    [RB_FACT_OS] = {{"host", "os"}, read_os, "/etc/os-release"},
    [RB_FACT_KERNEL] = {{"host", "kernel"}, read_text, PROC_KERN "osrelease"},
    [RB_FACT_ARCH] = {{"host", "arch"}, read_arch, PROC_KERN "arch"},
    [RB_FACT_CPU_MODEL] = {{"host", "cpu_model"}, rb_machine_cpu_model, NULL},
    [RB_FACT_PRODUCT] = {{"host", "product"}, rb_machine_product, NULL},
    [RB_FACT_HYPERVISOR] = {{"host", "hypervisor"}, rb_machine_hypervisor, NULL},
    [RB_FACT_CPU_VENDOR] = {{"cpu", "vendor"}, read_cpuinfo, "vendor_id|CPU implementer"},
    [RB_FACT_CPU_FAMILY] = {{"cpu", "family"}, read_cpuinfo, "cpu family|CPU part"},
    [RB_FACT_CPU_MODEL_NUMBER] = {{"cpu", "model"}, read_cpuinfo, "model|CPU variant"},
    [RB_FACT_CPU_STEPPING] = {{"cpu", "stepping"}, read_cpuinfo, "stepping|CPU revision"},
    [RB_FACT_MICROCODE] = {{"cpu", "microcode"}, read_cpuinfo, "microcode"},
    [RB_FACT_CPUS] = {{"cpu", "cpus"}, read_list_count, SYS_CPU "online"},
    [RB_FACT_SOCKETS] = {{"cpu", "sockets"}, rb_machine_sockets, NULL},
    [RB_FACT_CORES] = {{"cpu", "cores"}, rb_machine_cores, NULL},
    [RB_FACT_THREADS_PER_CORE] = {{"cpu", "threads_per_core"}, rb_machine_threads_per_core, NULL},
    [RB_FACT_NUMA_NODES] = {{"cpu", "numa_nodes"},
                            read_list_count,
                            "/sys/devices/system/node/online"},
    [RB_FACT_ISOLATED] = {{"cpu", "isolated"}, read_isolated, SYS_CPU "isolated"},
    [RB_FACT_AFFINITY] = {{"cpu", "affinity_cpus"}, read_affinity, "/proc/self/status"},
    [RB_FACT_FREQUENCY_DRIVER] = {{"frequency", "driver"}, read_text, SYS_FREQ "scaling_driver"},
    [RB_FACT_GOVERNOR] = {{"frequency", "governor"}, rb_machine_governor, NULL},
    [RB_FACT_MIN_KHZ] = {{"frequency", "min_khz"}, read_number, SYS_FREQ "scaling_min_freq"},
    [RB_FACT_MAX_KHZ] = {{"frequency", "max_khz"}, read_number, SYS_FREQ "scaling_max_freq"},
    [RB_FACT_TURBO] = {{"frequency", "turbo"}, rb_machine_turbo, NULL},
    [RB_FACT_CLOCK_SOURCE] = {{"clock", "source"}, read_text, SYS_CLOCK "current_clocksource"},
    [RB_FACT_CLOCK_AVAILABLE] = {{"clock", "available"},
                                 read_text,
                                 SYS_CLOCK "available_clocksource"},
    [RB_FACT_TSC] = {{"clock", "invariant"}, rb_machine_tsc, NULL},
    [RB_FACT_LOAD_1M] = {{"load", "load_1m"}, read_number, "/proc/loadavg"},
    [RB_FACT_RUNNABLE] = {{"load", "runnable"}, read_runnable, "/proc/loadavg"},
    [RB_FACT_STEAL_PCT] = {{"load", "steal_pct_since_boot"}, read_steal, "/proc/stat"},
    [RB_FACT_MEMORY] = {{"memory", "total_bytes"}, read_memory, "MemTotal"},
    [RB_FACT_MEMORY_AVAILABLE] = {{"memory", "available_bytes"}, read_memory, "MemAvailable"},
    [RB_FACT_SWAP] = {{"memory", "swap_bytes"}, read_memory, "SwapTotal"},
    [RB_FACT_SWAP_USED] = {{"memory", "swap_used_bytes"}, read_swap_used, "SwapFree"},
    [RB_FACT_THP] = {{"memory", "transparent_hugepage"}, read_choice, SYS_THP "enabled"},
    [RB_FACT_ASLR] = {{"memory", "randomize_va_space"},
                      read_number,
                      PROC_KERN "randomize_va_space"},
    [RB_FACT_CGROUP_CPUS] = {{"cgroup", "cpus"}, rb_machine_cgroup_cpus, NULL},
    [RB_FACT_CGROUP_THROTTLED] = {{"cgroup", "nr_throttled"}, rb_machine_cgroup_throttled, NULL},
    [RB_FACT_PERF_PARANOID] = {{"counters", "perf_event_paranoid"},
                               read_number,
                               PROC_KERN "perf_event_paranoid"},
    [RB_FACT_NMI_WATCHDOG] = {{"counters", "nmi_watchdog"}, read_flag, PROC_KERN "nmi_watchdog"},
    [RB_FACT_PMU] = {{"counters", "pmu"}, rb_machine_pmu, NULL},
    [RB_FACT_CYCLES] = {{"counters", "cycles"}, rb_machine_cycles, NULL},
    [RB_FACT_RAPL_PERF] = {{"counters", "rapl_perf"}, rb_machine_rapl_perf, NULL},
    [RB_FACT_RAPL_POWERCAP] = {{"counters", "rapl_powercap"}, rb_machine_rapl_powercap, NULL},
};

void rb_machine_read(struct rb_machine *machine, const char *root)
{
    for (int id = 0; id < RB_FACT_COUNT; id++)
        rows[id].read(root, rows[id].path, &machine->facts[id]);
    machine->cache_count = rb_machine_caches(root, machine->caches);
}

struct rb_fact_name rb_machine_fact_name(enum rb_fact_id id)
{
    return rows[id].name;
}
