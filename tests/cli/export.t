#!/bin/sh
# raybench export: the shapes that other tools read, from a small result made by hand.
# shellcheck disable=SC2016 # programs of awk and of another shell
. "$(dirname "$0")/tap.sh"
data=tests/cli/data/export/20260102T030405Z-abc1234-host

# FORMAT NAME: exports to $tmp/NAME.
makes() { exits 0 export "$data" --format "$1" -o "$tmp/$2"; }
shape() { perl tests/cli/data/check_export.pl "$1" "$2" >"$tmp/err" 2>&1; }
# FILE: a copy of the result to damage, in $tmp/bad.
copy() { rm -rf "$tmp/bad" && cp -r "$data" "$tmp/bad"; }
says() { grep -qE -e "$1" "$tmp/err"; }

# One line that says what is missing, or a picture.
plots() {
    if scripts/plot_scaling.py "$tmp/grown" "$tmp/plot.svg" 2>"$tmp/err"; then
        grep -q '<svg' "$tmp/plot.svg"
    else
        [ "$(wc -l <"$tmp/err")" = 1 ] && says 'needs matplotlib: apt-get install'
    fi
}

check 'markdown' makes markdown tables.md
check 'what has no time is said' says 'left out: frame/.*broken.*: invalid: differs'
check 'and why' says 'left out: frame/.*packet-neon: unavailable: needs neon'
check 'frames have interval and speed-up' grep -q -x -F -e \
    '| packet+omp | 2 | 64 | 21 | 20 to 22 | 0.969 | 6.5 | 1.90 |' "$tmp/tables.md"
check 'time by kernel and bounce' grep -q -x -F -e '| packet+omp | 2 | trace | 52 | 102 |' \
    "$tmp/tables.md"
check 'every row of a table has its columns' awk -F'|' '
    /^\|/ { if (n && NF != n) exit 1; n = NF; next } { n = 0 }' "$tmp/tables.md"
check 'nothing invalid in it' [ "$(grep -c broken "$tmp/tables.md")" = 0 ]

check 'benchfmt' makes benchfmt go.txt
is_benchfmt() {
    awk '
        /^$/ || /^# / || /^[a-z][a-z-]*: [^ ]/ { next }
        /^Unit [^ ]+ better=(lower|higher)$/ { unit[$2] = 1; next }
        $1 ~ /^Benchmark[A-Z][A-Za-z]*(\/[a-z_]+=[A-Za-z0-9+._%-]+)+-[0-9]+$/ {
            if (NF < 4 || NF % 2) exit 1
            if ($2 !~ /^[1-9][0-9]*$/) exit 1
            for (i = 3; i < NF; i += 2)
                if ($i !~ /^[0-9.]+(e[-+][0-9]+)?$/ || !($(i + 1) in unit || $(i + 1) == "ns/op"))
                    exit 1
            results++
            next
        }
        { exit 1 }
        END { if (!results) exit 1 }' "$1"
}
check 'its lines are configuration, units, comments or results' is_benchfmt "$tmp/go.txt"
check 'a line for each process' [ "$(grep -c '^BenchmarkTraceShadow/scene=balls_high/variant=bvh/' \
    "$tmp/go.txt")" = 3 ]
check 'time of threads and time that passed' grep -q "$(printf \
    '^BenchmarkTrace/.*/threads=2/bounce=0-2\t1800\t50 ns/ray\t25 wall-ns/ray\t40 Mrays/s$')" \
    "$tmp/go.txt"
check 'unusual settings are named' grep -q '%2Fa%2C%20b.nff/size=64x48/depth=2/tile=16/' \
    "$tmp/go.txt"

check 'hyperfine' makes hyperfine hyperfine.json
check 'google-benchmark' makes google-benchmark google.json
if perl -MJSON::PP -e 1 2>/dev/null; then
    check 'the shape of hyperfine' shape hyperfine "$tmp/hyperfine.json"
    check 'the shape of google-benchmark' shape google "$tmp/google.json"
else
    check 'shapes # SKIP needs JSON::PP' true
fi

