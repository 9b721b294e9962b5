// What /proc/cpuinfo, /sys/devices/system/cpu and the firmware's tables say of the processor.
#include "bench/machine/machine_read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SYS_CPU "/sys/devices/system/cpu/"

// AArch64 kernels give numbers, not names. Arm's own cores in servers and single-board computers,
// from the MIDR tables of the kernel (arch/arm64/include/asm/cputype.h).
static const struct {
    const char *implementer, *part, *name;
} arm_cores[] = {
    {"0x41", "0xd03", "Cortex-A53"},         {"0x41", "0xd07", "Cortex-A57"},
    {"0x41", "0xd08", "Cortex-A72"},         {"0x41", "0xd0b", "Cortex-A76"},
    {"0x41", "0xd0c", "Neoverse-N1"},        {"0x41", "0xd40", "Neoverse-V1"},
    {"0x41", "0xd49", "Neoverse-N2"},        {"0x41", "0xd4f", "Neoverse-V2"},
    {"0xc0", "0xac3", "Ampere-1"},           {"0x61", "0x022", "Apple M1 Icestorm"},
    {"0x61", "0x023", "Apple M1 Firestorm"},
};

static bool cpuinfo(const char *root, const char *key, char *value, size_t size)
{
    return rb_machine_value(root, "/proc/cpuinfo", key, value, size);
}

void rb_machine_cpu_model(const char *root, const char *path, struct rb_fact *fact)
{
    char name[RB_FACT_TEXT_MAX], implementer[16], part[16];
    (void)path;
    if (cpuinfo(root, "model name", name, sizeof name)) {
        rb_fact_text(fact, name);
        return;
    }
    if (!cpuinfo(root, "CPU implementer", implementer, sizeof implementer) ||
        !cpuinfo(root, "CPU part", part, sizeof part)) {
        rb_fact_unknown(fact, "no model name in /proc/cpuinfo");
        return;
    }
    snprintf(name, sizeof name, "AArch64 implementer %s part %s", implementer, part);
    for (size_t i = 0; i < sizeof arm_cores / sizeof *arm_cores; i++)
        if (strcmp(arm_cores[i].implementer, implementer) == 0 &&
            strcmp(arm_cores[i].part, part) == 0)
            snprintf(name, sizeof name, "%s", arm_cores[i].name);
    rb_fact_text(fact, name);
}

// Is `word` one of the processor's flags? `flags` begins and ends anywhere.
static bool has_word(const char *flags, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = flags; (at = strstr(at, word)); at += length)
        if ((at == flags || at[-1] == ' ') && (at[length] == ' ' || !at[length]))
            return true;
    return false;
}

void rb_machine_tsc(const char *root, const char *path, struct rb_fact *fact)
{
    char value[RB_MACHINE_LINE_MAX];
    (void)path;
    if (cpuinfo(root, "flags", value, sizeof value)) {
        bool invariant = has_word(value, "constant_tsc") && has_word(value, "nonstop_tsc");
        rb_fact_bool(fact, invariant, invariant ? "" : "no constant_tsc and nonstop_tsc");
    } else if (cpuinfo(root, "CPU implementer", value, sizeof value)) {
        rb_fact_bool(fact, true, ""); // the generic timer, by the architecture
    } else {
        rb_fact_unknown(fact, "no flags in /proc/cpuinfo");
    }
}

void rb_machine_product(const char *root, const char *path, struct rb_fact *fact)
{
    char vendor[64], product[64], both[RB_FACT_TEXT_MAX];
    (void)path;
    rb_machine_line(root, "/sys/class/dmi/id/sys_vendor", vendor, sizeof vendor);
    rb_machine_line(root, "/sys/class/dmi/id/product_name", product, sizeof product);
    snprintf(both, sizeof both, "%s%s%s", vendor, vendor[0] && product[0] ? " " : "", product);
    if (!both[0])
        rb_machine_line(root, "/proc/device-tree/model", both, sizeof both);
    if (both[0])
        rb_fact_text(fact, both);
    else
        rb_fact_unknown(fact, "neither /sys/class/dmi/id nor /proc/device-tree/model");
}

// Only x86 has a flag. Elsewhere the firmware may name a virtual machine, or say nothing.
void rb_machine_hypervisor(const char *root, const char *path, struct rb_fact *fact)
{
    static const char *const signs[] = {
        "KVM", "QEMU",    "VMware",     "VirtualBox",     "Bochs",
        "Xen", "Virtual", "Amazon EC2", "Google Compute", "Parallels"};
    char flags[RB_MACHINE_LINE_MAX], type[64];
    struct rb_fact product;
    bool has_flags = cpuinfo(root, "flags", flags, sizeof flags), virtual = false;
    rb_machine_product(root, path, &product);
    bool named = product.kind == RB_FACT_IS_TEXT;
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
        virtual |= named && strstr(product.text, signs[i]);
    if (has_flags)
        virtual = has_word(flags, "hypervisor"); // a bare machine may be for rent under such a name
    if (rb_machine_line(root, "/sys/hypervisor/type", type, sizeof type) && type[0])
        rb_fact_text(fact, type);
    else if (virtual)
        rb_fact_text(fact, named ? product.text : "one that does not give its name");
    else if (has_flags)
        rb_fact_text(fact, "none");
    else
        rb_fact_unknown(fact, "this processor has no flag for it, the firmware names none");
}

