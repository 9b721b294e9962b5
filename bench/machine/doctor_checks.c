// The checks of the doctor: one table, one small judge each. The limits are conventions, and say
// where they come from.
#include "bench/machine/doctor.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef enum rb_check_state judge_fn(const struct rb_machine *machine, struct rb_check *check);

static const char none_here[] = "none, this machine does not offer it";
static const char host_decides[] = "none, the host of this virtual machine decides";

__attribute__((format(printf, 2, 3))) static void found(struct rb_check *check, const char *format,
                                                        ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(check->found, sizeof check->found, format, arguments);
    va_end(arguments);
}

// The fact, or NULL after saying why it is unknown.
static const struct rb_fact *get(const struct rb_machine *machine, enum rb_fact_id id,
                                 struct rb_check *check)
{
    const struct rb_fact *fact = &machine->facts[id];
    if (fact->kind != RB_FACT_IS_UNKNOWN)
        return fact;
    found(check, "%s", fact->text);
    return NULL;
}

static bool is_number(const struct rb_machine *machine, enum rb_fact_id id)
{
    return machine->facts[id].kind == RB_FACT_IS_NUMBER;
}

static double number(const struct rb_machine *machine, enum rb_fact_id id)
{
    return machine->facts[id].number;
}

static bool is_virtual(const struct rb_machine *machine)
{
    const struct rb_fact *fact = &machine->facts[RB_FACT_HYPERVISOR];
    return fact->kind == RB_FACT_IS_TEXT && strcmp(fact->text, "none") != 0;
}

// A limit in two steps: up to `fine` it is ok, above `bearable` bad.
static enum rb_check_state grade(double value, double fine, double bearable)
{
    return value <= fine ? RB_CHECK_OK : value <= bearable ? RB_CHECK_WARN : RB_CHECK_BAD;
}

static enum rb_check_state judge_governor(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *governor = get(m, RB_FACT_GOVERNOR, check);
    if (!governor)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", governor->text);
    if (is_number(m, RB_FACT_MIN_KHZ) && is_number(m, RB_FACT_MAX_KHZ))
        found(check, "%s, %.0f to %.0f MHz", governor->text, number(m, RB_FACT_MIN_KHZ) / 1000,
              number(m, RB_FACT_MAX_KHZ) / 1000);
    return strcmp(governor->text, "performance") == 0 ? RB_CHECK_OK : RB_CHECK_WARN;
}

static enum rb_check_state judge_turbo(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *turbo = get(m, RB_FACT_TURBO, check);
    if (!turbo)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", turbo->number > 0 ? "on" : "off");
    const struct rb_fact *driver = &m->facts[RB_FACT_FREQUENCY_DRIVER];
    if (driver->kind == RB_FACT_IS_TEXT && strncmp(driver->text, "intel", 5) == 0)
        check->fix = "echo 1 | sudo tee /sys/devices/system/cpu/intel_pstate/no_turbo";
    return turbo->number > 0 ? RB_CHECK_WARN : RB_CHECK_OK;
}

static enum rb_check_state judge_smt(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *threads = get(m, RB_FACT_THREADS_PER_CORE, check);
    if (!threads)
        return RB_CHECK_UNKNOWN;
    found(check, "%.0f thread%s per core", threads->number, threads->number > 1 ? "s" : "");
    return threads->number > 1 ? RB_CHECK_WARN : RB_CHECK_OK;
}

// A load of one per CPU leaves none idle; a tenth of that is one neighbour for a tenth of the time.
static enum rb_check_state judge_load(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *load = get(m, RB_FACT_LOAD_1M, check);
    const struct rb_fact *cpus = load ? get(m, RB_FACT_CPUS, check) : NULL;
    if (!cpus)
        return RB_CHECK_UNKNOWN;
    found(check, "%.2f over one minute on %.0f CPUs", load->number, cpus->number);
    if (is_number(m, RB_FACT_RUNNABLE))
        found(check, "%.2f over one minute on %.0f CPUs, %.0f runnable now", load->number,
              cpus->number, number(m, RB_FACT_RUNNABLE));
    return grade(load->number / cpus->number, 0.1, 0.999);
}

