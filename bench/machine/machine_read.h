// What the readers of bench/machine/machine.c share. `root` is the prefix of rb_machine_read.
#ifndef RB_MACHINE_MACHINE_READ_H
#define RB_MACHINE_MACHINE_READ_H

#include "bench/machine/machine.h"

#include <stddef.h>

enum { RB_MACHINE_PATH_MAX = 1024, RB_MACHINE_LINE_MAX = 8192 };

// Fill a fact. Bytes that are no printable ASCII become '?', so that a fact can go to a terminal.
void rb_fact_unknown(struct rb_fact *fact, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void rb_fact_text(struct rb_fact *fact, const char *text);
void rb_fact_number(struct rb_fact *fact, double number);
void rb_fact_bool(struct rb_fact *fact, bool value, const char *reason); // reason: why not, or ""

// First line of a file, without blanks at its end. False if there is no such file, or it cannot be
// read. An empty file is an empty line.
bool rb_machine_line(const char *root, const char *path, char *line, size_t size);

// The number that a file begins with.
bool rb_machine_number(const char *root, const char *path, double *number);

// The value on the first line "key: value" or "key value" or "key=value".
bool rb_machine_value(const char *root, const char *path, const char *key, char *value,
                      size_t size);

// Walks a list of CPUs such as "0-3,8,10-11": the next range, false at the end or at nonsense.
bool rb_machine_next_range(const char **list, int *first, int *last);
int rb_machine_list_count(const char *list); // CPUs in it, 0 for nonsense

// Readers in files of their own. `path` is not used by them.
void rb_machine_cpu_model(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_hypervisor(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_product(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_sockets(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_cores(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_threads_per_core(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_governor(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_turbo(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_tsc(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_cgroup_cpus(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_cgroup_throttled(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_pmu(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_cycles(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_rapl_perf(const char *root, const char *path, struct rb_fact *fact);
void rb_machine_rapl_powercap(const char *root, const char *path, struct rb_fact *fact);
int rb_machine_caches(const char *root, struct rb_cache caches[RB_CACHES_MAX]);

#endif
