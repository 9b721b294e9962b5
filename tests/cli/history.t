#!/bin/sh
# raybench history: runs are added once, courses shown, change points marked.
. "$(dirname "$0")/tap.sh"

file=$tmp/history.ndjson
history() { code=$1; shift; exits "$code" history --file "$file" "$@"; }

check 'a run' exits 0 bench balls_low --size 16x16 --variants bvh --processes 2 --budget 0.2s \
    --quiet --out "$tmp/results"
folder=$tmp/results/$(readlink "$tmp/results/latest")
check 'without a history there is nothing to show' history 2
check 'a run is added' history 0 "$folder"
check 'a line for each kernel and the frame' [ "$(wc -l <"$file")" = 5 ]
check 'and shown' grep -q '^balls_low 16x16, depth 5, bvh, frame, on ' "$tmp/out"
cp "$file" "$tmp/once"
check 'once' history 0 "$folder"
check 'which is said' grep -q 'is in the history already' "$tmp/out"
check 'and no more' cmp "$file" "$tmp/once"
check 'kernels of choice' history 0 --kernels 'trace*'
check 'are two' [ "$(grep -c '^balls_low' "$tmp/out")" = 2 ]
check 'nothing of what is asked for' history 2 --scenes nix

# A course made up: a step of 10 % after the tenth run.
awk '{
    for (run = 1; run <= 20; run++) {
        line = $0
        sub(/"session": "[^"]*"/, "\"session\": \"run" run "\"", line)
        sub(/"ms": [^,]*/, "\"ms\": " (run <= 10 ? 1 : 1.1) + run % 3 / 100, line)
        print line
    }
}' "$tmp/once" >"$file"
check 'a course with a step' history 0
check 'has a change point' [ "$(grep -c '<- changed' "$tmp/out")" = 1 ]
check 'there, and as large' grep -q '^  run11 .*<- changed by +9.9 %: 1.01 to 1.11$' "$tmp/out"

# What is no history.
refused=0
for text in nonsense '{}' '{"schema_version": 2}' '[' '{"schema_version": 1, "ms": -1}'; do
    { cat "$tmp/once" && echo "$text"; } >"$file"
    history 2 && grep -q 'history.ndjson:6' "$tmp/err" && refused=$((refused + 1))
done
check 'another file is refused, with its line' [ $refused = 5 ]
head -c 900 "$tmp/once" >"$file"
check 'and one that was cut' history 2
printf 'a\0b' >"$file"
check 'and no text' history 2
cp "$tmp/once" "$file"
check 'a folder that is none' history 1 "$tmp"
check 'a file that cannot be written' exits 1 history --file "$tmp/none/history" "$folder"
finish