// 1 % is what the harness allows its own probes.
static enum rb_check_state judge_steal(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *steal = get(m, RB_FACT_STEAL_PCT, check);
    if (!steal)
        return RB_CHECK_UNKNOWN;
    found(check, "%.3f %% of all CPU time since boot", steal->number);
    return grade(steal->number, 0.1, 1);
}

static enum rb_check_state judge_throttled(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *times = get(m, RB_FACT_CGROUP_THROTTLED, check);
    if (!times)
        return RB_CHECK_UNKNOWN;
    found(check, "stopped %.0f times by the quota", times->number);
    return times->number > 0 ? RB_CHECK_BAD : RB_CHECK_OK;
}

static enum rb_check_state judge_quota(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *quota = get(m, RB_FACT_CGROUP_CPUS, check);
    if (!quota)
        return RB_CHECK_UNKNOWN;
    if (quota->kind == RB_FACT_IS_TEXT) {
        found(check, "%s", quota->text);
        return RB_CHECK_OK;
    }
    found(check, "%.2f CPUs", quota->number);
    if (is_number(m, RB_FACT_CPUS) && quota->number >= number(m, RB_FACT_CPUS))
        return RB_CHECK_OK;
    return RB_CHECK_BAD;
}

static enum rb_check_state judge_affinity(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *allowed = get(m, RB_FACT_AFFINITY, check);
    const struct rb_fact *cpus = allowed ? get(m, RB_FACT_CPUS, check) : NULL;
    if (!cpus)
        return RB_CHECK_UNKNOWN;
    found(check, "may use %.0f of %.0f CPUs", allowed->number, cpus->number);
    return allowed->number < cpus->number ? RB_CHECK_WARN : RB_CHECK_OK;
}

static enum rb_check_state judge_isolation(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *isolated = get(m, RB_FACT_ISOLATED, check);
    if (!isolated)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", isolated->text);
    return strcmp(isolated->text, "none") == 0 ? RB_CHECK_WARN : RB_CHECK_OK;
}

static enum rb_check_state judge_numa(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *nodes = get(m, RB_FACT_NUMA_NODES, check);
    if (!nodes)
        return RB_CHECK_UNKNOWN;
    found(check, "%.0f node%s", nodes->number, nodes->number > 1 ? "s" : "");
    return nodes->number > 1 ? RB_CHECK_WARN : RB_CHECK_OK;
}

// The harness starts many processes, so that random layouts average out; a fixed one does not.
static enum rb_check_state judge_aslr(const struct rb_machine *m, struct rb_check *check)
{
    static const char *const names[] = {"off", "partly on", "on"};
    const struct rb_fact *aslr = get(m, RB_FACT_ASLR, check);
    if (!aslr)
        return RB_CHECK_UNKNOWN;
    int level = aslr->number >= 2 ? 2 : aslr->number >= 1 ? 1 : 0;
    found(check, "%s", names[level]);
    return level == 2 ? RB_CHECK_OK : RB_CHECK_WARN;
}

static enum rb_check_state judge_thp(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *thp = get(m, RB_FACT_THP, check);
    if (!thp)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", thp->text);
    return strcmp(thp->text, "always") == 0 ? RB_CHECK_WARN : RB_CHECK_OK;
}

static enum rb_check_state judge_swap(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *used = get(m, RB_FACT_SWAP_USED, check);
    if (!used)
        return RB_CHECK_UNKNOWN;
    found(check, "%.0f of %.0f MiB in use", used->number / 1048576,
          number(m, RB_FACT_SWAP) / 1048576);
    return used->number > 0 ? RB_CHECK_WARN : RB_CHECK_OK;
}

