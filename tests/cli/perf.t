#!/bin/sh
# make perf, perf-stat, asm: what their scripts find. What is not installed is not tested.
. "$(dirname "$0")/tap.sh"
export RAYBENCH="$raybench"
export SCENE=balls_low SECONDS_EACH=0.2 VARIANT=bvh KERNEL=trace BOUNCE=1

runs() { "$@" >"$tmp/out" 2>"$tmp/err"; }
fails() { # PATTERN COMMAND...: one line on standard error
    pattern=$1
    shift
    ! runs "$@" && [ "$(wc -l <"$tmp/err")" = 1 ] && grep -q "$pattern" "$tmp/err"
}
if command -v objdump >/dev/null && readelf -h "$raybench" 2>/dev/null | grep -q DYN; then
    check 'the code of a kernel' runs scripts/asm
    check 'begins with it' grep -qE '^[0-9a-f]+ <trace.*>:$' "$tmp/out"
    check 'and has what it calls' [ "$(grep -cE '^[0-9a-f]+ <.*>:$' "$tmp/out")" -gt 1 ]
    check 'shade' runs env KERNEL=shade scripts/asm
    check 'is two functions' [ \
        "$(grep -cE '^[0-9a-f]+ <(rb_scalar_)?(surface|light)>:$' "$tmp/out")" = 2 ]
    check 'no such row' fails 'no row with kernels' env VARIANT=none scripts/asm
    check 'no such kernel' fails 'there are generate' env KERNEL=none scripts/asm
else
    echo '# skipped: no objdump, or a program at a fixed address'
fi

why=
perf record -q -e cpu-clock:u -o "$tmp/try" true >/dev/null 2>&1 || why='perf cannot record here'
grep -qE '__(asan|tsan)_init' "$raybench" && why='a sanitizer is in the way'
if [ -n "$why" ]; then
    echo "# skipped: $why"
    finish
    exit 0
fi
check 'a profile' runs scripts/perf
check 'has functions of the kernel' grep -qE '^ +[0-9.]+% +\[\.\] (trace|closest|push)' "$tmp/out"
check 'and lines' grep -qE '^ +[0-9.]+% +[a-z_]+\.[ch]:[0-9]+' "$tmp/out"
check 'a flame graph, or what to install' grep -q 'flame graph' "$tmp/out"
check 'counts of perf beside our times' runs scripts/perf-stat
check 'in JSON' grep -q '^{.*"event" : "task-clock"' "$tmp/out"
check 'and ours' grep -qE '^  image +trace +1' "$tmp/out"
finish
