#!/bin/sh
# The fuzzer's seed corpus, replayed: reading any of it must end in a scene or in an error.
. "$(dirname "$0")/tap.sh"
replay=${BUILD:-build/release}/tests/fuzz/replay_nff

for file in tests/fuzz/corpus/*; do
    check "$(basename "$file")" timeout 20 "$replay" "$file"
done
finish