# Scenes of ten to ten thousand primitives, whose rays take 5 ns more each time.
mkdir "$tmp/grown"
sed 1q "$data/frame.csv" >"$tmp/grown/frame.csv"
sed 1q "$data/kernels.csv" >"$tmp/grown/kernels.csv"
for size in 1 2 3 4; do
    awk -F, -v OFS=, -v n=$size 'NR == 2 { $1 = "balls" n; $27 = 10 ^ n; print }' \
        "$data/frame.csv" >>"$tmp/grown/frame.csv"
    awk -F, -v OFS=, -v n=$size 'NR == 2 { $1 = "balls" n; $13 = 10 + 5 * n; print }' \
        "$data/kernels.csv" >>"$tmp/grown/kernels.csv"
done
check 'scaling' exits 0 export "$tmp/grown" --format scaling
check 'finds the slope of what lies on a line' grep -qE \
    '^balls +bvh +1 trace +0 +10 to +10000 +15 to +30 +5 +1\.00 ' "$tmp/out"
check 'needs scenes of one generator' exits 0 export "$data" --format scaling
check 'or there is but the heading' [ "$(wc -l <"$tmp/out")" = 1 ]
if [ -x /usr/bin/python3 ]; then
    check 'the plot is made, or says that it needs matplotlib' plots
else
    check 'the plot # SKIP needs python3' true
fi
# Google Benchmark's own tool, on two exports of which the second is twice as slow.
compare=/usr/share/benchmark/compare.py
compares() {
    /usr/bin/python3 "$compare" --no-color benchmarks "$tmp/google.json" "$tmp/slow.json" \
        >"$tmp/diff" 2>"$tmp/err"
}
if [ -f "$compare" ] && /usr/bin/python3 -c 'import scipy' 2>/dev/null; then
    copy
    awk -F, -v OFS=, '$12 == "trace" && $2 == 512 { $15 *= 2 } 1' "$data/samples.csv" \
        >"$tmp/bad/samples.csv"
    check 'a slower result' exits 0 export "$tmp/bad" --format google-benchmark -o "$tmp/slow.json"
    check 'compare.py reads both' compares
    check 'and finds what is slower' grep -qE \
        '^trace/scene:balls_high/variant:bvh/threads:1/bounce:0 +\+1\.0000' "$tmp/diff"
    check 'and nothing else' grep -qE \
        '^trace_shadow/scene:balls_high/variant:bvh/threads:1/bounce:0 +\+0\.0000' "$tmp/diff"
    check 'and has samples for its U test' grep -q 'U Test, Repetitions: 3 vs 3' "$tmp/diff"
else
    check 'compare.py # SKIP needs libbenchmark-tools and python3-scipy' true
fi
copy
head -c -40 "$data/samples.csv" >"$tmp/bad/samples.csv.part"
rm "$tmp/bad/samples.csv"
check 'an unfinished run is exported' exits 0 export "$tmp/bad" --format benchfmt
check 'and said to be one' says 'not finished'

check 'no folder' complains 2 "none: .*no such folder" export "$tmp/none"
check 'a folder of something else' complains 2 'kernels.csv: missing' export tests/cli
check 'an unknown format' complains 2 "no format 'xml'" export "$data" --format xml
check 'no result named' complains 2 'missing argument' export
copy
sed 's/ns_per_ray,/ns_per_fish,/' "$data/kernels.csv" >"$tmp/bad/kernels.csv"
check 'a missing column' complains 2 "kernels.csv:1:1: there is no column 'ns_per_ray'" \
    export "$tmp/bad" --format benchfmt
copy
echo 'a,b' >>"$tmp/bad/kernels.csv"
check 'a short line' complains 2 'kernels.csv:[0-9]+:1: 2 fields' export "$tmp/bad"
copy
sed '3s/,0,0,/,x,0,/' "$data/samples.csv" >"$tmp/bad/samples.csv"
check 'a process that is no number' complains 2 'samples.csv:3:[0-9]+: expected a whole' \
    export "$tmp/bad" --format hyperfine
copy
echo '{"host": ' >"$tmp/bad/env.json"
check 'a broken env.json' complains 2 'env.json:2:1: this is not JSON' export "$tmp/bad"
copy
rm "$tmp/bad/samples.csv"
check 'no samples' complains 2 'samples.csv: missing' export "$tmp/bad" --format benchfmt
copy
sed 1q "$data/frame.csv" >"$tmp/bad/frame.csv"
check 'nothing with a time' complains 2 'nothing in this result' export "$tmp/bad"
check 'an unwritable file' exits 1 export "$data" -o "$tmp/no/such/file"
check 'and says so' says 'no/such/file: cannot open for writing'
finish
