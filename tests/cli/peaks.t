#!/bin/sh
# raybench peaks: what this machine gets through at most. How much that is depends on the machine.
# shellcheck disable=SC2016 # awk programs
. "$(dirname "$0")/tap.sh"

csv=$tmp/peaks.csv
check 'peaks are measured' exits 0 peaks "$tmp"
check 'and printed' grep -qE '^instructions +[0-9.]+ a ns, [0-9.]+ a cycle$' "$tmp/out"
check 'memory is read, too' grep -qE '^bytes of memory +[0-9.]+ a ns' "$tmp/out"
check 'the file has the same' [ "$(wc -l <"$csv")" = $(($(wc -l <"$tmp/out") + 1)) ]
check 'none of it is nothing' awk -F, '
    NR > 1 { bad += !($NF > 0) } END { exit bad || NR < 4 }' "$csv"
check 'nor more than can be' awk -F, '$(NF - 2) == "cycles" { cycles = $NF }
    $(NF - 2) == "instructions" { all = $NF }
    END { exit !(all > cycles / 2 && all < 16 * cycles) }' "$csv"
check 'a folder that is not there' exits 1 peaks "$tmp/none"
check 'is said' grep -q 'peaks.csv: cannot open for writing' "$tmp/err"
finish
