#!/bin/sh
# Adding a variant takes one file and one row of the table: a copy of the sources gets both, and
# must build, list, verify and measure the newcomer without another change. Two more rows are wrong,
# one by an ulp at one hit in a hundred, one in its shadows: they must get no time.
. "$(dirname "$0")/tap.sh"

cp -r Makefile src bench "$tmp/"
cat >"$tmp/src/kernels/dummy.c" <<'END'
#include "kernels/kernel.h"

#include <math.h>

// Lends its bodies from others.
static rb_trace_fn trace;
static rb_trace_shadow_fn trace_shadow;

const struct rb_kernels RB_TWIN(rb_kernels_dummy) = {
    RB_TWIN(rb_scalar_generate), trace, RB_TWIN(rb_scalar_surface), RB_TWIN(rb_scalar_light),
    trace_shadow};

static void trace(const struct rb_world *world, const struct rb_rays *rays, struct rb_hits *hits)
{
    RB_TWIN(rb_kernels_bvh).trace(world, rays, hits);
}

static void trace_shadow(const struct rb_world *world, struct rb_shadows *shadows)
{
    RB_TWIN(rb_kernels_bvh).trace_shadow(world, shadows);
}

static void trace_almost(const struct rb_world *world, const struct rb_rays *rays,
                         struct rb_hits *hits)
{
    RB_TWIN(rb_kernels_bvh).trace(world, rays, hits);
    for (uint32_t i = 0; i < rays->count; i++)
        if (rays->pixel[i] % 100 == 99 && hits->prim[i] != RB_NONE)
            hits->t[i] = nextafterf(hits->t[i], 0.0f);
}

static void shadow_almost(const struct rb_world *world, struct rb_shadows *shadows)
{
    RB_TWIN(rb_kernels_bvh).trace_shadow(world, shadows);
    for (uint32_t i = 0; i < shadows->count; i++)
        shadows->occluded[i] ^= shadows->pixel[i] % 100 == 99;
}

const struct rb_kernels RB_TWIN(rb_kernels_wrong) = {
    rb_scalar_generate, trace_almost, rb_scalar_surface, rb_scalar_light, trace_shadow};
const struct rb_kernels RB_TWIN(rb_kernels_dark) = {
    rb_scalar_generate, trace, rb_scalar_surface, rb_scalar_light, shadow_almost};
END
declaration=
for name in dummy wrong dark; do
    declaration="${declaration}RB_KERNEL_SET(rb_kernels_$name);\\n"
done
rows=
for name in dummy wrong dark; do
    rows="$rows{\"$name\", \"-\", \"bvh\", \\&rb_kernels_$name, RB_ACCEL_BVH, rb_schedule_serial,"
    rows="$rows \"\", true, 0, \\&rb_kernels_${name}_counted},\\n"
done
sed -i "s/^RB_KERNEL_SET(rb_kernels_bvh);/&\n$declaration/" \
    "$tmp/src/kernels/kernel.h"
sed -i "s/^    {.name = NULL},/    $rows&/" "$tmp/src/render/variants.c"
env -u MAKEFLAGS -u MAKEOVERRIDES make -s -C "$tmp" -j 2 CONFIG=release SANITIZE= OPT=-O1 all \
    >"$tmp/log" 2>&1
check 'it builds' [ -x "$tmp/build/release/raybench" ]
reference=$("$raybench" render mount_low --size 48x48 --hash --quiet)
raybench=$tmp/build/release/raybench
check 'it is listed' exits 0 list variants
check 'by its name' grep -q '^dummy ' "$tmp/out"
check 'it renders' exits 0 render mount_low --size 48x48 --variant dummy --hash --quiet
check 'the same image and hits' [ "$(cat "$tmp/out")" = "$reference" ]
check 'it is measured; wrong rows are an error' exits 2 bench mount_low --size 48x48 \
    --variants bvh,dummy,wrong,dark --budget 1 --out "$tmp/results"
csv=$tmp/results/latest/kernels.csv
lines() { grep -E "^mount_low,48,48,5,1,1,64,$1,1,trace,0,2304,$2" "$csv"; }
check 'with a time' lines dummy '[0-9]'
check 'hits off by an ulp get none, and the reason' lines wrong ',,,,0,invalid'
check 'wrong shadows get none' lines dark ',,,,0,invalid'
check 'a person is told' grep -q 'wrong: image or hits differ from the reference' "$tmp/err"
check 'in the table, too' grep -qE '^  dark .*invalid' "$tmp/out"
check 'rays are recorded' exits 0 record mount_low --size 48x48 -o "$tmp/rays" --quiet
replay() { exits "$1" replay "$tmp/rays" --variant "$2" --kernel "$3" --bounce 0 --seconds 0.02 \
    --processes 1; }
check 'and replayed by the new row' replay 0 dummy trace
check 'with a time' grep -qE '^  image +trace +0 +2304 +[0-9]' "$tmp/out"
check 'by the wrong one' replay 2 wrong trace
check 'without' grep -qE '^  image +trace +0 +2304 +- +invalid: differs from the record' "$tmp/out"
check 'it says which ray' grep -qE 'trace at bounce 0, batch 0, ray [0-9]+: t is not as recorded' \
    "$tmp/err"
check 'wrong shadows get none' replay 2 dark trace_shadow
check 'and the reason' grep -q ': occluded is not as recorded' "$tmp/err"
finish
