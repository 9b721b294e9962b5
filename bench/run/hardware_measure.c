#include "bench/run/hardware_measure.h"

#include "bench/hardware/hardware.h"

enum rb_status rb_hardware_measure(struct rb_repeater *repeater, const char *events,
                                   struct rb_error *error)
{
    // Too large for the stack.
    static struct rb_event_file file;
    static struct rb_hardware hardware;
    static struct rb_event_table table;
    struct rb_hardware_groups groups;
    struct rb_run_result result;
    enum rb_status status = rb_event_file_choose(rb_hardware_root(), events, &file, error);
    if (status)
        return status;
    rb_hardware_make_groups(&file, rb_hardware_root(), &groups, &hardware);
    repeater->how.hash_hits = false;
    repeater->how.counts = NULL;
    rb_repeater_warm_up(repeater);
    double left_s = 1;
    for (int turn = 0; turn < groups.count || left_s > 0; turn++) {
        int group = turn % groups.count;
        table = (struct rb_event_table){.cost_ticks = 0};
        repeater->how.events = &table;
        repeater->how.event_group = &groups.group[group];
        rb_repeater_measure(repeater, &result);
        rb_hardware_book(&hardware, &groups, group, &table, &result.recorder,
                         rb_clock_ns_per_tick());
        left_s = repeater->slice_s -
                 (double)(rb_clock_ns() - repeater->start_ns + result.wall_ns) * 1e-9;
    }
    repeater->how.events = NULL;
    return rb_repeater_write(&hardware, sizeof hardware, error);
}
