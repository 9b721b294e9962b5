// Facts and the doctor's verdicts on made-up machines: trees of files such as /proc and /sys hold.
#define _GNU_SOURCE
#include "bench/machine/machine.h"
#include "bench/machine/doctor.h"
#include "tests/support/tree.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CPU   "/sys/devices/system/cpu/"
#define CLOCK "/sys/devices/system/clocksource/clocksource0/"
#define POWER "/sys/bus/event_source/devices/power/"

struct entry {
    const char *path, *text;
};

static char root[] = "/tmp/raybench-machine-XXXXXX";
static struct rb_machine machine;
static struct rb_doctor doctor;

// Makes the tree, reads and judges it.
static void examine(const char *name, const struct entry *entries)
{
    bool written = true;
    tree_remove(root);
    for (const struct entry *entry = entries; entry->path; entry++)
        written &= tree_put(root, entry->path, entry->text);
    ok(written, "%s: the tree is written", name);
    rb_machine_read(&machine, root);
    rb_doctor_examine(&doctor, &machine);
}

static const struct rb_fact *fact(enum rb_fact_id id)
{
    return &machine.facts[id];
}

static void is_text(enum rb_fact_id id, const char *text)
{
    struct rb_fact_name name = rb_machine_fact_name(id);
    if (!ok(fact(id)->kind == RB_FACT_IS_TEXT && strcmp(fact(id)->text, text) == 0, "%s.%s is %s",
            name.group, name.key, text))
        note("kind %d: %s", (int)fact(id)->kind, fact(id)->text);
}

static void is_number(enum rb_fact_id id, double number)
{
    struct rb_fact_name name = rb_machine_fact_name(id);
    bool kind = fact(id)->kind == RB_FACT_IS_NUMBER || fact(id)->kind == RB_FACT_IS_BOOL;
    if (!ok(kind && fabs(fact(id)->number - number) < 1e-9, "%s.%s is %g", name.group, name.key,
            number))
        note("kind %d: %g %s", (int)fact(id)->kind, fact(id)->number, fact(id)->text);
}

static void is_unknown(enum rb_fact_id id)
{
    struct rb_fact_name name = rb_machine_fact_name(id);
    ok(fact(id)->kind == RB_FACT_IS_UNKNOWN && fact(id)->text[0], "%s.%s is unknown: %s",
       name.group, name.key, fact(id)->text);
}

// NAME is in STATE, and what was found holds TEXT.
static void judged(const char *name, enum rb_check_state state, const char *text)
{
    const struct rb_check *check = doctor.checks;
    while (strcmp(check->name, name) != 0 && check + 1 < doctor.checks + doctor.count)
        check++;
    if (!ok(strcmp(check->name, name) == 0 && check->state == state && strstr(check->found, text),
            "%s is %s: %s", name, rb_check_state_name(state), text))
        note("%s: %s", rb_check_state_name(check->state), check->found);
}

