// Counting events in a process that measures.
#ifndef RB_RUN_HARDWARE_MEASURE_H
#define RB_RUN_HARDWARE_MEASURE_H

#include "bench/run/repeat.h"

// Repeats what repeater->how says, with the groups of events in turn, each at least once, until the
// process's time is up; then writes a struct rb_hardware. `events` as in rb_event_file_choose.
enum rb_status rb_hardware_measure(struct rb_repeater *repeater, const char *events,
                                   struct rb_error *error);

#endif
