// Which events tell where the time of a kernel goes, by processor: data in
// bench/events/NAME.events, so that a new processor needs no C. Lines:
//
//     name      AMD Zen 4                     what people call it
//     match     AuthenticAMD 25 16-31,96-127  vendor, family, models as /proc/cpuinfo has them; on
//                                             AArch64 implementer and part: match 0x41 0xd4f
//     fallback  1                             instead: for processors that no file matches, the
//                                             lowest number whose device there is. A file with
//                                             neither is taken by its name only
//     device    cpu                           folder in /sys/bus/event_source/devices
//     verified  no                            has anybody held it against a real processor?
//     prose     words                         what the categories mean here, and what is missing
//     group                                   begins a group: events that are counted together;
//                                             groups are counted in turn, one a repetition.
//                                             `group by read`: rdpmc would not give counts of them
//     event     cycles = cpu-cycles or event=0x76,umask=0 [with kernel]
//     value     total = 6 * cycles            a formula of events and earlier values, per ray
//
// An encoding is a name that the kernel exports in the device's folder `events`, or terms of its
// folder `format`, or config=, config1=, config2=; the first that the machine has counts. `with
// kernel`: what the kernel does for the thread is counted, too.
//
// The values cycles, instructions, branch_misses, l1d_misses, llc_misses, task_clock, page_faults
// and context_switches are columns of results. The four categories are compute, compute_stall,
// memory_stall and other, in the unit of total: a file has all five or none.
#ifndef RB_HARDWARE_EVENT_FILE_H
#define RB_HARDWARE_EVENT_FILE_H

#include "bench/hardware/formula.h"
#include "measure/events.h"

#define RB_EVENT_DEVICES "/sys/bus/event_source/devices"

enum { RB_HARDWARE_EVENTS = 32, RB_HARDWARE_GROUPS = 4, RB_EVENT_MATCHES_MAX = 8 };

struct rb_event_line {
    char encoding[160];
    int group; // from 0
    bool kernel;
};

struct rb_event_match {
    char vendor[32], family[16], models[128]; // "" for all models
};

struct rb_event_file {
    char stem[48]; // NAME of the file
    char title[96], device[48], prose[1024];
    bool verified, verified_said;
    int fallback; // 0: none
    struct rb_event_match matches[RB_EVENT_MATCHES_MAX];
    int match_count;
    struct rb_event_line events[RB_HARDWARE_EVENTS];
    bool by_read[RB_HARDWARE_GROUPS];
    int event_count, group_count;
    struct rb_values values; // the events come first, at their indices
};

// RB_INVALID with line and column for a file that is none.
enum rb_status rb_event_file_read(const char *path, struct rb_event_file *file,
                                  struct rb_error *error);

// Reads the file `asked` for, a name of bench/events or a path that ends in .events; or, if it is
// NULL, chooses the file for the machine under `root` (as in rb_machine_read). RB_FAILED if there
// is none whose device the machine has.
enum rb_status rb_event_file_choose(const char *root, const char *asked, struct rb_event_file *file,
                                    struct rb_error *error);

// What the file's device counts: "pmu", or "software" for the kernel's own events.
const char *rb_event_file_source(const struct rb_event_file *file);

// Has the file the four categories?
bool rb_event_file_has_categories(const struct rb_event_file *file);

// What perf_event_open wants for an event. RB_FAILED if the machine under `root` has it not.
enum rb_status rb_event_encode(const char *root, const struct rb_event_file *file, int index,
                               struct rb_event *event, struct rb_error *error);

// "" or what RAYBENCH_SYSFS names: a folder with a copy of a machine's sys and proc.
const char *rb_hardware_root(void);

#endif
