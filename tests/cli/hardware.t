#!/bin/sh
# Counting events and measuring energy: on this machine, and on made-up ones (RAYBENCH_SYSFS).
# shellcheck disable=SC2016,SC2086 # awk programs; $small is words
. "$(dirname "$0")/tap.sh"

small="--size 32x32 --budget 1 --processes 2 --quiet --out $tmp/results"
rays=$tmp/balls.rays
tree=$tmp/tree
put() { # PATH TEXT: a file of the made-up machine
    mkdir -p "$tree/$(dirname "$1")"
    printf '%s\n' "$2" >"$tree/$1"
}
on_tree() { # COMMAND OPTION...: on the made-up machine
    RAYBENCH_SYSFS=$tree "$raybench" "$@" >"$tmp/out" 2>"$tmp/err"
}
csv() { # FILE COLUMN: of the line of trace at bounce 0, or of the only frame
    awk -v column="$2" 'BEGIN { FS = "," } { sub("\r$", ""); gsub(/"[^"]*"/, "text") }
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        !("kernel" in at) || ($(at["kernel"]) == "trace" && $(at["bounce"]) == 0) {
            print $(at[column]) }' "$tmp/results/latest/$1.csv"
}

check 'rays are recorded' exits 0 record balls_low --size 64x64 -o "$rays" --quiet

# The kernel's own events are there on every machine that lets us count at all.
put proc/cpuinfo 'vendor_id : Nobody'
put sys/bus/event_source/devices/software/type 1
check 'a machine without a PMU counts what the kernel does' \
    on_tree replay "$rays" --variant bvh --kernel trace --bounce 0 --mode hardware --seconds 0.1
check 'it says so' grep -q 'Linux software events (software' "$tmp/out"
check 'time on the processor, or why not' \
    grep -qE '^ +trace +0 +([0-9.]+ |- .*\[1\])' "$tmp/out"
check 'bench has it in its columns' \
    on_tree bench balls_low --variants bvh --measure time,hardware --energy $small
check 'categories are empty' [ -z "$(csv kernels compute_pct)$(csv kernels counter_source)" ]
check 'and there is a time or a reason' \
    [ -n "$(csv kernels task_clock_ns_per_ray)$(csv kernels hardware_note)" ]
check 'without RAPL energy is empty' [ -z "$(csv kernels nj_per_ray)$(csv frame frame_j)" ]
told() {
    [ "$(grep -c 'no energy can be' "$tmp/err")" = 1 ] &&
        csv kernels energy_note | grep -q 'no energy' && csv frame energy_note | grep -q 'no energy'
}
check 'and says why, in one line and in the files' told

# A processor whose PMU is not there: type 4 is that of the host's own, which decides.
put proc/cpuinfo 'vendor_id : AuthenticAMD
cpu family : 25
model : 17'
put sys/bus/event_source/devices/cpu/type 4
put sys/bus/event_source/devices/cpu/format/event config:0-7,32-35
put sys/bus/event_source/devices/cpu/format/umask config:8-15
check 'events are chosen by processor' \
    on_tree replay "$rays" --variant bvh --kernel trace --bounce 0 --mode hardware --seconds 0.1
check 'unverified ones say so' grep -q 'AMD Zen 4 (amd-zen4, unverified)' "$tmp/out"
check 'what a category is' grep -q 'memory_stall: the back end took none' "$tmp/out"
printf 'name A\nnam B\n' >"$tmp/bad.events"
check 'a file that is none' complains 2 'bad.events:2:1: there is no key nam' replay "$rays" \
    --mode hardware --events "$tmp/bad.events"
check 'a name that is none' complains 2 'no file none.events' replay "$rays" --mode hardware \
    --events none
check 'an unknown measure' complains 2 'simulate or hardware' bench balls_low --measure hard $small

# Energy.
check 'no RAPL: one line and exit code 1' env RAYBENCH_SYSFS="$tree" sh -c \
    '"$1" replay "$2" --energy >/dev/null 2>"$3"; [ $? = 1 ] && [ "$(wc -l <"$3")" = 1 ]' \
    sh "$raybench" "$rays" "$tmp/err"
check 'with the reason' grep -q 'no energy can be measured' "$tmp/err"
put sys/class/powercap/intel-rapl:0/name package-0
put sys/class/powercap/intel-rapl:0/max_energy_range_uj 262143999938
put sys/class/powercap/intel-rapl:0/energy_uj 10000000
still() {
    RAYBENCH_SYSFS=$tree "$raybench" replay "$rays" --kernel trace --bounce 0 --energy --idle 0.1 \
        >"$tmp/out" 2>"$tmp/err"
    [ $? = 1 ] && grep -q 'stand still' "$tmp/err" && ! grep -q 'nJ' "$tmp/out"
}
check 'a counter that stands still is none' still
# And one that moves, evenly: net may well be nothing. Overwritten in place, so that no reader finds
# it empty; it stops by itself.
touch "$tmp/moving"
(
    uj=10000000
    while [ -e "$tmp/moving" ] && [ $uj -lt 99999999 ]; do
        uj=$((uj + 50))
        echo $uj 1<>"$tree/sys/class/powercap/intel-rapl:0/energy_uj"
    done
) 2>/dev/null &
check 'one that moves gives gross energy' \
    on_tree replay "$rays" --variant bvh --kernel trace --bounce 0 --energy --idle 0.5
rm "$tmp/moving"
wait
check 'in nJ a ray' grep -qE '^ +image +trace +0 +4096 +[-0-9.e+]+ +[0-9.e+]+ +[0-9.e+]+' "$tmp/out"
check 'with its source' grep -q 'rapl:powercap package. net:' "$tmp/out"
check 'a model that is none' complains 2 'no such file in bench/energy' bench balls_low \
    --energy-model none $small
finish