// The kernel keeps away from the time stamp counter only where it has caught it lying.
static enum rb_check_state judge_clock(const struct rb_machine *m, struct rb_check *check)
{
    static const char *const slow[] = {"hpet", "acpi_pm", "jiffies", "refined-jiffies", "pit"};
    const struct rb_fact *source = get(m, RB_FACT_CLOCK_SOURCE, check);
    if (!source)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", source->text);
    for (size_t i = 0; i < sizeof slow / sizeof *slow; i++)
        if (strcmp(source->text, slow[i]) == 0)
            return RB_CHECK_BAD;
    return RB_CHECK_OK;
}

static enum rb_check_state judge_tsc(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *tsc = get(m, RB_FACT_TSC, check);
    if (!tsc)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", tsc->number > 0 ? "ticks at one rate" : tsc->text);
    return tsc->number > 0 ? RB_CHECK_OK : RB_CHECK_BAD;
}

static enum rb_check_state judge_hypervisor(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *hypervisor = get(m, RB_FACT_HYPERVISOR, check);
    if (!hypervisor)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", hypervisor->text);
    return is_virtual(m) ? RB_CHECK_WARN : RB_CHECK_OK;
}

// 2 lets a process count itself in user mode, which is what a kernel of ours is. What was tried
// decides: some users may more than the setting says.
static enum rb_check_state judge_paranoid(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *level = get(m, RB_FACT_PERF_PARANOID, check);
    if (!level)
        return RB_CHECK_UNKNOWN;
    bool allowed = number(m, RB_FACT_CYCLES) > 0;
    found(check, "%.0f%s", level->number,
          level->number > 2 && allowed ? ", which does not bind this user" : "");
    return level->number <= 2 || allowed ? RB_CHECK_OK : RB_CHECK_BAD;
}

static enum rb_check_state judge_pmu(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *pmu = get(m, RB_FACT_PMU, check), *cycles = &m->facts[RB_FACT_CYCLES];
    if (!pmu)
        return RB_CHECK_UNKNOWN;
    if (strcmp(pmu->text, "none") == 0) {
        found(check, "no hardware counters");
        check->fix = none_here;
        return RB_CHECK_WARN;
    }
    bool counts = cycles->number > 0;
    found(check, "%s%s%s", pmu->text, counts ? ", counts cycles" : ": ", cycles->text);
    if (cycles->kind == RB_FACT_IS_UNKNOWN)
        return RB_CHECK_UNKNOWN;
    return counts ? RB_CHECK_OK : RB_CHECK_WARN;
}

static enum rb_check_state judge_nmi(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *watchdog = get(m, RB_FACT_NMI_WATCHDOG, check);
    if (!watchdog)
        return RB_CHECK_UNKNOWN;
    found(check, "%s", watchdog->number > 0 ? "on" : "off");
    return watchdog->number > 0 ? RB_CHECK_WARN : RB_CHECK_OK;
}

static enum rb_check_state judge_rapl(const struct rb_machine *m, struct rb_check *check)
{
    const struct rb_fact *perf = &m->facts[RB_FACT_RAPL_PERF];
    const struct rb_fact *powercap = &m->facts[RB_FACT_RAPL_POWERCAP];
    bool readable = perf->number > 0 || powercap->number > 0;
    if (readable)
        found(check, "%s", perf->number > 0 ? "readable by perf events" : "readable by powercap");
    else
        found(check, "perf: %s; powercap: %s", perf->text, powercap->text);
    if (strncmp(perf->text, "no ", 3) == 0 && strncmp(powercap->text, "no ", 3) == 0)
        check->fix = none_here;
    if (!readable && perf->kind == RB_FACT_IS_UNKNOWN)
        return RB_CHECK_UNKNOWN;
    return readable ? RB_CHECK_OK : RB_CHECK_WARN;
}

#define SYS_CPU "/sys/devices/system/cpu/"

