#!/bin/sh
# raybench record and raybench replay: rays go to a file and through every row's kernels again.
# What happens to damaged files, byte by byte, is in tests/unit/record.c.
. "$(dirname "$0")/tap.sh"

rays=$tmp/rays
short='--seconds 0.02 --processes 1 --quiet'

# CLASS KIND BOUNCE: how many rays the record of the last check has, by its list.
recorded() { awk -v c="$1" -v k="$2" -v b="$3" '$1 == c && $2 == k && $(NF - 2) == b {
    print $(NF - 1) }' "$tmp/list"; }
same() { [ -n "$1" ] && [ "$1" -gt 0 ] && [ "$1" = "$2" ]; }
at_most() { [ "$1" -gt 0 ] && [ "$1" -le "$2" ]; }

# LINES: the last replay has so many, all of them with a time.
timed() {
    awk -v lines="$1" '$1 ~ /^(image|diffuse|reflection|refraction|shadow)$/ {
        n++; bad += $5 !~ /^[0-9.]+$/ } END { exit !(n == lines && !bad) }' "$tmp/out"
}

rows=$("$raybench" list variants | awk '$1 ~ /^(naive|bvh|packet-)/ && $1 !~ /omp/ && !/needs/ {
    print $1 }')
check 'there are rows' [ "$(echo "$rows" | wc -l)" -ge 2 ]

for scene in balls_low mount_low; do
    check "$scene is recorded" exits 0 record $scene --size 64x64 --classes all -o "$rays"
    cp "$tmp/out" "$tmp/list"
    check 'replay lists the same' exits 0 replay "$rays" --list
    check 'line by line' cmp -s "$tmp/out" "$tmp/list"
    check 'a camera ray per pixel' same "$(recorded image rays 0)" 4096
    hits=$(recorded diffuse rays 1)
    check 'a diffuse ray for a hit' at_most "$hits" 4096
    check 'a reflected one' same "$(recorded reflection rays 1)" "$hits"
    check 'a refracted one, but for total reflection' \
        at_most "$(recorded refraction rays 1)" "$hits"
    check 'a shadow ray to light 0' same "$(recorded shadow shadow 0)" "$hits"
    lights=$("$raybench" info $scene | awk '$1 == "lights" { print $2 }')
    check 'shadow rays of the image: at most one per hit and light' \
        at_most "$(recorded image shadow 0)" $((hits * lights))
    bounces=$(grep -cE '^  image +rays ' "$tmp/list")
    shadows=$(grep -cE '^  image +shadow ' "$tmp/list")
    for row in $rows; do
        # shellcheck disable=SC2086 # words
        check "$scene: $row replays everything" exits 0 replay "$rays" --variant "$row" \
            --class all $short
        check 'and has a time for all of it' timed $((1 + 2 * bounces + shadows + 4))
    done
done

