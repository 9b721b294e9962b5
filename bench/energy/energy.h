// What has been measured of the energy of a cell: whole frames, and kernels alone at each bounce on
// recorded rays; and the figures that follow.
#ifndef RB_ENERGY_ENERGY_H
#define RB_ENERGY_ENERGY_H

#include "bench/energy/meter.h"
#include "measure/probe.h"

// Every place is repeated for at least so long: 1000 updates of the hardware's counters, of which
// two are in doubt, 0.2 %.
#define RB_ENERGY_SECONDS_LEAST 1.0

// What a process that measures energy sends behind its sample. Of a kernel alone or of frames.
struct rb_energy_span {
    double joules, seconds; // gross; seconds 0: nothing was measured
    double units;           // rays, or frames
};

struct rb_energy {
    struct rb_energy_span frames, place[RB_KERNEL_COUNT][RB_BOUNCE_MAX];
    double idle_before_w, idle_after_w;
    char source[64];              // as rb_meter_describe
    char note[192], kernels[192]; // why nothing was measured at all, or of kernels; ""
};

// Joules, NaN where there are none: per ray or frame, with what the idle machine takes, and without
// it: gross - idle power x time. Net is not known where it would not be above 0.
struct rb_energy_figures {
    double gross, net;
    double seconds; // a ray, or a frame
};
struct rb_energy_figures rb_energy_figures(const struct rb_energy *energy,
                                           const struct rb_energy_span *span);

// Power of the idle machine, over so many seconds, or 2 if that is 0. RB_FAILED if a counter stands
// still: no machine takes 0 W.
enum rb_status rb_energy_idle(struct rb_meter *meter, double seconds, double *watts,
                              struct rb_error *error);

#endif
