#include "bench/run/energy_measure.h"

#include "bench/energy/energy.h"
#include "bench/hardware/event_file.h"

#include <math.h>

enum rb_status rb_energy_measure(struct rb_repeater *repeater, int bounce, struct rb_error *error)
{
    const struct rb_replay *replay = repeater->how.replay;
    struct rb_energy_span span = {.units = 0};
    struct rb_run_result result;
    struct rb_meter meter;
    double before = 0, seconds = fmax(repeater->slice_s, RB_ENERGY_SECONDS_LEAST), elapsed_s;
    repeater->how.hash_hits = false;
    rb_repeater_warm_up(repeater);
    enum rb_status status = rb_meter_open(&meter, rb_hardware_root(), error);
    if (status)
        return status;
    status = rb_meter_read(&meter, &before, error);
    uint64_t start_ns = rb_clock_ns();
    do {
        rb_repeater_measure(repeater, &result);
        span.seconds += (double)result.wall_ns * 1e-9;
        span.units += replay ? (double)result.recorder.tally[replay->kernel][bounce].rays : 1;
        elapsed_s = (double)(rb_clock_ns() - start_ns) * 1e-9;
    } while (elapsed_s < seconds);
    if (status == RB_OK)
        status = rb_meter_read(&meter, &span.joules, error);
    rb_meter_close(&meter);
    if (status)
        return status;
    span.joules = (span.joules - before) * span.seconds / elapsed_s;
    return rb_repeater_write(&span, sizeof span, error);
}
