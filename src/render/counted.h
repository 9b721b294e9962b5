// What the kernels did in a frame, by stage and bounce.
#ifndef RB_RENDER_COUNTED_H
#define RB_RENDER_COUNTED_H

#include "kernels/count.h"
#include "measure/probe.h"

struct rb_count_table {
    struct rb_counts at[RB_STAGE_COUNT][RB_BOUNCE_MAX];
};

#endif
