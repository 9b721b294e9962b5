#!/bin/sh
# Instruction sets, compilers and optimisation levels agree to the last bit: image bytes and hits of
# every row on all six scenes, the reduced form of `make exact`. Builds the program five times.
# (Tile sizes and threads: tests/unit/render.c.) TEST_SLOW=0 skips it.
cd "$(dirname "$0")/../.." || exit 1
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
export tmp RAYBENCH="${RAYBENCH:-build/raybench}" size=48x48 tiles=32 threads=2
. tests/cli/exact.sh
count=0

if [ "${TEST_SLOW:-1}" = 0 ]; then
    echo '1..0 # SKIP TEST_SLOW=0'
    exit 0
fi

# NAME: passes if none of $tmp/cells differs.
agree() {
    count=$((count + 1))
    same=$(grep -c '|same|' "$tmp/cells")
    if [ "$same" -ge 3 ] && ! grep -q '|DIFFERS|' "$tmp/cells"; then
        echo "ok $count - $1: $same rows give the images and hits of the reference"
    else
        echo "not ok $count - $1"
        cat "$tmp/cells" "$tmp"/differs.* 2>/dev/null | sed 's/^/# /'
        rm -f "$tmp"/differs.*
    fi
}

expect $size || sed 's/^/# /' "$tmp/expected"
for levels in $(list_levels "$RAYBENCH"); do
    cells "$RAYBENCH" >"$tmp/cells"
    agree "this build without features: $levels"
done
levels=none
while read -r compiler options; do
    config=$(echo "exact-$compiler$options" | tr -d ' =')
    if ! command -v "$compiler" >/dev/null; then
        count=$((count + 1))
        echo "ok $count - $compiler $options # SKIP no $compiler here"
        continue
    fi
    build "$compiler" "$options" "$config" || sed 's/^/# /' "build/$config.log"
    cells "build/$config/raybench" >"$tmp/cells" </dev/null
    agree "$compiler $options"
done <<END
gcc -O0
gcc -O3
gcc -O1 $sixteen_lanes
clang -O0
clang -O3
END
echo "1..$count"
