// What a person reads of hardware counters, on standard output.
#ifndef RB_EXPLAIN_HARDWARE_TABLE_H
#define RB_EXPLAIN_HARDWARE_TABLE_H

#include "bench/hardware/hardware.h"

// All values of the file of events per ray and the categories, by kernel and bounce, with the
// reasons for what is missing; and what the file says of itself.
void rb_hardware_table_print(const struct rb_hardware *hardware);

#endif
