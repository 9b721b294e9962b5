// Laps for a simulator: under valgrind's callgrind each lap dumps what the simulated processor did
// since the last one, with a label that says for which stage and bounce. Natively nothing happens.
//
//     rb_simulate_start();                  // what came before costs nothing
//     ...                                   // warms the simulated caches
//     rb_simulate_begin();
//     rb_simulate_lap(stage, bounce, rays); // ends a stage, again and again
//     rb_simulate_stop();
//     rb_simulate_end(hits, row);           // closes the record
//
// Collection is toggled and not instrumentation, which would empty the simulated caches each time.
// bench/simulate runs the simulator and reads the dumps. For one thread.
//
// Source: the Callgrind manual, "Callgrind specific client requests". A request that is executed
// natively is a few rotations of registers, about 2 ns.
#ifndef RB_MEASURE_SIMULATE_H
#define RB_MEASURE_SIMULATE_H

#include "measure/probe.h"

#include <stdbool.h>

// The label of a lap, its numbers in hexadecimal with all their digits, and that of the end.
#define RB_SIMULATE_LAP "stage=0 bounce=00 rays=0000000000000000"
#define RB_SIMULATE_END "end hits=%016llx row=%.32s"

// Was the program built with valgrind's headers? Does it run under valgrind?
bool rb_simulate_built(void);
bool rb_simulate_running(void);

// Starts the simulation of a program under --instr-atstart=no, with empty caches.
void rb_simulate_start(void);

// Starts to collect; the first lap begins here.
void rb_simulate_begin(void);

// Ends a lap and begins the next one. Nothing where nothing is collected.
void rb_simulate_lap(enum rb_stage stage, int bounce, uint64_t rays);

// Stops to collect. What came after the last lap is dropped.
void rb_simulate_stop(void);

// Closes the record: the hash of the hits, and the name of the row that did the work. A record
// without this end is cut short.
void rb_simulate_end(uint64_t hits, const char *row);

#endif
