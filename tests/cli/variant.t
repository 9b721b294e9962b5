#!/bin/sh
# Adding a variant takes one file and one row of the table: a copy of the sources gets both, and
# must build, list, verify and measure the newcomer without another change.
. "$(dirname "$0")/tap.sh"

cp -r Makefile src bench "$tmp/"
cat >"$tmp/src/kernels/dummy.c" <<'END'
#include "kernels/kernel.h"

// Lends its bodies from others.
static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels rb_kernels_dummy = {rb_scalar_generate, trace, rb_scalar_surface,
                                            rb_scalar_light, trace_shadow};

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    rb_kernels_bvh.trace(world, rays, hits);
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    rb_kernels_bvh.trace_shadow(world, shadows);
}
END
declaration='extern const struct rb_kernels rb_kernels_dummy;'
row='{"dummy", "-", "bvh", \&rb_kernels_dummy, RB_ACCEL_BVH, rb_schedule_serial, "", true, 0},'
sed -i "s/^extern const struct rb_kernels rb_kernels_bvh;/&\n$declaration/" \
    "$tmp/src/kernels/kernel.h"
sed -i "s/^    {.name = NULL},/    $row\n&/" "$tmp/src/render/variants.c"
env -u MAKEFLAGS -u MAKEOVERRIDES make -s -C "$tmp" -j 2 CONFIG=release SANITIZE= OPT=-O1 all \
    >"$tmp/log" 2>&1
check 'it builds' [ -x "$tmp/build/release/raybench" ]
reference=$("$raybench" render mount_low --size 48x48 --hash --quiet)
raybench=$tmp/build/release/raybench
check 'it is listed' exits 0 list variants
check 'by its name' grep -q '^dummy ' "$tmp/out"
check 'it renders' exits 0 render mount_low --size 48x48 --variant dummy --hash --quiet
check 'the same image and hits' [ "$(cat "$tmp/out")" = "$reference" ]
check 'it is measured' exits 0 bench mount_low --size 32x32 --budget 0.3 --out "$tmp/results"
check 'with a time' grep -qE '^"mount_low",32,32,5,1,1,64,dummy,1,trace,0,1024,[0-9]' \
    "$tmp/results/latest/kernels.csv"
finish
