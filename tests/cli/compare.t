#!/bin/sh
# raybench compare: what it finds in runs made up here, and what it refuses.
. "$(dirname "$0")/tap.sh"

# FOLDER SESSION SEED [NAME=VALUE...]: a made-up run. Noise is seeded and only ever adds time; on
# top of it a drift of up to 30 % that the processes of one number share within a session. Names:
# kernel, slow (that kernel takes `slow` times as long), processes, repetitions, scenes, variant,
# hash, host, cpu, second (adds this variant, half as fast in trace).
make_run() {
    folder=$1 session=$2 seed=$3
    shift 3
    host=mill cpu=Zen
    for word; do case $word in host=*) host=${word#*=} ;; cpu=*) cpu=${word#*=} ;; esac done
    mkdir -p "$folder"
    printf '{"schema_version": 1, "session": "%s", "host": {"name": "%s", "cpu_model": "%s"},
  "git": {"commit": "0123456789abcdef", "dirty": false}}\n' "$session" "$host" "$cpu" \
        >"$folder/env.json"
    awk -v seed="$seed" -v session="$session" "$samples_program" kernel= slow=1 processes=24 \
        repetitions=4 scenes=balls,mount variant=bvh hash=00ff second= "$@" /dev/null \
        >"$folder/samples.csv"
}

# An own generator: awks differ in theirs. The seed goes through squares, since generators of this
# kind that start at even distances stay at even distances.
samples_program='
function uniform() { state = state * 16807 % 2147483647; return state / 2147483647 }
function noise(size) { return 1 - size * log(uniform()) }
function start(with,    step) {
    state = with
    for (step = 0; step < 9; step++)
        state = ((state % 46337) * (state % 46337) + with + 7919 * step) % 2147483646 + 1
}
function line(kernel, bounce, rays, ns, frame) {
    printf "%s,64,64,3,1,1,64,%s,1,%d,%d,%s,%s,%d,%.0f,%s\r\n", scene, name, process, repetition,
        kernel, bounce, rays, ns, frame
}
function repeat(drift, twice,    k, bounce, ns, sum) {
    sum = 0
    for (k = 1; k <= 4; k++)
        for (bounce = 0; bounce < 3; bounce++) {
            ns = base[k] / (bounce + 1) * drift * process_noise[k] * noise(0.004)
            ns *= (name_of[k] == kernel ? slow : 1) * (k == 2 && twice ? 2 : 1)
            sum += ns
            line(name_of[k], bounce, 4096, ns, ns ",,,,,,,,,,")
        }
    line("frame", "", 9000, sum, sum * noise(0.001) ",,,,,,,,," hash ",")
}
END {
    split("generate trace shade trace_shadow", name_of, " ")
    split("1e5 4e6 1e6 3e6", base, " ")
    variants = split(second == "" ? variant : variant " " second, variant_of, " ")
    count = split(scenes, scene_of, ",")
    printf "scene,width,height,depth,aa,light_samples,tile,variant,threads,process,repetition," \
        "kernel,bounce,rays,ns,wall_ns,busy_max_ns,build_ns,peak_memory_bytes,tree_bytes,cpu," \
        "context_switches,migrations,steal_ms,image_hash,hits_hash\r\n"
    for (process = 0; process < processes; process++)
        for (s = count; s > 0; s--) {
            scene = scene_of[s]
            start(session * 1000 + process * 10 + s)
            drift = 1 + 0.3 * uniform()
            for (v = 1; v <= variants; v++) {
                name = variant_of[v]
                start(seed * 100000 + process * 100 + s * 10 + v)
                for (k = 1; k <= 4; k++) process_noise[k] = noise(0.003)
                for (repetition = 0; repetition < repetitions; repetition++) repeat(drift, v == 2)
            }
        }
}'

# COUNT PATTERN: so many lines of the output match.
lines() { [ "$(grep -cE -e "$2" "$tmp/out")" = "$1" ]; }
no() { ! "$@"; }

make_run "$tmp/a" 1 11
make_run "$tmp/same" 1 12
make_run "$tmp/slow5" 1 13 kernel=trace_shadow slow=1.05
make_run "$tmp/slow20" 1 14 kernel=trace slow=1.2
make_run "$tmp/later" 2 15 kernel=trace slow=1.05

check 'a run against its like' exits 0 compare "$tmp/a" "$tmp/same"
check 'nothing is resolved' lines 10 '  not resolved$'
check 'it is paired' grep -q 'paired: process p of A' "$tmp/out"
check 'the level is that of ten rows' grep -q '10 rows: .* with 99 %, each with 99.9 %' "$tmp/out"
check 'a gate lets it pass' exits 0 compare "$tmp/a" "$tmp/same" --gate

