// What hardware counters, or the kernel's software events, have said of the kernels of a cell, and
// the figures that follow from it by the formulas of a file of events.
#ifndef RB_HARDWARE_HARDWARE_H
#define RB_HARDWARE_HARDWARE_H

#include "bench/hardware/event_file.h"
#include "measure/probe.h"

// One kernel at one bounce, over all repetitions that counted a group.
struct rb_hardware_place {
    uint64_t rays[RB_HARDWARE_GROUPS], laps[RB_HARDWARE_GROUPS], ns[RB_HARDWARE_GROUPS];
    uint64_t count[RB_HARDWARE_EVENTS];
};

// What a process that counts sends behind its sample.
struct rb_hardware {
    struct rb_hardware_place place[RB_KERNEL_COUNT][RB_BOUNCE_MAX];
    enum rb_event_state state[RB_HARDWARE_EVENTS];
    uint64_t empty[RB_HARDWARE_EVENTS]; // of a lap with nothing in it
    double lap_ns[RB_HARDWARE_GROUPS];  // what that takes
    bool in_user_space;                 // all groups were read by rdpmc
    uint32_t repetitions;
    const struct rb_event_file *file; // set by who receives it; not owned
};

// The groups of a file, as the machine under `root` counts them. Events that it does not know are
// absent; `of` says which event of the file stands where in a group.
struct rb_hardware_groups {
    struct rb_event_group group[RB_HARDWARE_GROUPS];
    int of[RB_HARDWARE_GROUPS][RB_EVENTS_MAX];
    int count;
};
void rb_hardware_make_groups(const struct rb_event_file *file, const char *root,
                             struct rb_hardware_groups *groups, struct rb_hardware *hardware);

// Books what one repetition counted with a group.
void rb_hardware_book(struct rb_hardware *hardware, const struct rb_hardware_groups *groups,
                      int group, const struct rb_event_table *table,
                      const struct rb_recorder *recorder, double ns_per_tick);

// Reading the counters may take this share of the time of a stage, in percent; above, its figures
// are not given.
#define RB_HARDWARE_OVERHEAD_MOST 1.0

// Per ray; NaN where it is not known. The categories are percent of their sum: below 0 counts as 0.
struct rb_hardware_figures {
    double numbers[RB_VALUES_MAX]; // all values of the file, by index
    double compute_pct, compute_stall_pct, memory_stall_pct, other_pct;
    double sum_pct; // of the categories before that, of their total; 100 where the formulas fit
    double overhead_pct;
};

// Figures of a kernel at a bounce; with bounce -1, of all together.
struct rb_hardware_figures rb_hardware_figures(const struct rb_hardware *hardware,
                                               enum rb_stage stage, int bounce);

// A value by its name, NaN if the file has none such.
double rb_hardware_value(const struct rb_hardware *hardware,
                         const struct rb_hardware_figures *figures, const char *name);

// The categories of values: percents of their sum, and the sum in percent of the total.
void rb_hardware_categorise(const struct rb_values *values, struct rb_hardware_figures *figures);

// Why a place has no figures; "" if nothing is wrong with it.
enum { RB_HARDWARE_TEXT = 320 };
void rb_hardware_reason(const struct rb_hardware *hardware, enum rb_stage stage, int bounce,
                        char text[RB_HARDWARE_TEXT]);

// What was counted and how, in a line: the file, whether anybody has verified it, how it was read
// and what that costs.
void rb_hardware_describe(const struct rb_hardware *hardware, char text[RB_HARDWARE_TEXT]);

// Where the categories come from, such as "pmu:zen4 (unverified)"; "" if there are none.
void rb_hardware_category_source(const struct rb_hardware *hardware, char text[96]);

#endif