static const struct entry laptop[] = {
    {"/proc/cpuinfo", "processor\t: 0\nvendor_id\t: GenuineIntel\ncpu family\t: 6\nmodel\t\t: 142\n"
                      "model name\t: Intel(R) Core(TM) i7-8550U CPU @ 1.80GHz\nstepping\t: 10\n"
                      "flags\t\t: fpu constant_tsc nonstop_tsc avx2\n"},
    {"/proc/loadavg", "0.10 0.20 0.30 1/900 4242\n"},
    {"/proc/stat", "cpu  1000 0 1000 8000 0 0 0 0 0 0\ncpu0 1 2 3\n"},
    {"/proc/meminfo", "MemTotal:  16000000 kB\nMemAvailable: 8000000 kB\nSwapTotal: 2048 kB\n"
                      "SwapFree: 1024 kB\n"},
    {"/proc/self/status", "Name:\tx\nCpus_allowed:\tf\nCpus_allowed_list:\t0-3\n"},
    {"/proc/self/cgroup", "0::/user.slice/session-1.scope\n"},
    {"/sys/fs/cgroup/user.slice/session-1.scope/cpu.max", "max 100000\n"},
    {"/sys/fs/cgroup/user.slice/session-1.scope/cpu.stat", "usage_usec 5\nnr_throttled 0\n"},
    {"/proc/sys/kernel/perf_event_paranoid", "4\n"},
    {"/proc/sys/kernel/nmi_watchdog", "1\n"},
    {"/proc/sys/kernel/randomize_va_space", "2\n"},
    {"/proc/sys/kernel/hostname", "laptop\n"},
    {"/etc/os-release", "NAME=\"Debian\"\nPRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\n"},
    {"/sys/class/dmi/id/sys_vendor", "LENOVO\n"},
    {"/sys/class/dmi/id/product_name", "20KHCTO1WW\n"},
    {"/sys/kernel/mm/transparent_hugepage/enabled", "[always] madvise never\n"},
    {CPU "online", "0-3\n"},
    {CPU "isolated", "\n"},
    {CPU "cpu0/topology/thread_siblings_list", "0,2\n"},
    {CPU "cpu1/topology/thread_siblings_list", "1,3\n"},
    {CPU "cpu2/topology/thread_siblings_list", "0,2\n"},
    {CPU "cpu3/topology/thread_siblings_list", "1,3\n"},
    {CPU "cpu0/topology/core_siblings_list", "0-3\n"},
    {CPU "cpu1/topology/core_siblings_list", "0-3\n"},
    {CPU "cpu2/topology/core_siblings_list", "0-3\n"},
    {CPU "cpu3/topology/core_siblings_list", "0-3\n"},
    {CPU "cpu0/cpufreq/scaling_governor", "powersave\n"},
    {CPU "cpu1/cpufreq/scaling_governor", "performance\n"},
    {CPU "cpu0/cpufreq/scaling_driver", "intel_pstate\n"},
    {CPU "cpu0/cpufreq/scaling_min_freq", "400000\n"},
    {CPU "cpu0/cpufreq/scaling_max_freq", "4000000\n"},
    {CPU "intel_pstate/no_turbo", "0\n"},
    {CPU "cpu0/cache/index0/level", "1\n"},
    {CPU "cpu0/cache/index0/type", "Data\n"},
    {CPU "cpu0/cache/index0/size", "32K\n"},
    {CPU "cpu0/cache/index0/ways_of_associativity", "8\n"},
    {CPU "cpu0/cache/index0/shared_cpu_list", "0,2\n"},
    {CPU "cpu0/cache/index1/level", "3\n"},
    {CPU "cpu0/cache/index1/type", "Unified\n"},
    {CPU "cpu0/cache/index1/size", "8M\n"},
    {CLOCK "current_clocksource", "tsc\n"},
    {CLOCK "available_clocksource", "tsc hpet acpi_pm \n"},
    {"/sys/devices/system/node/online", "0\n"},
    {"/sys/bus/event_source/devices/cpu/type", "4\n"},
    {POWER "type", "9\n"},
    {POWER "events/energy-pkg", "event=0x02\n"},
    {"/sys/class/powercap/intel-rapl:0/energy_uj", "123456\n"},
    {NULL, NULL},
};

static void test_laptop(void)
{
    examine("laptop", laptop);
    is_text(RB_FACT_HOST_NAME, "laptop");
    is_text(RB_FACT_OS, "Debian GNU/Linux 12 (bookworm)");
    is_text(RB_FACT_CPU_MODEL, "Intel(R) Core(TM) i7-8550U CPU @ 1.80GHz");
    is_text(RB_FACT_CPU_MODEL_NUMBER, "142");
    is_text(RB_FACT_PRODUCT, "LENOVO 20KHCTO1WW");
    is_text(RB_FACT_HYPERVISOR, "none");
    is_number(RB_FACT_CPUS, 4);
    is_number(RB_FACT_CORES, 2);
    is_number(RB_FACT_SOCKETS, 1);
    is_number(RB_FACT_THREADS_PER_CORE, 2);
    is_text(RB_FACT_GOVERNOR, "mixed: powersave, performance");
    is_number(RB_FACT_TURBO, 1);
    is_number(RB_FACT_STEAL_PCT, 0);
    is_number(RB_FACT_SWAP_USED, 1024 * 1024);
    is_text(RB_FACT_CGROUP_CPUS, "none");
    is_text(RB_FACT_ISOLATED, "none");
    is_text(RB_FACT_CLOCK_AVAILABLE, "tsc hpet acpi_pm");
    is_unknown(RB_FACT_CYCLES);
    is_unknown(RB_FACT_MICROCODE);
    ok(machine.cache_count == 2 && machine.caches[0].bytes == 32768 &&
           machine.caches[0].ways == 8 && machine.caches[0].shared_by == 2 &&
           isnan(machine.caches[0].line_bytes),
       "the first cache");
    ok(machine.cache_count == 2 && machine.caches[1].level == 3 &&
           machine.caches[1].bytes == 8388608 && machine.caches[1].shared_by == 0,
       "the last cache");
    judged("governor", RB_CHECK_WARN, "400 to 4000 MHz");
    judged("turbo", RB_CHECK_WARN, "on");
    judged("smt", RB_CHECK_WARN, "2 threads per core");
    judged("load", RB_CHECK_OK, "0.10 over one minute on 4 CPUs, 1 runnable now");
    judged("thp", RB_CHECK_WARN, "always");
    judged("swap", RB_CHECK_WARN, "1 of 2 MiB");
    judged("hypervisor", RB_CHECK_OK, "none");
    judged("perf paranoid", RB_CHECK_BAD, "4");
    judged("nmi watchdog", RB_CHECK_WARN, "on");
    judged("pmu", RB_CHECK_UNKNOWN, "cpu: not tried");
    judged("rapl", RB_CHECK_OK, "powercap");
    judged("tsc", RB_CHECK_OK, "one rate");
    // Scored and known: governor, turbo, smt, thp, swap warn; load, steal, hypervisor, quota,
    // throttled, affinity, numa, aslr, clock source, tsc ok: (5 / 2 + 10) / 15.
    ok(doctor.score == 83, "the score is %d", doctor.score);
}

