#include "render/variants.h"

#include "base/cpu.h"
#include "embree/embree.h"
#include "render/embree_rows.h"

#include <stddef.h>
#include <string.h>

#define OPENMP  "OpenMP"
#define PACKETS "packet-*"
#define FRUSTUM "frustum-*"

#define KERNELS(set) .kernels = &(set), .counted = &set##_counted

#ifdef __x86_64__
#define X86(set)  KERNELS(set)
#define NEON(set) .kernels = NULL
#elif defined(__aarch64__)
#define X86(set)  .kernels = NULL
#define NEON(set) KERNELS(set)
#else
#define X86(set)  .kernels = NULL
#define NEON(set) .kernels = NULL
#endif

#if RB_EMBREE
#define EMBREE .kernels = &rb_embree_avx2[RB_EMBREE_PACKET][0]
#else
#define EMBREE .kernels = NULL
#endif
static const struct rb_embree_tree embree_tree = {.high = false};

// A serial row, and the one whose tiles are shared among threads: `what` says which kernels.
#define PAIR(row, text, base, tree, what, need, need_omp)                                          \
    {                                                                                              \
        .name = row,                                                                               \
        .summary = text,                                                                           \
        .baseline = base,                                                                          \
        .accelerator = tree,                                                                       \
        .schedule = rb_schedule_serial,                                                            \
        .needs = need,                                                                             \
        .exact = true,                                                                             \
        what,                                                                                      \
    },                                                                                             \
    {                                                                                              \
        .name = row "+omp", .summary = row ", tiles shared among threads", .baseline = row,        \
        .accelerator = tree, .schedule = rb_schedule_openmp, .needs = need_omp, .exact = true,     \
        what,                                                                                      \
    }

const struct rb_variant rb_variants[] = {
    PAIR("naive", "scalar reference: every ray against every primitive", "naive", RB_ACCEL_NONE,
         KERNELS(rb_kernels_naive), "", OPENMP),
    PAIR("bvh", "scalar binary BVH, binned SAH, one ray at a time", "naive", RB_ACCEL_BVH,
         KERNELS(rb_kernels_bvh), "", OPENMP),
    PAIR("bvh8-sse2", "one ray against 8 boxes, as 2 x 4 lanes", "bvh", RB_ACCEL_WIDE,
         X86(rb_kernels_wide_sse2), "sse2", "sse2," OPENMP),
    PAIR("bvh8-neon", "one ray against 8 boxes, as 2 x 4 lanes", "bvh", RB_ACCEL_WIDE,
         NEON(rb_kernels_wide_neon), "neon", "neon," OPENMP),
    PAIR("bvh8-avx2", "one ray against 8 boxes or primitives at once", "bvh", RB_ACCEL_WIDE,
         X86(rb_kernels_wide_avx2), "avx2", "avx2," OPENMP),
    PAIR("stream-sse2", "batches of rays go from node to node together, each against 8 boxes",
         "bvh8-sse2", RB_ACCEL_WIDE, X86(rb_kernels_stream_sse2), "sse2", "sse2," OPENMP),
    PAIR("stream-neon", "batches of rays go from node to node together, each against 8 boxes",
         "bvh8-neon", RB_ACCEL_WIDE, NEON(rb_kernels_stream_neon), "neon", "neon," OPENMP),
    PAIR("stream-avx2", "batches of rays go from node to node together, each against 8 boxes",
         "bvh8-avx2", RB_ACCEL_WIDE, X86(rb_kernels_stream_avx2), "avx2,bmi2", "avx2,bmi2," OPENMP),
    PAIR("packet-sse2", "packets of 4 rays through the binary BVH", "bvh", RB_ACCEL_BVH,
         X86(rb_kernels_packet_sse2), "sse2", "sse2," OPENMP),
    PAIR("packet-neon", "packets of 4 rays through the binary BVH", "bvh", RB_ACCEL_BVH,
         NEON(rb_kernels_packet_neon), "neon", "neon," OPENMP),
    PAIR("packet-avx2", "packets of 8 rays through the binary BVH", "bvh", RB_ACCEL_BVH,
         X86(rb_kernels_packet_avx2), "avx2", "avx2," OPENMP),
    PAIR("packet-avx512", "packets of 16 rays through the binary BVH", "bvh", RB_ACCEL_BVH,
         X86(rb_kernels_packet_avx512), "avx512f", "avx512f," OPENMP),
    PAIR("frustum-sse2", "bundles of 256 rays culled as a whole, else streams", "packet-sse2",
         RB_ACCEL_WIDE, X86(rb_kernels_frustum_sse2), "sse2", "sse2," OPENMP),
    PAIR("frustum-neon", "bundles of 256 rays culled as a whole, else streams", "packet-neon",
         RB_ACCEL_WIDE, NEON(rb_kernels_frustum_neon), "neon", "neon," OPENMP),
    PAIR("frustum-avx2", "bundles of 256 rays culled as a whole, else streams", "packet-avx2",
         RB_ACCEL_WIDE, X86(rb_kernels_frustum_avx2), "avx2,bmi2", "avx2,bmi2," OPENMP),
    PAIR("frustum-avx512", "bundles of 256 rays culled as a whole, else streams", "packet-avx512",
         RB_ACCEL_WIDE, X86(rb_kernels_frustum_avx512), "avx512f,bmi2", "avx512f,bmi2," OPENMP),
    PAIR("packet", "the widest packets this machine has", "bvh", RB_ACCEL_BVH, .best_of = PACKETS,
         PACKETS, PACKETS "," OPENMP),
    PAIR("auto", "the fastest this machine has: bundles of rays, or streams", "packet",
         RB_ACCEL_WIDE, .best_of = FRUSTUM, FRUSTUM, FRUSTUM "," OPENMP),
    {
        .name = "embree",
        .summary = "yardstick: Embree's packets of 8 rays",
        .baseline = "auto",
        EMBREE,
        .accelerator = RB_ACCEL_EMBREE,
        .schedule = rb_schedule_serial,
        .needs = RB_EMBREE_NEEDS ",avx2",
        .embree = &embree_tree,
    },
    {
        .name = "embree+omp",
        .summary = "embree, tiles shared among threads",
        .baseline = "embree",
        EMBREE,
        .accelerator = RB_ACCEL_EMBREE,
        .schedule = rb_schedule_openmp,
        .needs = RB_EMBREE_NEEDS ",avx2," OPENMP,
        .embree = &embree_tree,
    },
    {.name = NULL},
};

