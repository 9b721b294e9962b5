#!/bin/sh
# raybench bench: verifies, measures, keeps what it measured, and goes on when it was stopped.
# shellcheck disable=SC2016,SC2086,SC2002 # awk programs; $quick is words; a file may be missing
. "$(dirname "$0")/tap.sh"

out=$tmp/results
latest=$out/latest
quick='--size 48x48 --variants naive,bvh,packet+omp --budget 1 --quiet'

check 'a small benchmark runs' exits 0 bench balls_low mount_low $quick --out "$out"
check 'it prints time per ray' grep -qE '^ +trace_shadow +[0-9]' "$tmp/out"
check 'and where most of it goes' grep -qE '^  bvh +[a-z_]+ at bounce [0-9]: [0-9]+ % of the time' \
    "$tmp/out"
check 'it prints what a probe costs' grep -q 'A probe costs' "$tmp/out"
csv=$latest/kernels.csv
check 'latest points at the results' [ -s "$csv" ]
key=scene,width,height,depth,aa,light_samples,tile,variant,threads,kernel,bounce
check 'the CSV begins with its key columns' [ "$(head -1 "$csv" | cut -d, -f1-11)" = "$key" ]
for file in kernels frame samples; do
    check "every line of $file.csv has all columns" \
        [ "$(tr -d '\r' <"$latest/$file.csv" | awk -F, '{print NF}' | sort -u | wc -l)" = 1 ]
done
check 'all kernels, the build and the frame' [ "$(sed 1d "$csv" | cut -d, -f10 | sort -u |
    tr '\n' ' ')" = 'build frame generate other resolve shade trace trace_shadow ' ]
check 'camera rays are pixels' grep -q '^balls_low,48,48,5,1,1,64,bvh,1,generate,0,2304,' "$csv"
check 'no zero stands for a time' [ "$(awk -F, '$13 == "0"' "$csv" | wc -l)" = 0 ]
check 'nothing is left of the part file' [ ! -e "$latest/samples.csv.part" ]

for file in kernels frame samples; do
    for name in $(head -1 "$latest/$file.csv" | tr -d '\r' | tr , ' '); do
        grep -qE "^\| (.*, )?${name}[, ]" results/README.md || echo "$name"
    done
done >"$tmp/undocumented"
check 'results/README.md explains every column' [ ! -s "$tmp/undocumented" ]
if python3 -c 'import jsonschema' 2>/dev/null; then
    check 'result.json is as its schema says' python3 -c 'import json, jsonschema, sys
jsonschema.validate(*[json.load(open(name)) for name in sys.argv[1:]])' \
        "$latest/result.json" results/result.schema.json
else
    check 'result.json is as its schema says # SKIP no python3 with jsonschema (make setup)' true
fi

# FILE COLUMN: its number.
column() { head -1 "$1" | tr -d '\r' | tr , '\n' | grep -nx "$2" | cut -d: -f1; }

check 'larger frames, for what follows' exits 0 bench balls_low mount_low --size 256x256 \
    --variants bvh,packet,packet+omp --budget 2 --quiet --out "$out"

# Kernels at all bounces, resolve and other add up to the frame: wall time of serial rows, within
# 1 %; `other` is under 3 %. Sums are per repetition, so that no median hides anything.
samples=$latest/samples.csv
check 'stages add up to the frame' awk -F, -v ns="$(column "$samples" ns)" \
    -v wall="$(column "$samples" wall_ns)" '
    $8 !~ /omp/ && NR > 1 && $12 != "frame" { sum += $ns }
    $8 !~ /omp/ && $12 == "frame" {
        frames++
        worst = sum / $wall > 1.002 ? 1 : worst # clocks are calibrated to parts in a million
        all += sum; walls += $wall; sum = 0
    }
    END { exit !(frames > 10 && !worst && all / walls > 0.99) }' "$samples"
# Of each row's quietest repetition: a preemption may fall anywhere. Sanitizers, whose checks set
# TEST_SLOW=0, slow moving rays down more than tracing them.
limit=0.03
[ "${TEST_SLOW:-1}" = 1 ] || limit=0.1
check "other is under $limit of the frame" awk -F, -v limit=$limit -v ns="$(column "$samples" ns)" '
    $12 == "other" { other = $ns }
    $12 == "frame" && NR > 1 {
        key = $1 $8; share = other / $ns
        if (!(key in least) || share < least[key]) least[key] = share
    }
    END { for (k in least) { n++; bad += least[k] > limit } exit !(n == 6 && !bad) }' "$samples"
share=$(column "$csv" share_pct)
check 'shares add up to 100 %' awk -F, -v share="$share" '
    NR > 1 { sum[$1 $8] += $share }
    END {
        for (k in sum) { n++; bad += sum[k] < 99.99 || sum[k] > 100.01 }
        exit !(n == 6 && !bad)
    }' "$csv"
