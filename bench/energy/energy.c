#define _POSIX_C_SOURCE 200809L
#include "bench/energy/energy.h"

#include "measure/clock.h"

#include <math.h>
#include <time.h>

struct rb_energy_figures rb_energy_figures(const struct rb_energy *energy,
                                           const struct rb_energy_span *span)
{
    const double none = (double)NAN;
    struct rb_energy_figures figures = {none, none, none};
    if (!(span->seconds > 0) || !(span->joules > 0) || !(span->units > 0))
        return figures;
    double idle_w = (energy->idle_before_w + energy->idle_after_w) / 2;
    double net = span->joules - idle_w * span->seconds;
    figures.gross = span->joules / span->units;
    figures.net = net > 0 ? net / span->units : none;
    figures.seconds = span->seconds / span->units;
    return figures;
}

enum rb_status rb_energy_idle(struct rb_meter *meter, double seconds, double *watts,
                              struct rb_error *error)
{
    seconds = seconds > 0 ? seconds : 2;
    struct timespec pause = {(time_t)seconds, (long)(fmod(seconds, 1) * 1e9)};
    double before, after;
    uint64_t start_ns = rb_clock_ns();
    enum rb_status status = rb_meter_read(meter, &before, error);
    nanosleep(&pause, NULL); // a signal makes it shorter, which the clock sees
    if (status == RB_OK)
        status = rb_meter_read(meter, &after, error);
    if (status)
        return status;
    *watts = (after - before) / ((double)(rb_clock_ns() - start_ns) * 1e-9);
    return after > before ? RB_OK
                          : rb_error_set(error, RB_FAILED,
                                         "the counters of energy stand still, as in virtual "
                                         "machines; use --energy-model");
}
