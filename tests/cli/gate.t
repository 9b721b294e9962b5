#!/bin/sh
# raybench gate and regress: what they find, what they refuse. Nothing here depends on a clock: the
# gate goes by counts, and regress has too few processes for an interval.
# shellcheck disable=SC2086 # $quiet is words
. "$(dirname "$0")/tap.sh"

quiet="--quiet --out $tmp/results"
cat >"$tmp/tiny.plan" <<END
measure  = count
scenes   = balls_low, $tmp/scene.nff
variants = naive, bvh
size     = 24x24
budget   = 1h
END
"$raybench" scene balls --size 1 -o "$tmp/scene.nff"
gate() {
    code=$1
    shift
    exits "$code" gate "$tmp/tiny.plan" --baseline "$tmp/base" $quiet "$@"
}
# CODE PATTERN ARGUMENTS...: the verdict line matches.
verdict() {
    code=$1 pattern=$2
    shift 2
    gate "$code" "$@" && head -1 "$tmp/out" | grep -qE -e "$pattern"
}
slow() { RAYBENCH_TEST_SLOW=$slowed "$@"; }

check 'without a baseline there is no verdict' gate 2
check 'which it says' grep -q 'tiny.csv: cannot' "$tmp/err"
mkdir "$tmp/base"
check 'a baseline is written' gate 0 --update
cp "$tmp/base/tiny.csv" "$tmp/whole"
check 'the same again' gate 0 --update
check 'is the same, byte by byte' cmp "$tmp/whole" "$tmp/base/tiny.csv"
check 'nothing has moved' verdict 0 '^gate: fine: [0-9]+ figures compared, 0 waived$'

for percent in 2 20; do
    slowed=trace_shadow:$percent
    check "$percent % more work in a kernel is found" slow verdict 1 \
        'regressed: .* trace_shadow at bounce [0-4]: [a-z_]+ \+[0-9.]+ %'
    check 'there and nowhere else' [ "$(grep -cE '(generate|trace|shade) at' "$tmp/out")" = 0 ]
done
slowed=trace:20
check 'a report for a pull request and one for programs' slow gate 1 --markdown "$tmp/report.md" \
    --json "$tmp/report.json"
check 'the one is Markdown' grep -q '^| boxes | [0-9]* | [0-9]* | 1.[0-9]* | exact |  | worse |$' \
    "$tmp/report.md"
if command -v python3 >/dev/null; then
    check 'the other JSON' python3 -c '
import json, sys
r = json.load(open(sys.argv[1]))
assert r["gate"] == "gate" and r["code"] == 1 and r["verdict"].startswith("regressed")
assert r["compared"]["worse"] == len(r["rows"]) > 10 and r["compared"]["same"] > 100
for row in r["rows"]:
    assert row["kernel"] == "trace" and 1 < row["ratio"] < 1.21 and row["ratio_lo"] is None
' "$tmp/report.json"
else
    echo '# skipped: python3 is not installed, the JSON was not parsed'
fi
# The last command of the table, run as it stands, counts what the gate says the head counted less
# the slowness that was put in.
grep '^  raybench record balls_low' "$tmp/out" | tail -n 1 >"$tmp/command"
mkdir "$tmp/bin"
ln -s "$(readlink -f "$raybench")" "$tmp/bin/raybench"
check 'each place has a command that shows it' [ -s "$tmp/command" ]
(cd "$tmp" && PATH=$tmp/bin:$PATH sh ./command >out 2>err)
check 'which runs' [ $? = 0 ]
check 'and shows that place' grep -qE '^  trace +[0-4] ' "$tmp/out"

# Waivers.
header=scene,variant,kernel,bounce,figure,ceiling_pct,expires,reason
waive() { printf '%s\n' "$header" "$@" >"$tmp/base/waivers.csv"; }
waive '*,*,trace,*,*,20.01,2999-12-31,a known price'
check 'a waiver lets pass' slow verdict 0 'fine: .* [1-9][0-9]* waived$'
check 'and says why' grep -q 'waived: a known price$' "$tmp/out"
waive '*,*,trace,*,*,19,2999-12-31,a known price'
check 'up to its ceiling' slow gate 1
waive '*,*,trace,*,*,30,2001-01-31,a known price'
check 'until its day' slow gate 1
check 'then it says so' grep -q 'waivers.csv:2: this waiver has expired on 2001-01-31: a known' \
    "$tmp/out"