check 'times per pixel add up to the frame, one thread' awk -F, \
    -v ns="$(column "$csv" ns_per_pixel)" '
    $8 ~ /omp/ || NR == 1 || $10 == "build" { next }
    $10 == "frame" { frame[$1 $8] = $ns; next }
    { sum[$1 $8] += $ns }
    END {
        for (k in frame) { n++; bad += sum[k] < 0.99 * frame[k] || sum[k] > 1.01 * frame[k] }
        exit !(n == 4 && !bad)
    }' "$csv"

# Plans.
check 'a plan says what would be measured' exits 0 bench smoke --dry-run --out "$out"
check 'cell by cell' grep -qE '^balls_low +bvh +64 x 64, depth 5, ' "$tmp/out"
for plan in bench/plans/*.plan; do
    check "$plan can be run" exits 0 bench "$plan" --dry-run --out "$out"
done
printf '# a comment\nscenes = balls_low\n\nsize = 16x16 # small\ndepth = 1, 2\nvariants = bvh\n' \
    >"$tmp/own.plan"
check 'a plan of my own' exits 0 bench "$tmp/own.plan" --dry-run --depth 3,4 --out "$out"
check 'the command line wins' grep -qE 'bvh +16 x 16, depth 4,' "$tmp/out"
check 'and replaces the list' [ "$(grep -c 'depth [12],' "$tmp/out")" = 0 ]
printf 'scenes = balls_low\n  dept = 1\n' >"$tmp/bad.plan"
check 'a mistake in a plan has its place' complains 2 'bad.plan:2:3: unknown key .dept' \
    bench "$tmp/bad.plan" --out "$out"
printf 'budget = soon\n' >"$tmp/bad.plan"
check 'so has a bad value' complains 2 'bad.plan:1:1: budget soon: expected a time' \
    bench "$tmp/bad.plan" --out "$out"

# Stopping and going on.
"$raybench" bench balls_low --size 64x64 --variants bvh,packet --budget 60 --processes 40 --quiet \
    --out "$out" >"$tmp/out" 2>"$tmp/err" &
pid=$!
i=0
until [ "$(cat "$latest/samples.csv.part" 2>/dev/null | grep -c frame)" -gt 3 ] || [ $i = 100 ]; do
    sleep 0.1
    i=$((i + 1))
done
kill -INT $pid
wait $pid
check 'SIGINT stops it' [ $? = 130 ]
check 'what there is is kept' grep -q '64,bvh,1,trace,0,4096,[0-9].*partial' "$csv"
check 'and not called whole' [ ! -e "$latest/samples.csv" ]
before=$(grep -c frame "$latest/samples.csv.part")
sed -i 's/^budget = .*/budget = 1/; s/^processes = .*/processes = 6/' "$latest/run.plan"
printf 'balls_low,64,64,5,1' >>"$latest/samples.csv.part" # as a crash leaves it
check 'it goes on' exits 0 bench --resume --quiet --out "$out"
check 'with what it had' [ "$(grep -c frame "$latest/samples.csv")" -ge "$before" ]
check 'and comes to its end' [ "$(grep -c partial "$csv")" = 0 ]
check 'there is nothing more to do' complains 2 'come to its end' bench --resume --out "$out"

# A slow-down of known size is found where it is.
check 'another build can be measured in turn' exits 0 bench balls_low $quick --out "$out" \
    --against "$raybench"
check 'into a folder of its own' [ -s "$(readlink -f "$latest").against/samples.csv" ]
check 'which must be a program' complains 2 'cannot run' bench balls_low --against "$tmp/none" \
    --out "$out"
check 'and of this version' exits 1 bench balls_low $quick --against /bin/true --out "$out"

# Mistakes and hard times.
check 'a bad scene is reported' complains 2 'cannot open' bench "$tmp/none.nff" --out "$out"
check 'an unknown variant' complains 2 'no variant matches' bench --variants nix --out "$out"
check 'an unwritable folder is reported' complains 1 'cannot make' bench balls_low \
    --out "$tmp/no/such/folder"
limited() { (ulimit -f 16 && exits "$@"); }
check 'a full disk is reported' limited 1 bench balls_low $quick --out "$tmp/disk"
check 'in one line' grep -qE '^raybench: [^ ]*: cannot write: File too large$' "$tmp/err"
check 'and nothing cut short has a final name' [ ! -e "$tmp/disk/latest/samples.csv" ]
check 'it runs with standard output closed' sh -c '"$@" >&-' - "$raybench" bench balls_low $quick \
    --out "$out"
check 'without a home, in another language, with one thread' env -i LC_ALL=de_DE.UTF-8 \
    OMP_NUM_THREADS=1 HOME=/nonexistent "$raybench" bench balls_low $quick --out "$out"
check 'numbers keep their point' grep -qE ',trace,0,2304,[0-9]+\.[0-9]+,' "$csv"
finish