// How many CPUs on line are the first in their list FILE of siblings; 0 if a list cannot be read.
// `largest` gets the longest list.
static int count_groups(const char *root, const char *file, int *largest)
{
    char online[RB_MACHINE_LINE_MAX], siblings[RB_MACHINE_LINE_MAX], path[128];
    const char *rest = online;
    int groups = 0, first, last;
    *largest = 0;
    rb_machine_line(root, SYS_CPU "online", online, sizeof online);
    while (rb_machine_next_range(&rest, &first, &last))
        for (int cpu = first; cpu <= last; cpu++) {
            snprintf(path, sizeof path, SYS_CPU "cpu%d/topology/%s", cpu, file);
            rb_machine_line(root, path, siblings, sizeof siblings);
            int count = rb_machine_list_count(siblings);
            if (count == 0)
                return 0;
            groups += strtol(siblings, NULL, 10) == cpu;
            *largest = count > *largest ? count : *largest;
        }
    return groups;
}

static void fill_count(int count, struct rb_fact *fact)
{
    if (count)
        rb_fact_number(fact, count);
    else
        rb_fact_unknown(fact, "no lists of siblings in " SYS_CPU "cpu*/topology");
}

void rb_machine_sockets(const char *root, const char *path, struct rb_fact *fact)
{
    int largest;
    (void)path;
    fill_count(count_groups(root, "core_siblings_list", &largest), fact);
}

void rb_machine_cores(const char *root, const char *path, struct rb_fact *fact)
{
    int largest;
    (void)path;
    fill_count(count_groups(root, "thread_siblings_list", &largest), fact);
}

void rb_machine_threads_per_core(const char *root, const char *path, struct rb_fact *fact)
{
    int largest;
    (void)path;
    fill_count(count_groups(root, "thread_siblings_list", &largest) ? largest : 0, fact);
}

void rb_machine_governor(const char *root, const char *path, struct rb_fact *fact)
{
    char online[RB_MACHINE_LINE_MAX], governor[32], seen[128] = "", file[128];
    const char *rest = online;
    int first, last, kinds = 0;
    (void)path;
    rb_machine_line(root, SYS_CPU "online", online, sizeof online);
    while (rb_machine_next_range(&rest, &first, &last))
        for (int cpu = first; cpu <= last; cpu++) {
            snprintf(file, sizeof file, SYS_CPU "cpu%d/cpufreq/scaling_governor", cpu);
            size_t used = strlen(seen);
            if (!rb_machine_line(root, file, governor, sizeof governor) || !governor[0] ||
                strstr(seen, governor) || used + strlen(governor) + 3 > sizeof seen)
                continue;
            snprintf(seen + used, sizeof seen - used, "%s%s", kinds++ ? ", " : "", governor);
        }
    char text[160];
    snprintf(text, sizeof text, "%s%s", kinds > 1 ? "mixed: " : "", seen);
    if (kinds)
        rb_fact_text(fact, text);
    else
        rb_fact_unknown(fact, "no cpufreq in " SYS_CPU "cpu*");
}

void rb_machine_turbo(const char *root, const char *path, struct rb_fact *fact)
{
    static const struct {
        const char *path;
        int on;
    } switches[] = {{SYS_CPU "intel_pstate/no_turbo", 0},
                    {SYS_CPU "cpufreq/boost", 1},
                    {SYS_CPU "cpufreq/policy0/boost", 1}};
    double value;
    (void)path;
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        if (rb_machine_number(root, switches[i].path, &value)) {
            rb_fact_bool(fact, value == switches[i].on, "");
            return;
        }
    rb_fact_unknown(fact, "neither intel_pstate/no_turbo nor cpufreq/boost in " SYS_CPU);
}

// "32K", "1024K", "32M" in bytes.
static double parse_size(const char *text)
{
    char *end;
    double size = strtod(text, &end);
    if (end == text || !(size > 0))
        return (double)NAN;
    return size * (*end == 'K' ? 1024 : *end == 'M' ? 1024 * 1024 : 1);
}

static double cache_number(const char *root, int index, const char *file)
{
    char path[128], line[RB_MACHINE_LINE_MAX];
    snprintf(path, sizeof path, SYS_CPU "cpu0/cache/index%d/%s", index, file);
    rb_machine_line(root, path, line, sizeof line);
    return parse_size(line);
}

int rb_machine_caches(const char *root, struct rb_cache caches[RB_CACHES_MAX])
{
    char path[128], shared[RB_MACHINE_LINE_MAX];
    int count = 0;
    for (; count < RB_CACHES_MAX; count++) {
        double level = cache_number(root, count, "level");
        if (!(level >= 1 && level <= 9))
            break;
        struct rb_cache *cache = &caches[count];
        cache->level = (int)level;
        cache->bytes = cache_number(root, count, "size");
        cache->line_bytes = cache_number(root, count, "coherency_line_size");
        cache->ways = cache_number(root, count, "ways_of_associativity");
        snprintf(path, sizeof path, SYS_CPU "cpu0/cache/index%d/type", count);
        rb_machine_line(root, path, cache->type, sizeof cache->type);
        snprintf(path, sizeof path, SYS_CPU "cpu0/cache/index%d/shared_cpu_list", count);
        rb_machine_line(root, path, shared, sizeof shared);
        cache->shared_by = rb_machine_list_count(shared);
    }
    return count;
}
