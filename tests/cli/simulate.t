#!/bin/sh
# raybench simulate: events per ray from valgrind's callgrind. Counts repeat, so they are compared.
# shellcheck disable=SC2016,SC2086 # awk programs; $small is words
. "$(dirname "$0")/tap.sh"

small="--size 32x32 --quiet --out $tmp/results"
PATH=/nonexistent "$raybench" simulate balls_low >"$tmp/out" 2>"$tmp/err"
check 'without valgrind there is nothing' [ $? = 1 ]
check 'it says what to install' grep -q 'make setup' "$tmp/err"
check 'a scene is needed' complains 2 'missing argument' simulate

# Neither a machine without valgrind nor a build it cannot run has more to show.
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

check 'bvh and packets' exits 0 simulate balls_low $small --variants bvh,packet
cp "$tmp/out" "$tmp/first"
check 'a line for each kernel at a bounce' grep -qE '^  trace +0 +1024 +[0-9]+\.[0-9]' "$tmp/out"
check 'all of the frame, if it is small' grep -q '1 of 1 tiles of 64 x 64' "$tmp/out"
check 'it names the caches' grep -qE '^simulated caches: L1 instructions [0-9]+ KiB' "$tmp/out"
check 'and what it cannot see' grep -q 'this simulator cannot see them' "$tmp/out"
check 'compute stalls are empty and not 0' [ "$(awk '
    $1 ~ /^(generate|trace|shade|trace_shadow)$/ { seen++; bad += $11 != "-" }
    END { print (seen > 9 && !bad) }' "$tmp/out")" = 1 ]
check 'categories add up to 100 %' [ "$(awk '
    $1 ~ /^(generate|trace|shade|trace_shadow)$/ {
        seen++; sum = $10 + $12 + $13; bad += sum < 99.8 || sum > 100.2
    }
    END { print (seen > 9 && !bad) }' "$tmp/out")" = 1 ]
check 'the rows did the same work' [ "$(awk '
    $1 == "trace" && $2 == 0 { rays[$3]++ } END { for (r in rays) print rays[r] }' \
    "$tmp/out")" = 2 ]
check 'packets take fewer instructions' [ "$(awk '
    $1 == "trace" && $2 == 0 { if (++n == 1) bvh = $4; else print ($4 * 2 < bvh) }' \
    "$tmp/out")" = 1 ]

# Another folder, another environment: the same counts.
program=$(readlink -f "$raybench")
(cd / && LANG=de_DE.UTF-8 VALGRIND_OPTS=--nonsense HOME=$tmp ANOTHER=variable "$program" \
    simulate balls_low $small --variants bvh,packet >"$tmp/second" 2>"$tmp/err")
sed -i '/^Results are in/d' "$tmp/first" "$tmp/second"
check 'two runs give identical counts' cmp "$tmp/first" "$tmp/second"
csv=$tmp/results/latest/kernels.csv
column() { head -1 "$csv" | tr -d '\r' | tr , '\n' | grep -nx "$1" | cut -d: -f1; }
check 'they are in kernels.csv, with their source' [ "$(awk -F, \
    -v ir="$(column instructions_per_ray)" -v stall="$(column compute_stall_pct)" \
    -v rays="$(column simulated_rays)" -v source="$(column counter_source)" \
    -v model="$(column category_source)" '
    $8 == "bvh" && $10 == "trace" && $11 == 0 {
        print ($ir > 0), $stall, $source, $model, $rays
    }' "$csv")" = '1  sim model:callgrind 1024' ]

# The tiles that are simulated have their share of the reflected rays, within a third.
check 'a sample of a frame' exits 0 simulate balls4 --size 256x256 --tile 16 --tiles 8 --quiet \
    --variant bvh --out "$tmp/results"
check 'is like the frame' [ "$(awk -F, -v rays="$(column simulated_rays)" '
    $8 == "bvh" && $10 == "trace" && $11 == 1 {
        share = 256 / 8 * $rays / $12; print (share > 0.75 && share < 1.33)
    }' "$csv")" = 1 ]

# Caches.
misses() { awk '$1 == "trace" && $2 == 0 { print int(1000 * $'"$1"') }' "$tmp/out"; }
check 'a tiny L1' exits 0 simulate balls4 $small --variant bvh --l1 1K,1 --ll 64K,16
tiny=$(misses 5)
small_tree=$(misses 6)
check 'a large L1' exits 0 simulate balls4 $small --variant bvh --l1 1M,16 --ll 64M,16
check 'has fewer misses' [ "$(misses 5)" -lt "$tiny" ]
check 'and so has a large last level' [ "$(misses 6)" -lt "$small_tree" ]
check 'sets are rounded to a power of two' exits 0 simulate balls_low $small --variant bvh \
    --ll 3M,16
check 'which it says' grep -q 'LL 3 MiB 24-way (made a power of two of sets)' "$tmp/out"
check 'misses grow with the tree' exits 0 simulate balls2 balls4 $small --variant bvh --l1 4K,4 \
    --ll 64K,16
check 'as the last table shows' [ "$(awk '
    /^  balls[24] +bvh/ { if (++n == 1) { l1 = $5; ll = $6 } else print ($5 > l1 && $6 > ll) }' \
    "$tmp/out")" = 1 ]
check 'what is no cache' complains 2 '--ll 32K: expected SIZE,WAYS' \
    simulate balls_low $small --ll 32K
check 'nor this' complains 2 '--l1 32K,8,48: expected SIZE,WAYS' \
    simulate balls_low $small --l1 32K,8,48

# Rows that cannot be simulated.
check 'AVX-512' complains 2 'packet-avx512 is not simulated: .*take its avx2 row' \
    simulate balls_low $small --variant packet-avx512
check 'threads' complains 2 'bvh.omp is not simulated.*without .omp' \
    simulate balls_low $small --variant bvh+omp
check 'are left out among others' exits 0 simulate balls_low $small --variants bvh,bvh+omp
check 'an unknown row' complains 2 'no variant matches' simulate balls_low $small --variant nix

# A simulator that does not do what it should: LINE is the script in its place.
mkdir "$tmp/folder" "$tmp/bin"
pretend() {
    printf '#!/bin/sh\nfor word; do case $word in *out-file=*) out=${word#*=} ;; esac; done\n%s\n' \
        "$1" >"$tmp/bin/valgrind.bin"
    chmod +x "$tmp/bin/valgrind.bin"
    PATH=$tmp/bin:$PATH TMPDIR=$tmp/folder "$raybench" simulate balls_low $small --variant bvh \
        >"$tmp/out" 2>"$tmp/err"
}
pretend 'echo "it broke" >&2; exit 3'
check 'a simulator that fails' [ $? = 1 ]
check 'says why' grep -q 'failed with code 3: it broke' "$tmp/err"
pretend 'exit 0'
check 'a simulator that writes nothing' [ $? = 1 ]
pretend 'echo "part: 1" >"$out"'
check 'or not all' [ $? = 1 ]
check 'has no numbers' grep -q 'record is cut short' "$tmp/err"
pretend 'printf "desc: Trigger: Client Request: end hits=1 row=bvh\n" >"$out"
printf "events: Ir Dr Dw I1mr D1mr D1mw ILmr DLmr DLmw Bc Bcm Bi Bim\ntotals: 0\n" >>"$out"'
check 'nor has one that does other work' [ $? = 2 ]
check 'which is told' grep -q 'not those of a native run' "$tmp/err"
check 'no temporary file' [ -z "$(ls -A "$tmp/folder")" ]

# Nothing is left behind, whatever happens.
export TMPDIR="$tmp/folder"
check 'naive, too' exits 0 simulate balls_low $small --variant naive
check 'on tiles of its own size' grep -q 'tiles of 16 x 16' "$tmp/out"
check 'no temporary file' [ -z "$(ls -A "$tmp/folder")" ]
"$raybench" simulate balls4 --variant bvh --quiet --out "$tmp/results" \
    >"$tmp/out" 2>"$tmp/err" &
pid=$!
i=0
until [ -n "$(ls -A "$tmp/folder")" ] || [ $i = 100 ]; do
    sleep 0.1
    i=$((i + 1))
done
kill -INT $pid
wait $pid
check 'SIGINT ends it' [ $? = 130 ]
check 'and leaves nothing' [ -z "$(ls -A "$tmp/folder")" ]
TMPDIR=$tmp/none "$raybench" simulate balls_low $small >"$tmp/out" 2>"$tmp/err"
check 'without room for temporary files there are no numbers' [ $? = 1 ]
check 'and it says why' grep -q 'cannot make a temporary folder' "$tmp/err"
finish