static const struct rb_variant *find_in(const struct rb_variant *table, const char *name)
{
    for (const struct rb_variant *variant = table; variant->name; variant++)
        if (strcmp(variant->name, name) == 0)
            return variant;
    return NULL;
}

const struct rb_variant *rb_variant_find(const char *name)
{
    const struct rb_variant *variant = find_in(rb_variants, name);
    return variant ? variant : find_in(rb_embree_rows, name);
}

static bool is_item(const char *item, int length, const char *name)
{
    return length == (int)strlen(name) && memcmp(item, name, strlen(name)) == 0;
}

// An item of a list of needs: OpenMP, libembree, the rows that the variant is the best of, or a
// feature.
static bool have(const struct rb_variant *variant, const char *item, int length)
{
    if (is_item(item, length, RB_EMBREE_NEEDS))
        return rb_embree_version() != NULL;
    if (is_item(item, length, OPENMP)) {
#ifdef _OPENMP
        return true;
#else
        return false;
#endif
    }
    if (item[length - 1] == '*')
        return rb_variant_resolve(variant) != NULL;
    return rb_cpu_has(item, length);
}

bool rb_variant_available(const struct rb_variant *variant)
{
    bool available = variant->kernels || variant->best_of;
    for (const char *item = variant->needs; *item;) {
        int length = (int)strcspn(item, ",");
        available = available && have(variant, item, length);
        item += length + (item[length] == ',');
    }
    return available;
}

const struct rb_variant *rb_variant_resolve(const struct rb_variant *variant)
{
    if (!variant->best_of)
        return variant;
    const struct rb_variant *best = NULL;
    size_t common = strcspn(variant->best_of, "*");
    for (const struct rb_variant *v = rb_variants; v->name; v++)
        if (!v->best_of && v->schedule == variant->schedule && rb_variant_available(v) &&
            strncmp(v->name, variant->best_of, common) == 0)
            best = v;
    return best;
}

bool rb_variant_parallel(const struct rb_variant *variant)
{
    return variant->schedule != rb_schedule_serial;
}

const struct rb_variant *rb_variant_fastest(void)
{
    const struct rb_variant *fastest = rb_variants;
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++)
        if (variant->exact && !variant->best_of && rb_variant_available(variant))
            fastest = variant;
    return fastest;
}
