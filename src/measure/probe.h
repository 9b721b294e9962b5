// Probes between the stages of the pipeline: where the time of a thread goes, by kernel and bounce.
//
// Time is measured in laps: each lap reads the clock once and books everything since the last lap
// on one stage. Nothing falls between two laps, so the stages of a thread add up to its total.
#ifndef RB_MEASURE_PROBE_H
#define RB_MEASURE_PROBE_H

#include "measure/clock.h"

#include <stdint.h>

// Built with -DRB_PROBES=0, laps count rays but read no clock: what probes cost is the difference.
#ifndef RB_PROBES
#define RB_PROBES 1
#endif

enum rb_stage {
    RB_STAGE_GENERATE,
    RB_STAGE_TRACE,
    RB_STAGE_SHADE,
    RB_STAGE_TRACE_SHADOW,
    RB_KERNEL_COUNT,                    // the four kernels of the tables come first
    RB_STAGE_RESOLVE = RB_KERNEL_COUNT, // adding light to pixels
    RB_STAGE_OTHER,                     // handing out work, moving rays between queues
    RB_STAGE_COUNT,
};

enum { RB_BOUNCE_MAX = 32 };

extern const char *const rb_stage_names[RB_STAGE_COUNT];

// One kernel at one bounce. `rays` are the queue entries the kernel worked on, misses included;
// `calls` how often it was called, or for shade, which is two functions, both.
struct rb_tally {
    uint64_t ticks, rays, calls;
};

// Of one thread. Zero-initialise, then rb_probe_start.
struct rb_recorder {
    struct rb_tally tally[RB_STAGE_COUNT][RB_BOUNCE_MAX];
    uint64_t reflected[RB_BOUNCE_MAX], refracted[RB_BOUNCE_MAX]; // rays by the bounce they enter
    uint64_t hits[RB_BOUNCE_MAX];                                // rays that hit something
    uint64_t last;                                               // when the running lap began
};

static inline void rb_probe_start(struct rb_recorder *recorder)
{
    recorder->last = RB_PROBES ? rb_clock_ticks() : 0;
}

static inline void rb_probe_lap(struct rb_recorder *recorder, enum rb_stage stage, int bounce,
                                uint64_t rays)
{
    uint64_t now = RB_PROBES ? rb_clock_ticks() : 0;
    struct rb_tally *tally = &recorder->tally[stage][bounce];
    tally->ticks += now - recorder->last;
    tally->rays += rays;
    tally->calls++;
    recorder->last = now;
}

// Makes the running lap longer by `share` of itself, spinning. For tests of the harness: a
// slow-down of known size in a known place.
void rb_probe_spin(const struct rb_recorder *recorder, double share);

// Adds everything `other` has recorded.
void rb_recorder_add(struct rb_recorder *recorder, const struct rb_recorder *other);

// Ticks of all bounces of a stage, and of all stages.
uint64_t rb_recorder_stage_ticks(const struct rb_recorder *recorder, enum rb_stage stage);
uint64_t rb_recorder_ticks(const struct rb_recorder *recorder);

// Nanoseconds one lap takes: the least mean of 100 runs of 1000 laps with nothing in between.
double rb_probe_cost_ns(void);

#endif
