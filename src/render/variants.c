#include "render/variants.h"

#include <stddef.h>
#include <string.h>

#define OPENMP "OpenMP"

const struct rb_variant rb_variants[] = {
    {
        .name = "naive",
        .summary = "scalar reference: every ray against every primitive",
        .baseline = "naive",
        .kernels = &rb_kernels_naive,
        .accelerator = RB_ACCEL_NONE,
        .schedule = rb_schedule_serial,
        .needs = "",
        .exact = true,
    },
    {
        .name = "naive+omp",
        .summary = "naive, tiles shared among threads",
        .baseline = "naive",
        .kernels = &rb_kernels_naive,
        .accelerator = RB_ACCEL_NONE,
        .schedule = rb_schedule_openmp,
        .needs = OPENMP,
        .exact = true,
    },
    {
        .name = "bvh",
        .summary = "scalar binary BVH, binned SAH, one ray at a time",
        .baseline = "naive",
        .kernels = &rb_kernels_bvh,
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_serial,
        .needs = "",
        .exact = true,
    },
    {
        .name = "bvh+omp",
        .summary = "bvh, tiles shared among threads",
        .baseline = "bvh",
        .kernels = &rb_kernels_bvh,
        .accelerator = RB_ACCEL_BVH,
        .schedule = rb_schedule_openmp,
        .needs = OPENMP,
        .exact = true,
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

bool rb_variant_available(const struct rb_variant *variant)
{
#ifdef _OPENMP
    (void)variant;
    return true;
#else
    return strcmp(variant->needs, OPENMP) != 0;
#endif
}

bool rb_variant_parallel(const struct rb_variant *variant)
{
    return variant->schedule != rb_schedule_serial;
}

const struct rb_variant *rb_variant_fastest(void)
{
    const struct rb_variant *fastest = rb_variants;
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++)
        if (rb_variant_available(variant))
            fastest = variant;
    return fastest;
}