# shellcheck disable=SC2086 # words
{
    for kernel in generate trace shade trace_shadow; do
        check "$kernel alone" exits 0 replay "$rays" --variant bvh --kernel $kernel --bounce 0 \
            $short
        check 'has one line' timed 1
    done
    check 'one bounce' exits 0 replay "$rays" --variant bvh --bounce 1 $short
    check 'has all kernels but generate' timed 3
    check 'a class alone' exits 0 replay "$rays" --variant bvh --class diffuse $short
    check 'is traced' timed 1
    check 'rays that were not recorded' complains 2 'no such rays were recorded; --list says' \
        replay "$rays" --bounce 9 $short
    check 'a row with threads' complains 2 'one thread; bvh.omp has the kernels of .* row bvh' \
        replay "$rays" --variant bvh+omp $short
    check 'an unknown kernel' complains 2 'kernel trac: there are generate' \
        replay "$rays" --kernel trac
    check 'an unknown class' complains 2 'class light: there are image' replay "$rays" --class light
    check 'an unknown row' complains 2 "no variant 'fast'" replay "$rays" --variant fast
    check 'nothing to replay' complains 2 'none: cannot open' replay "$tmp/none"

    check 'what kernels do is counted' exits 0 replay "$rays" --variant bvh --mode count
    cp "$tmp/out" "$tmp/counts"
    lines=$(grep -cE '^  (generate|trace|shade|trace_shadow) ' "$tmp/counts")
    check 'for all of them' [ "$lines" = $((1 + 2 * bounces + shadows)) ]
    check 'and again' exits 0 replay "$rays" --variant bvh --mode count
    check 'with the same counts' cmp -s "$tmp/out" "$tmp/counts"
    check 'an unknown mode' complains 2 'there are time, count, simulate' replay "$rays" --mode perf
    simulate='--variant bvh --bounce 1 --mode simulate --l1 32K,8 --ll 1M,16'
    if "$raybench" simulate balls2 --size 16x16 --variant bvh >/dev/null 2>&1; then
        check 'kernels are simulated' exits 0 replay "$rays" $simulate
        cp "$tmp/out" "$tmp/simulated"
        check 'with instructions for each' [ 3 = \
            "$(grep -cE '^  (trace|shade|trace_shadow) +1 +[0-9]+ +[0-9.]+ ' "$tmp/simulated")" ]
        check 'twice' exits 0 replay "$rays" $simulate
        check 'the same' cmp -s "$tmp/out" "$tmp/simulated"
    else
        check 'kernels are simulated # SKIP valgrind cannot run here (make setup)' true
    fi

    # Soft shadows and anti-aliasing make many batches, a small tile makes them small.
    check 'a rich image' exits 0 record mount_low --size 24x16 --aa 2 --light-samples 4 \
        --light-size 9 --seed 3 --tile 16 --depth 3 -o "$rays" --quiet
    check 'without a word' [ ! -s "$tmp/out" ]
    check 'is replayed' exits 0 replay "$rays" --variant bvh $short
    check 'in whole' timed 10
    cp "$rays" "$tmp/damaged"
    printf 'x' | dd of="$tmp/damaged" bs=1 seek=20000 conv=notrunc 2>/dev/null
    check 'a damaged file' complains 2 'damaged: the record is damaged; record it again' \
        replay "$tmp/damaged" $short
    head -c 20000 "$rays" >"$tmp/damaged"
    check 'a file cut short' complains 2 'damaged: the record is cut short' replay "$tmp/damaged"

    # The scene is loaded again.
    "$raybench" scene mount --size 2 -o "$tmp/scene.nff"
    check 'a scene from a file' exits 0 record "$tmp/scene.nff" --size 16x16 -o "$rays" --quiet
    check 'is found again' exits 0 replay "$rays" --variant bvh --kernel trace $short
    "$raybench" scene mount --size 3 -o "$tmp/scene.nff"
    check 'unless it has changed' complains 2 'scene.nff is not the one recorded' \
        replay "$rays" $short
    rm "$tmp/scene.nff"
    check 'or is gone' complains 2 'scene.nff: cannot open' replay "$rays" $short
}

check 'no file to record to' complains 2 'record: -o FILE' record balls_low
check 'standard output is none' complains 2 'takes a file' record balls_low -o -
check 'standard input is no scene' complains 2 'loads the scene again' record - -o "$rays"
check 'an unknown class to record' complains 2 "no class 'light'" record balls_low -o "$rays" \
    --classes image,light
check 'a row with threads records nothing' complains 2 'take a serial row' record balls_low \
    -o "$rays" --variant bvh+omp
check 'an unwritable folder' complains 1 'cannot open for writing' record balls_low \
    -o "$tmp/no/such/file" --size 16x16
limited() { (ulimit -f 16 && exits "$@"); }
check 'a full disk' limited 1 record balls_low -o "$tmp/full" --size 64x64 --quiet
check 'leaves nothing' [ ! -e "$tmp/full" ]
finish
