#!/bin/sh
# raybench versus: our rows against Embree's modes, or why not. Never which of them wins.
. "$(dirname "$0")/tap.sh"

# COLUMN: of versus.csv, all lines.
column() {
    awk -F , -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        NR > 1 { print $at[name] }' "$tmp/results/latest/versus.csv"
}
all_match() { column "$1" | awk -v p="$2" '$0 !~ p { bad = 1 } END { exit bad || !NR }'; }

if ! "$raybench" list variants | grep -q '^embree .*libembree [0-9]'; then
    check 'the row says what it needs' \
        grep -q 'unavailable.*libembree' <<END
$("$raybench" list variants | grep '^embree ')
END
    check 'without Embree it says so' complains 2 'libembree' versus balls3
    finish
    exit 0
fi

export OMP_NUM_THREADS=2
check 'a scene is compared' exits 0 versus balls3 --size 96x96 --processes 2 --budget 2s \
    --out "$tmp/results"
lines=$(column rays | wc -l) # five without OpenMP
check 'all classes of rays' [ "$(column rays | sort -u | tr '\n' ' ')" = \
    'diffuse primary reflection refraction shadow ' ]
check 'of one scene' all_match scene '^balls3$'
check 'by one thread and two' [ "$(column threads | sort | uniq -c | tr -s ' \n' ' ')" = \
    "$([ "$lines" = 10 ] && echo ' 5 1 5 2 ' || echo ' 5 1 ')" ]
check 'by rows of ours' all_match row '^(bvh|stream|packet|frustum)'
check 'and modes' all_match embree_mode '^(single|packet|stream)'
for name in mrays_ours mrays_embree ratio build_ns_embree bytes_per_primitive_ours \
    bytes_per_primitive_embree rays_compared huge_pct_ours huge_pct_embree; do
    check "$name is a number" all_match $name '^[0-9][0-9.e+]*$'
done
check 'two processes make no interval' all_match ratio_lo '^$'
check 'the rays are gone' [ ! -e "$tmp/results/latest/versus.rays" ]
check 'the table has all parts' [ "$(grep -c '^  balls3 ' "$tmp/out")" = \
    $((lines * 6 / 5 + 5)) ]
check 'the least time is told' \
    [ "$(column least_ns_per_ray | grep -c '^[0-9][0-9.]*$')" = "$lines" ]
check 'two threads have a speed-up' \
    [ "$(column speed_up_ours | grep -c '^[0-9]')" = $((lines - 5)) ]
check 'a class alone, by one thread' exits 0 versus mount3 --class primary --threads 1 \
    --size 32x32 --processes 1 \
    --budget 1s --out "$tmp/results"
check 'is one line' [ "$(column rays)" = primary ]
check 'a class that is none' complains 2 'no rays .sideways' versus balls3 --class sideways
check 'a scene that is none' exits 2 versus nothing.nff --out "$tmp/results"
check 'a mode is a row' exits 0 render balls3 --variant embree-packet8c-high --size 32x32 \
    -o "$tmp/image.ppm"
check 'frames of the yardstick' exits 0 bench balls3 --variants embree --size 32x32 --budget 2s \
    --out "$tmp/results"
check 'are flagged inexact' grep -q inexact "$tmp/results/latest/kernels.csv"
finish
