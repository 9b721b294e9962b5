#!/bin/sh
# raybench render, pixel, info and list as a user meets them.
. "$(dirname "$0")/tap.sh"

# Images.
check 'a PPM is written' exits 0 render balls_low --size 40x30 -o "$tmp/a.ppm" --quiet
check 'the PPM has its header' [ "$(head -c 13 "$tmp/a.ppm" | tr '\n' ' ')" = 'P6 40 30 255 ' ]
check 'the PPM has its size' [ "$(wc -c <"$tmp/a.ppm")" = $((13 + 40 * 30 * 3)) ]
check 'a PFM is written' exits 0 render balls_low --size 40x30 -o "$tmp/a.pfm" --quiet
check 'the PFM has its size' [ "$(wc -c <"$tmp/a.pfm")" = $((14 + 40 * 30 * 12)) ]
"$raybench" render balls_low --size 40x30 -o - --quiet >"$tmp/piped.ppm"
check 'standard output gets the same PPM' cmp -s "$tmp/a.ppm" "$tmp/piped.ppm"
check 'no temporary file is left' [ "$(find "$tmp" -name '*.tmp' | wc -l)" = 0 ]
if exits 0 render balls_low --size 40x30 -o "$tmp/a.png" --quiet; then
    check 'a PNG is written' [ "$(head -c 4 "$tmp/a.png" | tail -c 3)" = PNG ]
else
    check 'a build without PNG says what to install' grep -q libpng-dev "$tmp/err"
fi

# Hashes.
hash() { "$raybench" render "$@" --hash --quiet 2>/dev/null; }
expected=$(hash mount_low --size 64x64 --variant naive)
echo "$expected" >"$tmp/line"
check '--hash prints its line' grep -qxE 'image [0-9a-f]{16} hits [0-9a-f]{16}' "$tmp/line"
check 'bvh gives the hashes of naive' [ "$(hash mount_low --size 64x64 --variant bvh)" = \
    "$expected" ]
check 'a tile size changes nothing' [ "$(hash mount_low --size 64x64 --tile 32)" = "$expected" ]
check 'the name and the file are the same scene' [ "$("$raybench" scene mount --size 1 |
    "$raybench" render - --size 64x64 --hash --quiet)" = "$expected" ]
check 'another depth is another image' [ "$(hash mount_low --size 64x64 --depth 2)" != "$expected" ]
check 'another seed changes nothing without randomness' \
    [ "$(hash mount_low --size 64x64 --seed 5)" = "$expected" ]
soft='mount_low --size 32x32 --aa 2 --light-samples 4 --light-size 30'
# shellcheck disable=SC2086 # a list of words
check 'another seed changes soft shadows' [ "$(hash $soft --seed 5)" != "$(hash $soft)" ]
# shellcheck disable=SC2086
check 'the same seed does not' [ "$(hash $soft --seed 5)" = "$(hash $soft --seed 5)" ]
check 'Phong is not Blinn' [ "$(hash balls_low --size 32x32 --specular phong)" != \
    "$(hash balls_low --size 32x32)" ]
check '--light-scale auto is the default' [ "$(hash balls_low --size 32x32 --light-scale auto)" = \
    "$(hash balls_low --size 32x32)" ]
check '--light-scale 1 is brighter' [ "$(hash balls_low --size 32x32 --light-scale 1)" != \
    "$(hash balls_low --size 32x32)" ]
check '--ambient changes the image' [ "$(hash balls_low --size 32x32 --ambient 0.2)" != \
    "$(hash balls_low --size 32x32)" ]

# Bad usage: one line, exit code 2.
check 'no command' complains 2 'see raybench --help'
check 'unknown command' complains 2 "no command 'rendr'; did you mean render\? \(see" rendr
check 'unknown command like no other' complains 2 "no command 'dance' \(see" dance
check 'no scene' complains 2 'missing argument' render
check 'unknown option' complains 2 'unknown option --dept; did you mean --depth\?' \
    render balls_low --dept 3
check 'value missing' complains 2 'needs a value' render balls_low --depth
check 'depth 0' complains 2 'whole number from 1' render balls_low --depth 0
check 'depth word' complains 2 'whole number' render balls_low --depth deep
check 'depth fraction' complains 2 'whole number' render balls_low --depth 1.5
check 'size word' complains 2 'WIDTHxHEIGHT' render balls_low --size big
check 'size zero' complains 2 'WIDTHxHEIGHT' render balls_low --size 0x10
check 'absurd size' complains 2 'too many' render balls_low --size 65536x65536
check 'tile not a multiple' complains 2 'multiple of 16' render balls_low --tile 20
check 'NaN light size' complains 2 'a number from' render balls_low --light-size nan
check 'negative ambient' complains 2 'a number from' render balls_low --ambient -1
check 'unknown variant' complains 2 "no variant 'fast'" render balls_low --variant fast
check 'unknown ending' complains 2 'ppm' render balls_low -o "$tmp/a.jpg"
check 'two scenes' complains 2 'unexpected argument' render balls_low balls_high
check 'both on standard output' complains 2 'both want' render balls_low -o - --hash

# Bad input: exit code 2 with its place.
check 'missing file' complains 2 'nothere.nff: cannot open' render "$tmp/nothere.nff"
check 'a directory' complains 2 'directory' render "$tmp"
printf 'b 0 0 0\nv\nfrom 0 0 x\n' >"$tmp/bad.nff"
check 'a bad number has its place' complains 2 'bad.nff:3:10: ' render "$tmp/bad.nff"
printf 'fancy 1 2 3\n' >"$tmp/odd.nff"
"$raybench" scene balls --size 1 >>"$tmp/odd.nff"
check 'an unknown keyword is a warning' exits 0 info "$tmp/odd.nff"
check 'with its place' grep -q 'odd.nff:1:1: warning' "$tmp/err"
check 'and an error under --strict' complains 2 'odd.nff:1:1: ' info "$tmp/odd.nff" --strict

# The machine lets us down: exit code 1, nothing half-written.
check 'unwritable folder' complains 1 'cannot open for writing' render balls_low --size 16x16 \
    -o "$tmp/no/such/a.ppm" --quiet
if [ -w /dev/full ]; then
    "$raybench" list variants >/dev/full 2>"$tmp/err"
    check 'standard output is full' [ $? = 1 ]
fi

# Signals leave no half-written file.
"$raybench" render balls_high --variant naive -o "$tmp/slow.ppm" --quiet &
pid=$!
sleep 0.3
kill -INT $pid 2>/dev/null
wait $pid
check 'SIGINT ends the program' [ $? -ge 128 ]
check 'and leaves no file' [ "$(find "$tmp" -name 'slow*' | wc -l)" = 0 ]

# pixel, info, list, help.
check 'pixel walks the tree' exits 0 pixel mount_low 250 250 --depth 4
check 'with refraction' grep -q 'refracted ray, bounce 1' "$tmp/out"
check 'pixel outside' complains 2 'no pixel' pixel mount_low 512 0
check 'info counts primitives' exits 0 info mount_low
check 'four spheres, eight triangles' grep -q '12: 4 spheres, 8 triangles' "$tmp/out"
check 'list variants' exits 0 list variants --json
check 'as JSON with the reference first' grep -q '"name": "naive", "available": true' "$tmp/out"
check 'list scenes' exits 0 list scenes
check 'list nonsense' complains 2 'variants or scenes' list nonsense
for command in render pixel info scene list bench; do
    check "$command --help" exits 0 "$command" --help
    check "$command --help shows its usage" grep -q "usage: raybench $command" "$tmp/out"
done
check '--version' exits 0 --version
finish
