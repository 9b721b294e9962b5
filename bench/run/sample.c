#include "bench/run/sample.h"

uint64_t rb_sample_stage_ns(const struct rb_sample *sample, enum rb_stage stage)
{
    uint64_t ns = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        ns += sample->stage[stage][bounce].ns;
    return ns;
}

uint64_t rb_sample_busy_ns(const struct rb_sample *sample)
{
    uint64_t ns = 0;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        ns += rb_sample_stage_ns(sample, (enum rb_stage)stage);
    return ns;
}

uint64_t rb_sample_rays(const struct rb_sample *sample)
{
    uint64_t rays = 0;
    for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
        rays += sample->stage[RB_STAGE_TRACE][bounce].rays +
                sample->stage[RB_STAGE_TRACE_SHADOW][bounce].rays;
    return rays;
}

bool rb_sample_has_stages(const struct rb_sample *sample)
{
    return rb_sample_busy_ns(sample) > 0;
}

uint64_t rb_sample_probes(const struct rb_sample *sample)
{
    uint64_t calls = 0;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            calls += sample->stage[stage][bounce].calls;
    return calls;
}
