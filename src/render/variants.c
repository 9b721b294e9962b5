#include "render/variants.h"

#include "base/cpu.h"

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

const struct rb_variant rb_variants[] = {
    {
        .name = "naive",
        .summary = "scalar reference: every ray against every primitive",
        .baseline = "naive",
        KERNELS(rb_kernels_naive),
        .accelerator = RB_ACCEL_NONE,
        .schedule = rb_schedule_serial,
        .needs = "",
        .exact = true,
    },
    {
        .name = "naive+omp",
        .summary = "naive, tiles shared among threads",
        .baseline = "naive",
        KERNELS(rb_kernels_naive),
        .accelerator = RB_ACCEL_NONE,
        .schedule = rb_schedule_openmp,
        .needs = OPENMP,
        .exact = true,
    },
    {
        .name = "bvh",
        .summary = "scalar binary BVH, binned SAH, one ray at a time",
        .baseline = "naive",
        KERNELS(rb_kernels_bvh),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = "",
        .exact = true,
    },
    {
        .name = "bvh+omp",
        .summary = "bvh, tiles shared among threads",
        .baseline = "bvh",
        KERNELS(rb_kernels_bvh),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = OPENMP,
        .exact = true,
    },
    {
        .name = "bvh8-sse2",
        .summary = "one ray against 8 boxes, as 2 x 4 lanes",
        .baseline = "bvh",
        X86(rb_kernels_wide_sse2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "sse2",
        .exact = true,
    },
    {
        .name = "bvh8-sse2+omp",
        .summary = "bvh8-sse2, tiles shared among threads",
        .baseline = "bvh8-sse2",
        X86(rb_kernels_wide_sse2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "sse2," OPENMP,
        .exact = true,
    },
    {
        .name = "bvh8-neon",
        .summary = "one ray against 8 boxes, as 2 x 4 lanes",
        .baseline = "bvh",
        NEON(rb_kernels_wide_neon),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "neon",
        .exact = true,
    },
    {
        .name = "bvh8-neon+omp",
        .summary = "bvh8-neon, tiles shared among threads",
        .baseline = "bvh8-neon",
        NEON(rb_kernels_wide_neon),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "neon," OPENMP,
        .exact = true,
    },
    {
        .name = "bvh8-avx2",
        .summary = "one ray against 8 boxes or primitives at once",
        .baseline = "bvh",
        X86(rb_kernels_wide_avx2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "avx2",
        .exact = true,
    },
    {
        .name = "bvh8-avx2+omp",
        .summary = "bvh8-avx2, tiles shared among threads",
        .baseline = "bvh8-avx2",
        X86(rb_kernels_wide_avx2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "avx2," OPENMP,
        .exact = true,
    },
    {
        .name = "stream-sse2",
        .summary = "batches of rays go from node to node together, each against 8 boxes",
        .baseline = "bvh8-sse2",
        X86(rb_kernels_stream_sse2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "sse2",
        .exact = true,
    },
    {
        .name = "stream-sse2+omp",
        .summary = "stream-sse2, tiles shared among threads",
        .baseline = "stream-sse2",
        X86(rb_kernels_stream_sse2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "sse2," OPENMP,
        .exact = true,
    },
    {
        .name = "stream-neon",
        .summary = "batches of rays go from node to node together, each against 8 boxes",
        .baseline = "bvh8-neon",
        NEON(rb_kernels_stream_neon),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "neon",
        .exact = true,
    },
    {
        .name = "stream-neon+omp",
        .summary = "stream-neon, tiles shared among threads",
        .baseline = "stream-neon",
        NEON(rb_kernels_stream_neon),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "neon," OPENMP,
        .exact = true,
    },
    {
        .name = "stream-avx2",
        .summary = "batches of rays go from node to node together, each against 8 boxes",
        .baseline = "bvh8-avx2",
        X86(rb_kernels_stream_avx2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "avx2,bmi2",
        .exact = true,
    },
    {
        .name = "stream-avx2+omp",
        .summary = "stream-avx2, tiles shared among threads",
        .baseline = "stream-avx2",
        X86(rb_kernels_stream_avx2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "avx2,bmi2," OPENMP,
        .exact = true,
    },
    {
        .name = "packet-sse2",
        .summary = "packets of 4 rays through the binary BVH",
        .baseline = "bvh",
        X86(rb_kernels_packet_sse2),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = "sse2",
        .exact = true,
    },
    {
        .name = "packet-sse2+omp",
        .summary = "packet-sse2, tiles shared among threads",
        .baseline = "packet-sse2",
        X86(rb_kernels_packet_sse2),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = "sse2," OPENMP,
        .exact = true,
    },
    {
        .name = "packet-neon",
        .summary = "packets of 4 rays through the binary BVH",
        .baseline = "bvh",
        NEON(rb_kernels_packet_neon),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = "neon",
        .exact = true,
    },
    {
        .name = "packet-neon+omp",
        .summary = "packet-neon, tiles shared among threads",
        .baseline = "packet-neon",
        NEON(rb_kernels_packet_neon),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = "neon," OPENMP,
        .exact = true,
    },
    {
        .name = "packet-avx2",
        .summary = "packets of 8 rays through the binary BVH",
        .baseline = "bvh",
        X86(rb_kernels_packet_avx2),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = "avx2",
        .exact = true,
    },
    {
        .name = "packet-avx2+omp",
        .summary = "packet-avx2, tiles shared among threads",
        .baseline = "packet-avx2",
        X86(rb_kernels_packet_avx2),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = "avx2," OPENMP,
        .exact = true,
    },
    {
        .name = "packet-avx512",
        .summary = "packets of 16 rays through the binary BVH",
        .baseline = "bvh",
        X86(rb_kernels_packet_avx512),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = "avx512f",
        .exact = true,
    },
    {
        .name = "packet-avx512+omp",
        .summary = "packet-avx512, tiles shared among threads",
        .baseline = "packet-avx512",
        X86(rb_kernels_packet_avx512),
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = "avx512f," OPENMP,
        .exact = true,
    },
    {
        .name = "frustum-sse2",
        .summary = "bundles of 256 rays culled as a whole, else streams",
        .baseline = "packet-sse2",
        X86(rb_kernels_frustum_sse2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "sse2",
        .exact = true,
    },
    {
        .name = "frustum-sse2+omp",
        .summary = "frustum-sse2, tiles shared among threads",
        .baseline = "frustum-sse2",
        X86(rb_kernels_frustum_sse2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "sse2," OPENMP,
        .exact = true,
    },
    {
        .name = "frustum-neon",
        .summary = "bundles of 256 rays culled as a whole, else streams",
        .baseline = "packet-neon",
        NEON(rb_kernels_frustum_neon),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "neon",
        .exact = true,
    },
    {
        .name = "frustum-neon+omp",
        .summary = "frustum-neon, tiles shared among threads",
        .baseline = "frustum-neon",
        NEON(rb_kernels_frustum_neon),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "neon," OPENMP,
        .exact = true,
    },
    {
        .name = "frustum-avx2",
        .summary = "bundles of 256 rays culled as a whole, else streams",
        .baseline = "packet-avx2",
        X86(rb_kernels_frustum_avx2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "avx2,bmi2",
        .exact = true,
    },
    {
        .name = "frustum-avx2+omp",
        .summary = "frustum-avx2, tiles shared among threads",
        .baseline = "frustum-avx2",
        X86(rb_kernels_frustum_avx2),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "avx2,bmi2," OPENMP,
        .exact = true,
    },
    {
        .name = "frustum-avx512",
        .summary = "bundles of 256 rays culled as a whole, else streams",
        .baseline = "packet-avx512",
        X86(rb_kernels_frustum_avx512),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = "avx512f,bmi2",
        .exact = true,
    },
    {
        .name = "frustum-avx512+omp",
        .summary = "frustum-avx512, tiles shared among threads",
        .baseline = "frustum-avx512",
        X86(rb_kernels_frustum_avx512),
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = "avx512f,bmi2," OPENMP,
        .exact = true,
    },
    {
        .name = "packet",
        .summary = "the widest packets this machine has",
        .baseline = "bvh",
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = PACKETS,
        .exact = true,
        .best_of = PACKETS,
    },
    {
        .name = "packet+omp",
        .summary = "packet, tiles shared among threads",
        .baseline = "packet",
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = PACKETS "," OPENMP,
        .exact = true,
        .best_of = PACKETS,
    },
    {
        .name = "auto",
        .summary = "the fastest this machine has: bundles of rays, or streams",
        .baseline = "packet",
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_serial,
        .needs = FRUSTUM,
        .exact = true,
        .best_of = FRUSTUM,
    },
    {
        .name = "auto+omp",
        .summary = "auto, tiles shared among threads",
        .baseline = "auto",
        .accelerator = RB_ACCEL_WIDE,
        .schedule = rb_schedule_openmp,
        .needs = FRUSTUM "," OPENMP,
        .exact = true,
        .best_of = FRUSTUM,
    },
    {.name = NULL},
};

const struct rb_variant *rb_variant_find(const char *name)
{
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++)
        if (strcmp(variant->name, name) == 0)
            return variant;
    return NULL;
}

// An item of a list of needs: OpenMP, the rows that the variant is the best of, or a feature.
static bool have(const struct rb_variant *variant, const char *item, int length)
{
    if (length == (int)strlen(OPENMP) && memcmp(item, OPENMP, strlen(OPENMP)) == 0) {
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
        if (!variant->best_of && rb_variant_available(variant))
            fastest = variant;
    return fastest;
}
