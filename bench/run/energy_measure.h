// Measuring energy in a process that measures.
#ifndef RB_RUN_ENERGY_MEASURE_H
#define RB_RUN_ENERGY_MEASURE_H

#include "bench/run/repeat.h"

// Repeats what repeater->how says until its time is up, at least RB_ENERGY_SECONDS_LEAST, and
// writes a struct rb_energy_span: of the frames, or, where it replays a kernel at a bounce, of its
// rays. What is done between repetitions, hashing the image, is taken out by its share of the time.
enum rb_status rb_energy_measure(struct rb_repeater *repeater, int bounce, struct rb_error *error);

#endif
