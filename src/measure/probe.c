#include "measure/probe.h"

const char *const rb_stage_names[RB_STAGE_COUNT] = {
    [RB_STAGE_GENERATE] = "generate", [RB_STAGE_TRACE] = "trace",
    [RB_STAGE_SHADE] = "shade",       [RB_STAGE_TRACE_SHADOW] = "trace_shadow",
    [RB_STAGE_RESOLVE] = "resolve",   [RB_STAGE_OTHER] = "other",
};

void rb_recorder_add(struct rb_recorder *recorder, const struct rb_recorder *other)
{
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
        for (int stage = 0; stage < RB_STAGE_COUNT; stage++) {
            recorder->tally[stage][bounce].ticks += other->tally[stage][bounce].ticks;
            recorder->tally[stage][bounce].rays += other->tally[stage][bounce].rays;
            recorder->tally[stage][bounce].calls += other->tally[stage][bounce].calls;
        }
        recorder->reflected[bounce] += other->reflected[bounce];
        recorder->refracted[bounce] += other->refracted[bounce];
        recorder->hits[bounce] += other->hits[bounce];
    }
}

uint64_t rb_recorder_stage_ticks(const struct rb_recorder *recorder, enum rb_stage stage)
{
    uint64_t ticks = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        ticks += recorder->tally[stage][bounce].ticks;
    return ticks;
}

uint64_t rb_recorder_ticks(const struct rb_recorder *recorder)
{
    uint64_t ticks = 0;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        ticks += rb_recorder_stage_ticks(recorder, (enum rb_stage)stage);
    return ticks;
}

void rb_probe_spin(const struct rb_recorder *recorder, double share)
{
    uint64_t start = rb_clock_ticks();
    double lap = (double)(start - recorder->last);
    while ((double)(rb_clock_ticks() - start) < lap * share)
        ;
}

double rb_probe_cost_ns(void)
{
    static struct rb_recorder recorder;
    uint64_t least = UINT64_MAX;
    for (int run = 0; run < 100; run++) {
        rb_probe_start(&recorder);
        uint64_t start = recorder.last;
        for (int i = 0; i < 1000; i++)
            rb_probe_lap(&recorder, RB_STAGE_OTHER, i % RB_BOUNCE_MAX, 0);
        uint64_t ticks = recorder.last - start;
        least = ticks < least ? ticks : least;
    }
    return (double)least / 1000.0 * rb_clock_ns_per_tick();
}
