// One repetition: what a worker process has measured in one frame, or in one group of tiles, as it
// is sent to the harness and kept.
#ifndef RB_RUN_SAMPLE_H
#define RB_RUN_SAMPLE_H

#include "measure/probe.h"

#include <stdbool.h>
#include <stdint.h>

// Times are those of all threads together, in ns, but for wall_ns, build_ns and busy_max_ns.
struct rb_sample_stage {
    uint64_t ns, rays, calls;
};

struct rb_sample {
    uint64_t magic;      // RB_SAMPLE_MAGIC, or the sender is another version of the program
    uint32_t process;    // round, from 0
    uint32_t repetition; // within the process, from 0
    int32_t threads;     // that took part
    int32_t cpu;         // that the process is held on; -1: on none
    bool mismatch;       // hits, image or rays are not those of the reference
    int8_t steady;       // the last two frames before it were within 5 %: 1, 0; -1: not known
    uint64_t wall_ns, busy_max_ns, build_ns;
    uint64_t tree_bytes, peak_bytes;
    uint64_t image_hash, hits_hash; // hits: of the frame that was verified, before this one
    int64_t context_switches;       // involuntary, of all threads
    int64_t migrations;             // -1: not known
    double steal_ms;                // of the whole machine; NaN: not known
    struct rb_sample_stage stage[RB_STAGE_COUNT][RB_BOUNCE_MAX];
    uint64_t reflected[RB_BOUNCE_MAX], refracted[RB_BOUNCE_MAX];
    uint64_t compared, differ; // rays of a row that is not exact, and those otherwise than recorded
};

enum { RB_SAMPLE_VERSION = 3, RB_REPETITIONS_MAX = 32 };
#define RB_SAMPLE_MAGIC                                                                            \
    ((uint64_t)0x7262 << 48 | RB_SAMPLE_VERSION << 24 | sizeof(struct rb_sample))

// Thread time of a stage over all bounces, of all stages, and the rays of trace and trace_shadow.
uint64_t rb_sample_stage_ns(const struct rb_sample *sample, enum rb_stage stage);
uint64_t rb_sample_busy_ns(const struct rb_sample *sample);
uint64_t rb_sample_rays(const struct rb_sample *sample);

// False if the sender was built without probes: stages have rays and calls, but no times.
bool rb_sample_has_stages(const struct rb_sample *sample);

// Each call of a stage was ended by a probe.
uint64_t rb_sample_probes(const struct rb_sample *sample);

#endif
