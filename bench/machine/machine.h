// Facts about the machine that decide what a timing is worth, read from /proc and /sys.
//
// Reading never fails: what cannot be read is unknown and carries the reason. Nothing is guessed,
// and 0 always means that 0 was read. Linux on x86-64 and AArch64 is what the readers know;
// elsewhere nearly everything is unknown.
#ifndef RB_MACHINE_MACHINE_H
#define RB_MACHINE_MACHINE_H

#include <stdbool.h>

enum rb_fact_id {
    RB_FACT_HOST_NAME,
    RB_FACT_OS,
    RB_FACT_KERNEL,
    RB_FACT_ARCH,
    RB_FACT_CPU_MODEL,
    RB_FACT_PRODUCT,    // maker and model of the computer or the virtual machine
    RB_FACT_HYPERVISOR, // "none", or what is known of it
    RB_FACT_CPU_VENDOR,
    RB_FACT_CPU_FAMILY, // decimal on x86; on AArch64 the part number as it stands
    RB_FACT_CPU_MODEL_NUMBER,
    RB_FACT_CPU_STEPPING,
    RB_FACT_MICROCODE,
    RB_FACT_CPUS, // on line
    RB_FACT_SOCKETS,
    RB_FACT_CORES,
    RB_FACT_THREADS_PER_CORE, // the largest; hybrid processors mix
    RB_FACT_NUMA_NODES,
    RB_FACT_ISOLATED, // list of isolcpus, or "none"
    RB_FACT_AFFINITY, // CPUs that this process may run on
    RB_FACT_FREQUENCY_DRIVER,
    RB_FACT_GOVERNOR, // of all CPUs; "mixed: performance, powersave" if they differ
    RB_FACT_MIN_KHZ,  // of CPU 0
    RB_FACT_MAX_KHZ,
    RB_FACT_TURBO, // bool
    RB_FACT_CLOCK_SOURCE,
    RB_FACT_CLOCK_AVAILABLE,
    RB_FACT_TSC, // bool: ticks at one rate in all power states
    RB_FACT_LOAD_1M,
    RB_FACT_RUNNABLE,  // threads that run or want to, this one included
    RB_FACT_STEAL_PCT, // of all CPU time since boot
    RB_FACT_MEMORY,    // bytes
    RB_FACT_MEMORY_AVAILABLE,
    RB_FACT_SWAP,
    RB_FACT_SWAP_USED,
    RB_FACT_THP,              // "always", "madvise", "never"
    RB_FACT_ASLR,             // randomize_va_space: 0 off, 1 partly, 2 all
    RB_FACT_CGROUP_CPUS,      // the quota as a number of CPUs, or the text "none"
    RB_FACT_CGROUP_THROTTLED, // how often the quota has stopped the group
    RB_FACT_PERF_PARANOID,    // -1 to 4
    RB_FACT_NMI_WATCHDOG,     // bool
    RB_FACT_PMU,              // name of the hardware PMU's device, or "none"
    RB_FACT_CYCLES,           // bool: counting cycles was tried
    RB_FACT_RAPL_PERF,        // bool: energy through perf events
    RB_FACT_RAPL_POWERCAP,    // bool: energy through powercap files
    RB_FACT_COUNT,
};

enum rb_fact_kind { RB_FACT_IS_UNKNOWN, RB_FACT_IS_TEXT, RB_FACT_IS_NUMBER, RB_FACT_IS_BOOL };

enum { RB_FACT_TEXT_MAX = 192, RB_CACHES_MAX = 8 };

struct rb_fact {
    enum rb_fact_kind kind;
    double number;               // of a NUMBER, and 0 or 1 of a BOOL
    char text[RB_FACT_TEXT_MAX]; // of a TEXT; the reason of an UNKNOWN or of a false BOOL
};

// Of CPU 0.
struct rb_cache {
    int level;
    char type[16];                  // "Data", "Instruction", "Unified"
    double bytes, line_bytes, ways; // NAN where unknown
    int shared_by;                  // CPUs; 0 where unknown
};

struct rb_machine {
    struct rb_fact facts[RB_FACT_COUNT];
    struct rb_cache caches[RB_CACHES_MAX];
    int cache_count;
};

// Where a fact stands in env.json: {group: {key: value}}.
struct rb_fact_name {
    const char *group, *key;
};

// `root` goes before every path: "" for this machine, or a folder with a copy of another one's
// proc and sys. Of a copy only files are read; what takes a system call is unknown.
void rb_machine_read(struct rb_machine *machine, const char *root);

struct rb_fact_name rb_machine_fact_name(enum rb_fact_id id);

#endif