static const struct entry server[] = {
    {"/proc/cpuinfo", "vendor_id\t: AuthenticAMD\ncpu family\t: 25\nmodel\t\t: 1\n"
                      "model name\t: AMD EPYC 7763\nflags\t\t: fpu tsc constant_tsc\n"},
    {"/proc/loadavg", "8.00 8.00 8.00 9/900 4242\n"},
    {"/proc/self/status", "Cpus_allowed_list:\t0-1\n"},
    {"/proc/self/cgroup", "5:cpuset:/docker/abc\n4:cpu,cpuacct:/docker/abc\n0::/\n"},
    {"/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "150000\n"},
    {"/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n"},
    {"/sys/fs/cgroup/cpu,cpuacct/cpu.stat", "nr_periods 9\nnr_throttled 7\n"},
    {"/proc/sys/kernel/perf_event_paranoid", "-1\n"},
    {"/proc/sys/kernel/randomize_va_space", "0\n"},
    {CPU "online", "0-1,4-5\n"},
    {CPU "isolated", "4-5\n"},
    {CPU "cpufreq/boost", "0\n"},
    {CPU "cpu0/cpufreq/scaling_governor", "performance\n"},
    {CPU "cpu0/topology/core_siblings_list", "0-1\n"},
    {CPU "cpu1/topology/core_siblings_list", "0-1\n"},
    {CPU "cpu4/topology/core_siblings_list", "4-5\n"},
    {CPU "cpu5/topology/core_siblings_list", "4-5\n"},
    {CLOCK "current_clocksource", "hpet\n"},
    {"/sys/devices/system/node/online", "0-1\n"},
    {POWER "type", "13\n"},
    {"/sys/class/powercap/intel-rapl:0/energy_uj", "0\n"},
    {NULL, NULL},
};

static void test_server(void)
{
    examine("server", server);
    is_number(RB_FACT_CPUS, 4);
    is_number(RB_FACT_SOCKETS, 2);
    is_unknown(RB_FACT_CORES);
    is_number(RB_FACT_TURBO, 0);
    is_number(RB_FACT_TSC, 0);
    is_number(RB_FACT_NUMA_NODES, 2);
    is_number(RB_FACT_CGROUP_CPUS, 1.5);
    is_number(RB_FACT_CGROUP_THROTTLED, 7);
    is_number(RB_FACT_PERF_PARANOID, -1);
    is_number(RB_FACT_RAPL_POWERCAP, 0);
    is_text(RB_FACT_ISOLATED, "4-5");
    is_unknown(RB_FACT_STEAL_PCT);
    judged("governor", RB_CHECK_OK, "performance");
    judged("turbo", RB_CHECK_OK, "off");
    judged("load", RB_CHECK_BAD, "8.00");
    judged("cgroup quota", RB_CHECK_BAD, "1.50 CPUs");
    judged("throttled", RB_CHECK_BAD, "7 times");
    judged("affinity", RB_CHECK_WARN, "2 of 4");
    judged("numa", RB_CHECK_WARN, "2 nodes");
    judged("aslr", RB_CHECK_WARN, "off");
    judged("clock source", RB_CHECK_BAD, "hpet");
    judged("tsc", RB_CHECK_BAD, "nonstop_tsc");
    judged("isolcpus", RB_CHECK_OK, "4-5");
    judged("perf paranoid", RB_CHECK_OK, "-1");
    judged("rapl", RB_CHECK_WARN, "energy_uj reads 0");
    // governor, turbo, hypervisor ok; affinity, numa, aslr warn; load, quota, throttled, clock
    // source, tsc bad: 4.5 of 11 is 40.9 %.
    ok(doctor.score == 41, "the score is %d, rounded", doctor.score);
}

static const struct entry cloud[] = {
    {"/proc/cpuinfo", "vendor_id\t: GenuineIntel\nmodel name\t: Intel \033[31mXeon\n"
                      "flags\t\t: fpu hypervisor constant_tsc nonstop_tsc\n"},
    {"/proc/stat", "cpu  0 0 0 980 0 0 0 20 0 0\n"},
    {"/sys/class/dmi/id/sys_vendor", "Amazon EC2\n"},
    {"/sys/bus/event_source/devices/software/type", "1\n"},
    {CPU "online", "0-999999999\n"},
    {"/proc/meminfo", "MemTotal: lots\nSwapFree: 5 kB\n"},
    {"/proc/loadavg", "nan nan nan\n"},
    {"/proc/sys/kernel/perf_event_paranoid", "high\n"},
    {NULL, NULL},
};

static void test_cloud(void)
{
    examine("cloud VM", cloud);
    is_text(RB_FACT_CPU_MODEL, "Intel ?[31mXeon");
    is_text(RB_FACT_HYPERVISOR, "Amazon EC2");
    is_text(RB_FACT_PMU, "none");
    is_number(RB_FACT_STEAL_PCT, 2);
    is_number(RB_FACT_RAPL_PERF, 0);
    is_unknown(RB_FACT_CPUS);
    is_unknown(RB_FACT_MEMORY);
    is_unknown(RB_FACT_SWAP_USED);
    is_unknown(RB_FACT_LOAD_1M);
    is_unknown(RB_FACT_RUNNABLE);
    is_unknown(RB_FACT_PERF_PARANOID);
    is_unknown(RB_FACT_CGROUP_CPUS);
    is_unknown(RB_FACT_TURBO);
    judged("hypervisor", RB_CHECK_WARN, "Amazon EC2");
    judged("steal", RB_CHECK_BAD, "2.000 %");
    judged("pmu", RB_CHECK_WARN, "no hardware counters");
    judged("governor", RB_CHECK_UNKNOWN, "no cpufreq");
    // steal bad, hypervisor warn, tsc ok: 1.5 of 3.
    ok(doctor.score == 50, "the score is %d", doctor.score);
}

static const struct entry arm[] = {
    {"/proc/cpuinfo", "processor\t: 0\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\n"
                      "CPU architecture: 8\nCPU variant\t: 0x3\nCPU part\t: 0xd0c\n"
                      "CPU revision\t: 1\n"},
    {"/proc/device-tree/model", "Some Board Rev 1"},
    {"/proc/self/cgroup", "0::/../../other\n"},
    {"/sys/fs/cgroup/cpu.max", "50000 100000\n"},
    {"/sys/bus/event_source/devices/armv8_pmuv3_0/type", "8\n"},
    {CLOCK "current_clocksource", "arch_sys_counter\n"},
    {NULL, NULL},
};

static void test_arm(void)
{
    examine("AArch64", arm);
    is_text(RB_FACT_CPU_MODEL, "Neoverse-N1");
    is_text(RB_FACT_CPU_FAMILY, "0xd0c");
    is_text(RB_FACT_PRODUCT, "Some Board Rev 1");
    is_text(RB_FACT_PMU, "armv8_pmuv3_0");
    is_number(RB_FACT_TSC, 1);
    is_number(RB_FACT_CGROUP_CPUS, 0.5);
    is_unknown(RB_FACT_HYPERVISOR);
    judged("clock source", RB_CHECK_OK, "arch_sys_counter");
    judged("hypervisor", RB_CHECK_UNKNOWN, "no flag");
}

static void test_nothing(void)
{
    static const struct entry nothing[] = {{NULL, NULL}};
    int known = 0;
    examine("an empty folder", nothing);
    for (int id = 0; id < RB_FACT_COUNT; id++)
        known += machine.facts[id].kind != RB_FACT_IS_UNKNOWN && id != RB_FACT_RAPL_PERF &&
                 id != RB_FACT_RAPL_POWERCAP;
    ok(known == 0 && machine.cache_count == 0, "nothing is known of it");
    ok(doctor.score == -1, "and there is no score");
}

static void test_this(void)
{
    rb_machine_read(&machine, "");
    rb_doctor_examine(&doctor, &machine);
    bool reasons = true;
    for (int id = 0; id < RB_FACT_COUNT; id++)
        reasons &= machine.facts[id].kind != RB_FACT_IS_UNKNOWN || machine.facts[id].text[0];
    ok(reasons, "every fact of this machine is known or says why it is not");
    ok(doctor.score >= -1 && doctor.score <= 100, "its score is %d", doctor.score);
}

int main(void)
{
    if (!mkdtemp(root))
        return 1;
    test_laptop();
    test_server();
    test_cloud();
    test_arm();
    test_nothing();
    test_this();
    tree_remove(root);
    return done();
}