check 'a kernel slower by 5 %' exits 0 compare "$tmp/a" "$tmp/slow5"
check 'is found in both scenes' lines 2 '^  trace_shadow .* 1\.0[45].*slower: 1\.0[45]'
check 'and in the frames' lines 2 '^  frame .*slower: 1\.0'
check 'and nowhere else' lines 4 'slower|faster:'
check 'scenes have a mean behind their rows' \
    grep -q '^frame, geometric mean of the ratios of 2 scenes: 1\.0.* (64x64, depth 3, bvh)$' \
    "$tmp/out"
check 'a kernel slower by 20 %' exits 0 compare "$tmp/a" "$tmp/slow20"
check 'is found in both scenes' lines 2 '^  trace .*slower: 1\.(19|2)'
check 'and in the frames' lines 2 '^  frame .*slower: 1\.(09|1)'
check 'and nowhere else' lines 4 'slower|faster:'
check 'the other way round' exits 0 compare "$tmp/slow20" "$tmp/a"
check 'it is as much faster' lines 2 '^  trace  *[0-9.]+ +[0-9.]+ +0\.83.*faster: 1\.(19|2).* x as'
check 'nothing is slower' no grep -q 'slower:' "$tmp/out"

check 'bounces are a family of their own' exits 0 compare "$tmp/a" "$tmp/slow20" --bounces
check 'with as many rows' grep -q '24 rows of single bounces' "$tmp/out"
check 'a slow kernel is slow at all bounces' lines 10 'slower: 1\.'
check 'a level of choice' exits 0 compare "$tmp/a" "$tmp/same" --level 0.5 --kernels frame
check 'over the rows of choice' grep -q ' 2 rows: .* with 50 %, each with 70.711 %' "$tmp/out"
check 'a scene of choice' exits 0 compare "$tmp/a" "$tmp/same" --scenes 'b*'
check 'and no other' no grep -q '^mount' "$tmp/out"

check 'another session is not paired' exits 0 compare "$tmp/a" "$tmp/later"
check 'which it says' grep -q 'two runs: if the machine changed' "$tmp/out"
check 'nor can drift be told from 5 %' lines 10 'not resolved$'

check 'the gate closes' exits 3 compare "$tmp/a" "$tmp/slow20" --gate
check 'it says why' grep -q '^gate: 4 rows slower by more than 0 %, 0 undecided' "$tmp/out"
check 'the whole interval is above 19 %' exits 3 compare "$tmp/a" "$tmp/slow20" --gate \
    --threshold 19
check 'but not above 20 %' exits 0 compare "$tmp/a" "$tmp/slow20" --gate --threshold 20
check 'what is faster passes' exits 0 compare "$tmp/slow20" "$tmp/a" --gate

make_run "$tmp/few" 1 16 processes=9
check 'too few processes' exits 0 compare "$tmp/a" "$tmp/few"
check 'are said' lines 10 ' - +9 +too few processes \(9, needs 11\)$'
check 'and shut the gate' complains 2 'gate cannot decide: 10 rows' compare "$tmp/a" "$tmp/few" \
    --gate
check 'one row needs fewer' exits 0 compare "$tmp/a" "$tmp/few" --kernels frame --scenes balls
check 'than ten' lines 1 'not resolved$'

make_run "$tmp/two" 1 17 second=packet
check 'two variants of one run' exits 0 compare "$tmp/two" --variants bvh,packet
check 'are held against each other' lines 2 '^  trace .*slower: (1\.99|2|2\.0.*) x the time$'
check 'no kernel is blamed that is alike' lines 4 'slower|faster:'
check 'a variant that is not there' complains 2 "variant 'packer'; did you mean packet" \
    compare "$tmp/two" --variants bvh,packer
check 'what only one has is said' exits 0 compare "$tmp/a" "$tmp/two"
check 'with all its key' lines 1 '^only in B: balls 64x64, depth 3, packet$'
check 'without a counterpart the gate is shut' complains 2 'cannot decide: 2 rows' \
    compare "$tmp/two" "$tmp/a" --gate

make_run "$tmp/host" 1 18 host=barn
make_run "$tmp/cpu" 1 18 cpu=Lake
check 'another host is refused' complains 2 'different hosts, mill and barn' compare "$tmp/a" \
    "$tmp/host"
check 'another processor is refused' complains 2 'different processors, Zen and Lake' \
    compare "$tmp/a" "$tmp/cpu"
