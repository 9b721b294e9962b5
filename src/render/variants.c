#include "render/variants.h"

#include "base/cpu.h"
#include "embree/embree.h"
#include "render/embree_rows.h"

#include <stddef.h>
#include <string.h>

#define OPENMP  "OpenMP"
#define PACKETS "packet-*"

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
        .name = "embree",
        .summary = "yardstick: Embree's packets of 8 rays",
        .baseline = "packet",
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
