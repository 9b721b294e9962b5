#include "render/embree_rows.h"

#include "embree/embree.h"

#include <stddef.h>

#if RB_EMBREE

#define ROW(text, set, way, light, suffix, index, need)                                            \
    {                                                                                              \
        .name = "embree-" text suffix, .summary = "Embree, one of its ways", .baseline = "embree", \
        .kernels = &set[way][light], .accelerator = RB_ACCEL_EMBREE,                               \
        .schedule = rb_schedule_serial, .needs = RB_EMBREE_NEEDS "," need, .embree = &trees[index] \
    }

#define BOTH(text, set, way, suffix, index, need)                                                  \
    ROW(text, set, way, 0, suffix, index, need),                                                   \
        ROW(text, set, way, 1, suffix "-light", index, need)

#define NARROW(suffix, index, need)                                                                \
    BOTH("single", rb_embree_avx2, RB_EMBREE_SINGLE, suffix, index, need),                         \
        BOTH("packet8", rb_embree_avx2, RB_EMBREE_PACKET, suffix, index, need),                    \
        BOTH("packet8c", rb_embree_avx2, RB_EMBREE_PACKET_COHERENT, suffix, index, need),          \
        BOTH("stream", rb_embree_avx2, RB_EMBREE_STREAM, suffix, index, need),                     \
        BOTH("streamc", rb_embree_avx2, RB_EMBREE_STREAM_COHERENT, suffix, index, need)

#define WIDE(suffix, index)                                                                        \
    BOTH("packet16", rb_embree_avx512, RB_EMBREE_PACKET, suffix, index, "avx512f"),                \
        BOTH("packet16c", rb_embree_avx512, RB_EMBREE_PACKET_COHERENT, suffix, index, "avx512f")

static const struct rb_embree_tree trees[] = {
    {false, false, NULL},   {false, true, NULL},   {true, false, NULL},   {true, true, NULL},
    {false, false, "avx2"}, {false, true, "avx2"}, {true, false, "avx2"}, {true, true, "avx2"},
};

const struct rb_variant rb_embree_rows[] = {
    NARROW("", 0, "avx2"),
    WIDE("", 0),
    NARROW("-native", 1, "avx2"),
    WIDE("-native", 1),
    NARROW("-high", 2, "avx2"),
    WIDE("-high", 2),
    NARROW("-native-high", 3, "avx2"),
    WIDE("-native-high", 3),
    NARROW("-avx2", 4, "avx512f"), // elsewhere they are those above
    NARROW("-native-avx2", 5, "avx512f"),
    NARROW("-high-avx2", 6, "avx512f"),
    NARROW("-native-high-avx2", 7, "avx512f"),
    {.name = NULL},
};

#else

const struct rb_variant rb_embree_rows[] = {{.name = NULL}};

#endif