make_run "$tmp/foreign" 1 18 scenes=teapot processes=1
check 'nothing in common is refused' complains 2 \
    'no cell in common; only in A, 2: balls 64x64.*; only in B, 1: teapot' \
    compare "$tmp/a" "$tmp/foreign"
make_run "$tmp/image" 1 18 hash=abcd
check 'another image is refused' complains 2 'the images differ' compare "$tmp/a" "$tmp/image"
check 'a scene that is not there' complains 2 "no samples of the scene 'ball'; did you mean balls" \
    compare "$tmp/a" "$tmp/same" --scenes mount,ball
check 'a kernel that is not there' complains 2 "no kernel 'shadow'" compare "$tmp/a" "$tmp/same" \
    --kernels trace,shadow
check 'one run alone' complains 2 'give two runs' compare "$tmp/a"
check 'two runs and variants' complains 2 'within one run' compare "$tmp/a" "$tmp/a" --variants a,b
check 'a threshold without a gate' complains 2 'add --gate' compare "$tmp/a" "$tmp/a" --threshold 5
check 'no run' complains 2 'none: has neither samples.csv nor' compare "$tmp/a" "$tmp/none"
make_run "$tmp/blind" 1 18
rm "$tmp/blind/env.json"
check 'no environment' complains 1 'env.json: cannot' compare "$tmp/a" "$tmp/blind"
echo '{"session": "1"}' >"$tmp/blind/env.json"
check 'no host' complains 2 'env.json: no host.name' compare "$tmp/a" "$tmp/blind"

# EXPRESSION PATTERN: with samples edited by sed, the complaint.
mistake() {
    make_run "$tmp/bad" 1 18 processes=2
    sed -i "$1" "$tmp/bad/samples.csv"
    complains 2 "bad/samples.csv:$2" compare "$tmp/bad" "$tmp/a"
}
check 'a missing field' mistake '3s/,64,/,/' '3:1: 25 fields, but the header names 26 columns'
check 'a missing column' mistake '1s/wall_ns/wall/' "1:1: no column 'wall_ns'"
check 'an unknown kernel' mistake '5s/trace/trade/' "5:32: 'trade': expected the name of a kernel"
check 'a process that is no number' mistake '4s/bvh,1,0/bvh,1,x/' "4:28: 'x': .* process"
check 'a bounce that is no number' mistake '4s/generate,2/generate,two/' "4:41: 'two': .* bounce"
check 'a negative time' mistake '7s/4096,/4096,-/' "7:45: '-.*': expected a time"
check 'the same line twice' mistake '9p' '10:1: the same process, .* as line 9'

# A run that was stopped in the middle of a line, of a repetition and of a process.
make_run "$tmp/part" 1 12
head -c 120000 "$tmp/part/samples.csv" >"$tmp/part/samples.csv.part"
rm "$tmp/part/samples.csv"
check 'a run that has not ended' exits 0 compare "$tmp/a" "$tmp/part"
check 'which it says' grep -q '^B .*part, commit 0123456789ab, a run that has not ended' "$tmp/out"
check 'half a repetition is no time' lines 10 'not resolved$'
check 'the processes that ended count' lines 10 ' 1[0-9]  not resolved$'
head -c 300 "$tmp/a/samples.csv" >"$tmp/part/samples.csv.part"
check 'a run that has only begun' complains 2 'no whole repetition yet' compare "$tmp/part" "$tmp/a"

check 'JSON' exits 0 compare "$tmp/a" "$tmp/slow20" --json --gate --threshold 30
if command -v python3 >/dev/null; then
    check 'holds the same' python3 -c '
import json, sys
c = json.load(open(sys.argv[1]))
rows = {(cell["scene"], row["kernel"]): row for cell in c["cells"] for row in cell["rows"]}
assert len(rows) == 10 and c["paired"] and c["family"]["rows"] == 10
assert c["cells"][0]["width"] == 64 and c["cells"][0]["variant"] == "bvh"
row = rows["balls", "trace"]
assert row["verdict"] == "slower" and row["bounce"] is None and row["a_processes"] == 24
assert 1.15 < row["ratio_lo"] <= row["ratio"] <= row["ratio_hi"] < 1.25
assert row["ci_level"] >= c["family"]["level"] > 0.99 == c["family_level"]
assert abs(row["b_ns"] / row["a_ns"] - 1.2) < 0.05
assert c["frame_means"][0]["scenes"] == 2 and c["gate"]["slower"] == 0
assert c["a"]["host"] == "mill" and c["only_in_a"] == []
' "$tmp/out"
else
    echo '# skipped: python3 is not installed, the JSON was not parsed'
fi
finish
