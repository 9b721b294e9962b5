#!/bin/sh
# The fuzzer's seed corpus, replayed: reading any of it must end in a scene or in an error.
. "$(dirname "$0")/tap.sh"
replay() { timeout 20 "${BUILD:-build/release}/tests/fuzz/replay_nff" "$1" >/dev/null; }

for file in tests/fuzz/corpus/*; do
    check "$(basename "$file")" replay "$file"
done
finish