waive '*,bvh,trace,*,*,30,2999-01-31,a known price'
check 'for what it is for' slow verdict 1 'naive, trace'
waive '*,*,trace,*,*,30,2999-13-31,a known price'
check 'a waiver without a date is none' gate 2
check 'and has a place' grep -q "waivers.csv:2:18: '2999-13-31': expected the last day" "$tmp/err"
waive '*,*,trace,*,*,30,2999-12-31,'
check 'nor one without a reason' gate 2
waive '*,*,trace,*,*,-3,2999-12-31,no'
check 'nor one with a negative ceiling' gate 2
echo nonsense >"$tmp/base/waivers.csv"
check 'nor nonsense' gate 2
rm "$tmp/base/waivers.csv"

# A program that does less than the baseline: the baseline is stale.
check 'a baseline of a slower program' slow gate 0 --update
check 'is to be renewed' verdict 2 'stale: .*run make baseline'
cp "$tmp/whole" "$tmp/base/tiny.csv"

# Baselines that are none: cut, edited, foreign.
size=$(wc -c <"$tmp/whole")
refused=0 tried=0
for cut in 0 1 100 $((size / 2)) $((size - 20)) $((size - 1)); do
    head -c $cut "$tmp/whole" >"$tmp/base/tiny.csv"
    tried=$((tried + 1))
    gate 2 && refused=$((refused + 1))
done
for at in 0 200 $((size / 3)) $((size / 2)) $((size - 60)) $((size - 2)); do
    { head -c $at "$tmp/whole" && printf 7 && tail -c +$((at + 2)) "$tmp/whole"; } \
        >"$tmp/base/tiny.csv"
    tried=$((tried + 1))
    gate 2 && refused=$((refused + 1))
done
check 'a baseline that was cut or edited is none' [ $refused = $tried ]
sed 8d "$tmp/whole" >"$tmp/base/tiny.csv"
check 'nor is one without a line' gate 2
check 'which it says' grep -q 'tiny.csv: cut short or edited' "$tmp/err"
head -c 4096 /dev/urandom >"$tmp/base/tiny.csv"
check 'nor noise' gate 2
echo 'a,b' >"$tmp/base/tiny.csv"
check 'nor another table' gate 2
cp "$tmp/whole" "$tmp/base/tiny.csv"
sed 's/24x24/32x24/' "$tmp/tiny.plan" >"$tmp/other.plan"
cp "$tmp/whole" "$tmp/base/other.csv"
check 'nor one of other cells' exits 2 gate "$tmp/other.plan" --baseline "$tmp/base" $quiet
check 'which it says' grep -q 'balls_low 32x24, depth 5, naive, frame: is not in the baseline' \
    "$tmp/err"
sed 's/, bvh//' "$tmp/tiny.plan" >"$tmp/other.plan"
check 'nor is a run that lacks a cell' exits 2 gate "$tmp/other.plan" --baseline "$tmp/base" $quiet
check 'which it says' grep -q 'bvh, frame: is not in this run' "$tmp/err"
"$raybench" scene balls --size 2 -o "$tmp/scene.nff"
check 'nor one of another scene' gate 2
check 'which it says' grep -q 'not the same work' "$tmp/err"
"$raybench" scene balls --size 1 -o "$tmp/scene.nff"
check 'the same scene is the same again' gate 0
check 'a plan that is not there' complains 2 "no plan 'nix'" gate nix $quiet

# What cannot run here.
if "$raybench" list variants | grep -qE '^packet-sse2 .*(yes|available)|^packet-sse2 '; then
    sed 's/naive, bvh/bvh, packet-sse2/; s/, [^ ]*nff//' "$tmp/tiny.plan" >"$tmp/simd.plan"
    simd() {
        code=$1
        shift
        exits "$code" gate "$tmp/simd.plan" --baseline "$tmp/base" $quiet "$@"
    }
    without() { RAYBENCH_CPU_DISABLE=sse2 "$@"; }
    if simd 0 --update; then
        check 'a row that cannot run here is left out' without simd 0
        check 'which is said' grep -q 'not compared: .* packet-sse2 cannot run here' "$tmp/out"
        check 'and too little for a strict gate' without simd 4 --strict
        check 'and for a new baseline' without simd 2 --update
    else
        echo '# skipped: no SSE2 here'
    fi
