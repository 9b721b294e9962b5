#!/bin/sh
# raybench explain: time, counts and simulated events side by side, and what they mean. Times are
# not tested, only that they are there.
# shellcheck disable=SC2016,SC2086 # awk programs; $small is words
. "$(dirname "$0")/tap.sh"

small="--size 32x32 --budget 1 --processes 2 --quiet --out $tmp/results"
PATH=/nonexistent "$raybench" explain balls_low $small >"$tmp/out" 2>"$tmp/err"
check 'without valgrind there is nothing' [ $? = 1 ]
check 'it says what to install' grep -q 'make setup' "$tmp/err"

why=
command -v valgrind >/dev/null || why='valgrind is not installed'
grep -qE '__(asan|tsan)_init' "$raybench" && why='valgrind cannot run a sanitizer'
"$raybench" simulate balls_low --size 16x16 --variant bvh --quiet --out "$tmp/results" 2>&1 |
    grep -q 'without valgrind.s headers' && why='built without valgrind (VALGRIND=0)'
if [ -n "$why" ]; then
    echo "# skipped: $why"
    finish
    exit 0
fi

check 'three rows' exits 0 explain balls_low $small
rows='(naive|bvh|(frustum|stream)-[a-z0-9]*)'
check 'a table for each' [ "$(grep -cE "^balls_low, $rows\$" "$tmp/out")" = 3 ]
check 'lines of twenty words, but for compute stalls' [ "$(awk '
    $1 == "trace" { seen++; bad += NF != 20 || $16 != "-" }
    $1 == "trace" { for (i = 2; i <= 20; i++) bad += i != 16 && $i !~ /^[0-9.]+$/ }
    END { print (seen == 15 && !bad) }' "$tmp/out")" = 1 ]
check 'rates are judged' grep -qE 'instructions a ns.* processor' "$tmp/out"
check 'a definition of each category' [ "$(grep -cE \
    '^  (compute|c\.stall|m\.stall|other) ' "$tmp/out")" = 4 ]
check 'energy is a model, and says so' grep -q 'By model:horowitz14-45nm a ray' "$tmp/out"
check 'a paragraph for each row' [ "$(grep -cE \
    "^$rows spends most in [a-z_]+ at bounce [0-9]" "$tmp/out")" = 3 ]
check 'bvh is compared with naive' sh -c 'tr "\n" " " <"$1" |
    grep -q "times as fast as naive, which has "' sh "$tmp/out"
csv=$tmp/results/latest/kernels.csv
column() { head -1 "$csv" | tr -d '\r' | tr , '\n' | grep -nx "$1" | cut -d: -f1; }
check 'all of it is in kernels.csv' [ "$(awk -F, -v ns="$(column ns_per_ray)" \
    -v nodes="$(column nodes_per_ray)" -v ir="$(column instructions_per_ray)" '
    $8 == "bvh" && $10 == "trace" { seen++; good += $ns > 0 && $nodes > 0 && $ir > 0 }
    END { print (seen == 5 && good == seen) }' "$csv")" = 1 ]
finish
