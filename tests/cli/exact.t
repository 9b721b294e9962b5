#!/bin/sh
# Compilers and optimisation levels agree to the last bit: image bytes and hits of every row on all
# six scenes, at a reduced size. Builds the program four times. (Tile sizes and threads:
# tests/unit/render.c.) TEST_SLOW=0 skips it.
cd "$(dirname "$0")/../.." || exit 1
export RAYBENCH="${RAYBENCH:-build/raybench}"
scenes='balls_low balls_medium balls_high mount_low mount_high mount_very_high'

if [ "${TEST_SLOW:-1}" = 0 ]; then
    echo '1..0 # SKIP TEST_SLOW=0'
    exit 0
fi

rows() { "$1" list variants --json | sed -n 's/.*"name": "\([^"]*\)", "available": true.*/\1/p'; }

# PROGRAM: one line per scene and row. The reference is too slow for the two largest scenes.
hashes() {
    for scene in $scenes; do
        for variant in $(rows "$1"); do
            case $scene/$variant in mount_very_high/naive* | balls_high/naive*) continue ;; esac
            printf '%s %s ' "$scene" "$variant"
            "$1" render "$scene" --size 48x48 --variant "$variant" --tile 32 --hash --quiet
            "$1" render "$scene" --size 48x48 --variant "$variant" -o "$tmp/image.pfm" --quiet &&
                sha256sum <"$tmp/image.pfm"
        done
    done
}

tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
hashes "$RAYBENCH" >"$tmp/expected"
count=1
if [ "$(grep -c 'image .* hits ' "$tmp/expected")" -ge 20 ]; then
    echo "ok 1 - $(grep -c hits "$tmp/expected") renders by $RAYBENCH"
else
    echo 'not ok 1 - renders failed'
fi
# All rows of a scene agree with each other.
count=$((count + 1))
if [ "$(awk '/hits/ {print $1, $4, $6}' "$tmp/expected" | sort -u | wc -l)" = 6 ]; then
    echo "ok $count - all rows agree on each of six scenes"
else
    echo "not ok $count - rows disagree"
    sed 's/^/# /' "$tmp/expected"
fi
for build in 'gcc -O0' 'gcc -O3' 'clang -O0' 'clang -O3'; do
    compiler=${build% *}
    optimisation=${build#* }
    count=$((count + 1))
    if ! command -v "$compiler" >/dev/null; then
        echo "ok $count - $build # SKIP no $compiler here"
        continue
    fi
    config="exact-$compiler$optimisation"
    # MAKEFLAGS and variables of the calling make must not leak in.
    env -u MAKEFLAGS -u MAKEOVERRIDES -u CC -u OPT -u CONFIG -u SANITIZE \
        make -s -j 2 CC="$compiler" OPT="$optimisation" CONFIG="$config" all >"$tmp/log" 2>&1 ||
        sed 's/^/# /' "$tmp/log"
    hashes "build/$config/raybench" >"$tmp/actual"
    if [ -s "$tmp/expected" ] && cmp -s "$tmp/expected" "$tmp/actual"; then
        echo "ok $count - $build gives the same images and hits"
    else
        echo "not ok $count - $build differs"
        diff "$tmp/expected" "$tmp/actual" | sed 's/^/# /'
    fi
done
echo "1..$count"