fi
sed 's/count/simulate/; s/naive, //; s/24x24/16x16/; s/, [^ ]*nff//' "$tmp/tiny.plan" \
    >"$tmp/sim.plan"
simulated() {
    code=$1
    shift
    exits "$code" gate "$tmp/sim.plan" --baseline "$tmp/base" $quiet "$@"
}
nowhere() { PATH=/nonexistent "$@"; }
cp "$tmp/whole" "$tmp/base/sim.csv"
check 'nothing to compare is no success' nowhere simulated 4
if command -v valgrind >/dev/null && ! grep -qE '__(asan|tsan)_init' "$raybench" &&
    simulated 0 --update; then
    check 'what is simulated repeats' simulated 0
    check 'and another program can be the base' simulated 0 --against "$raybench"
else
    echo '# skipped: no simulator here'
fi
check 'a base that is not there' complains 2 'cannot run the program' gate --against "$tmp/none"

# By the clock: never fine without an interval, and no verdict on other work.
regress() {
    code=$1
    shift
    exits "$code" regress balls_low --variants bvh --size 24x24 --processes 2 --budget 0.2s \
        --learn 1 $quiet "$@"
}
check 'too few processes are inconclusive' regress 3 --against "$raybench" --json "$tmp/r.json"
check 'the noise of the host is kept' \
    grep -qE ',bvh,1,trace,,[1-9][0-9.]*$' "$tmp/results/floor.csv"
check 'each row has its command' \
    grep -q '^  raybench record balls_low --size 24x24 .* --kernel trace --mode time$' "$tmp/out"
check 'a base is needed' complains 2 'make regress BASE=REV' regress balls_low
check 'one that is there' regress 2 --against "$tmp/none"
check 'and a raybench' regress 2 --against /bin/true
printf '#!/bin/sh\nshift\nexec "%s" worker --spd "$@"\n' "$(readlink -f "$raybench")" \
    >"$tmp/other"
chmod +x "$tmp/other"
check 'that renders the same image' regress 2 --against "$tmp/other"
sed -i 's/,[1-9][0-9.]*$/,0.5/' "$tmp/results/floor.csv"
check 'a noise that cannot be is refused' regress 2 --against "$raybench"
check 'with its place' grep -q 'floor.csv:2:[0-9]*: .0.5.: expected a ratio' "$tmp/err"

# The base of `make regress BASE=REV`, apart from how the program under test was built.
base() { env -u CONFIG -u MAKEFLAGS -u MAKEOVERRIDES -u MAKELEVEL scripts/base "$@"; }
if command -v git >/dev/null; then
    mkdir -p "$tmp/repository/scripts" "$tmp/repository/build/release"
    cp scripts/base "$tmp/repository/scripts"
    cd "$tmp/repository" || exit 1
    echo 'cc -O2' >build/release/flags
    printf 'all:\n\tfalse\n' >Makefile
    {
        git init -q . && git add Makefile
        git -c user.name=a -c user.email=a@b commit -qm broken
        printf 'all:\n\tmkdir -p build/release\n\tcp /bin/true build/release/raybench\n' >Makefile
        git -c user.name=a -c user.email=a@b commit -qam sound
    } >"$tmp/err" 2>&1
    base HEAD~1 >"$tmp/out" 2>"$tmp/err"
    check 'a base that does not build is none' [ $? = 2 ]
    check 'which is said' grep -q 'HEAD~1 does not build' "$tmp/err"
    base nonsense >"$tmp/out" 2>"$tmp/err"
    check 'nor is a commit that is none' [ $? = 2 ]
    base HEAD >"$tmp/out" 2>"$tmp/err"
    check 'a base that builds' [ $? = 0 ]
    check 'is a program' [ -x "$(cat "$tmp/out")" ]
    base HEAD 2>"$tmp/err" >"$tmp/again"
    check 'that is built once' [ "$(cat "$tmp/out" "$tmp/err")" = "$(cat "$tmp/again")" ]
fi
finish