static const struct row {
    const char *name;
    judge_fn *judge;
    bool scored;
    bool of_host; // in a virtual machine, nothing can be done about it
    const char *why, *fix;
} rows[] = {
    {"governor", judge_governor, true, true, "a clock that follows the load times its own ramps",
     "sudo cpupower frequency-set -g performance"},
    {"turbo", judge_turbo, true, true, "the clock depends on heat and on how many cores are busy",
     "echo 0 | sudo tee " SYS_CPU "cpufreq/boost"},
    {"smt", judge_smt, true, false, "two threads on a core share its units and its first caches",
     "echo off | sudo tee " SYS_CPU "smt/control"},
    {"load", judge_load, true, false, "others take CPUs, caches and memory bandwidth",
     "wait, or stop what `top` shows"},
    {"steal", judge_steal, true, true, "time that the host gave to others counts as ours",
     host_decides},
    {"hypervisor", judge_hypervisor, true, true, "neighbours share caches, memory and the clock",
     host_decides},
    {"cgroup quota", judge_quota, true, false, "at its end all threads stop until the next period",
     "raise or drop the container's CPU limit (docker: --cpus)"},
    {"throttled", judge_throttled, true, false, "each stop is a gap of tens of milliseconds",
     "raise or drop the container's CPU limit (docker: --cpus)"},
    {"affinity", judge_affinity, true, false, "threads beyond the CPUs allowed run in turns",
     "start it without taskset, or with as many --threads"},
    {"numa", judge_numa, true, false, "memory of another node is slower, and which it is varies",
     "numactl --cpunodebind=0 --membind=0 raybench ..."},
    {"thp", judge_thp, true, false, "huge pages appear in the middle of a run",
     "echo madvise | sudo tee /sys/kernel/mm/transparent_hugepage/enabled"},
    {"aslr", judge_aslr, true, false, "one fixed layout of memory can be a lucky one",
     "sudo sysctl kernel.randomize_va_space=2"},
    {"swap", judge_swap, true, false, "a page on disk costs milliseconds", "sudo swapoff -a"},
    {"clock source", judge_clock, true, true, "a slow clock means a time stamp counter in doubt",
     "boot with clocksource=tsc tsc=reliable, if the counter is sound"},
    {"tsc", judge_tsc, true, true, "ticks whose rate changes are no time", "use another processor"},
    {"isolcpus", judge_isolation, false, false, "CPUs set apart have no other work",
     "boot with isolcpus=N, and pin to N"},
    {"perf paranoid", judge_paranoid, false, false, "above 2, counting needs privileges",
     "sudo sysctl kernel.perf_event_paranoid=1"},
    {"pmu", judge_pmu, false, false, "without counters, a time has no explanation",
     "sudo sysctl kernel.perf_event_paranoid=1"},
    {"nmi watchdog", judge_nmi, false, false, "it holds one hardware counter",
     "sudo sysctl kernel.nmi_watchdog=0"},
    {"rapl", judge_rapl, false, false, "without it, energy is a model",
     "sudo chmod a+r /sys/class/powercap/intel-rapl:*/energy_uj"},
};

enum { ROW_COUNT = sizeof rows / sizeof *rows };
_Static_assert((int)ROW_COUNT <= (int)RB_CHECKS_MAX, "struct rb_doctor has room for every check");

void rb_doctor_examine(struct rb_doctor *doctor, const struct rb_machine *machine)
{
    static const int points[] = {[RB_CHECK_OK] = 2, [RB_CHECK_WARN] = 1, [RB_CHECK_BAD] = 0};
    int sum = 0, known = 0;
    for (int i = 0; i < ROW_COUNT; i++) {
        const struct row *row = &rows[i];
        struct rb_check *check = &doctor->checks[i];
        *check = (struct rb_check){
            .name = row->name, .why = row->why, .fix = row->fix, .scored = row->scored};
        check->state = row->judge(machine, check);
        if (row->of_host && is_virtual(machine))
            check->fix = host_decides;
        if (row->scored && check->state != RB_CHECK_UNKNOWN) {
            sum += points[check->state];
            known++;
        }
    }
    doctor->count = ROW_COUNT;
    doctor->score = known ? (100 * sum + known) / (2 * known) : -1;
}
