#!/bin/sh
# raybench count: exact counts per ray, and heat maps of them.
# shellcheck disable=SC2016,SC2086 # awk programs; $small is words
. "$(dirname "$0")/tap.sh"

small="--size 32x32 --quiet --out $tmp/results"
csv=$tmp/results/latest/kernels.csv
column() { head -1 "$csv" | tr -d '\r' | tr , '\n' | grep -nx "$1" | cut -d: -f1; }
# FILE: the first of the three numbers of each pixel of a 32 x 32 PFM, rows from the bottom.
pixels() { tail -c 12288 "$1" | od -An -v -w12 -tf4; }

check 'naive and bvh' exits 0 count balls_low $small --variants naive,bvh
cp "$tmp/out" "$tmp/first"
check 'naive tests all ten boxes with every ray' \
    grep -qE '^  trace +0 +1024 +10\.0 ' "$tmp/first"
check 'a scalar row uses all its lanes' grep -qE '^  trace +0 +1024 .* 100\.0 ' "$tmp/first"
check 'bvh visits nodes' grep -qE '^  trace +0 +1024 +[0-9.]+ ' "$tmp/first"
check 'there are no cones to show' [ "$(grep -c '^  kernel .*cones' "$tmp/first")" = 0 ]
check 'once more' exits 0 count balls_low $small --variants naive,bvh
sed -i '/^Results are in/d' "$tmp/first" "$tmp/out"
check 'counts repeat exactly' cmp "$tmp/first" "$tmp/out"
check 'kernels.csv has them, and no times' [ "$(awk -F, \
    -v boxes="$(column boxes_per_ray)" -v ns="$(column ns_per_ray)" \
    -v note="$(column note)" -v lanes="$(column lane_use_pct)" '
    $8 == "naive" && $10 == "trace" && $11 == 0 { print $boxes, $ns "", $note, $lanes }' \
    "$csv")" = '10  not measured 100' ]
check 'packets' exits 0 count balls_low $small --variant packet
check 'have idle lanes' [ "$(awk -F, -v lanes="$(column lane_use_pct)" '
    $10 == "trace" && $11 == 4 { print ($lanes > 0 && $lanes < 100) }' "$csv")" = 1 ]

# A pixel has a hit exactly where the image is not the background.
check 'an image of hits' exits 0 count mount_low $small --depth 1 --variant bvh \
    --heatmap hits -o "$tmp/hits.pfm"
check 'the legend tells the scale' grep -q 'hits per pixel of mount_low, bvh' "$tmp/out"
check 'the image itself' exits 0 render mount_low --size 32x32 --depth 1 --quiet \
    -o "$tmp/image.pfm"
pixels "$tmp/hits.pfm" >"$tmp/hits"
pixels "$tmp/image.pfm" >"$tmp/image"
check 'hits are where the image shows something' [ "$(paste "$tmp/hits" "$tmp/image" | awk '
    { hit = $1 == 1; sky = $4 > 0.077 && $4 < 0.079 && $6 > 0.75; seen += hit; bad += hit == sky }
    END { print NR, (seen > 100 && seen < NR), bad + 0 }')" = '1024 1 0' ]
check 'packets have the same image of hits' exits 0 count mount_low $small --depth 1 \
    --variant packet --heatmap hits -o "$tmp/packet.pfm"
check 'bit for bit' cmp "$tmp/hits.pfm" "$tmp/packet.pfm"
check 'an image of time' exits 0 count balls_low $small --heatmap ns -o "$tmp/ns.ppm"
check 'of the size of the frame' [ "$(head -c 9 "$tmp/ns.ppm" | tr '\n' ' ')" = 'P6 32 32 ' ]

check 'an unknown counter' complains 2 'expected one of tests, ns, nodes' count balls_low $small \
    --heatmap heat -o "$tmp/x.ppm"
check 'a heat map without a file' complains 2 'belong together' count balls_low --heatmap nodes
check 'a file without a heat map' complains 2 'belong together' count balls_low -o "$tmp/x.ppm"
check 'an unknown format' complains 2 'x.gif' count balls_low --heatmap nodes -o "$tmp/x.gif"
check 'a folder that is not there' exits 1 count balls_low $small --heatmap nodes \
    -o "$tmp/nowhere/x.ppm"
check 'an unknown scene' exits 2 count nowhere $small
finish
