#!/bin/sh
# The generated scenes against the course's files, which are not part of this repository: by their
# sha256 sums, of the form with LF line ends.
# shellcheck disable=SC2317 # functions reach `check` by name

. "$(dirname "$0")/tap.sh"

# scene GENERATOR SIZE [OPTION...]: on standard output.
scene() {
    generator=$1
    size=$2
    shift 2
    "$raybench" scene "$generator" --size "$size" "$@"
}

# has_sum SUM: of standard input.
has_sum() {
    actual=$(sha256sum | cut -d ' ' -f 1)
    [ "$actual" = "$1" ] || {
        echo "# sha256 is $actual"
        false
    }
}

same() {
    scene "$1" "$2" --dialect p3d | has_sum "$3"
}

# The originals come from another libm: in three spheres a z that should be 0 is another 1e-16. With
# these three numbers replaced, on their lines, the rest has to be theirs to the byte.
# same_but_three SIZE LINE LINE LINE SUM
same_but_three() {
    scene balls "$1" --dialect p3d |
        sed -e "$2s/^s 0\.0955788 0\.852418 1\.03629e-16 /s 0.0955788 0.852418 9.1293e-17 /" \
            -e "$3s/^s -0\.786005 -0\.343435 7\.89572e-17 /s -0.786005 -0.343435 8.51251e-17 /" \
            -e "$4s/^s -0\.343435 -0\.786005 7\.27893e-17 /s -0.343435 -0.786005 8.51251e-17 /" |
        has_sum "$5"
}

# has LINE: in the last spd scene.
has() {
    grep -qxF -e "$1" "$tmp/spd"
}

check 'balls 1 is balls_low' same balls 1 \
    c15b1dbd61d92f08d8072474cb852e7a11b9278ae03e24cedc8d67c11807824b
check 'balls 2 is balls_medium but for three numbers' same_but_three 2 40 73 90 \
    021fdb2cb788c7b59955275295e52d116c00975940157479606d710efada1870
check 'balls 4 is balls_high but for three numbers' same_but_three 4 1930 4663 6030 \
    96066d53d6e7f6fec92b8c8df5121e36a7149c90c39a4346a153e52233719b30
check 'mount 1 is mount_low' same mount 1 \
    2bef5213700f299611e5d4c3b8004347cfa570ddf2621f90056e2dcdb56eeb8d
check 'mount 5 is mount_high' same mount 5 \
    12cf6f3fa87c4967e464967b980b4418a5de482373f736a28b9b93fc044eaa75
check 'mount 7 is mount_very_high' same mount 7 \
    972d36e2f8aeb89dfc81102356033c781878eba002b71f186fbdd3ef37cb8850

# Defaults, and a file instead of standard output.
scene balls 2 --dialect p3d >"$tmp/balls"
scene balls 2 >"$tmp/default"
check 'p3d is the default dialect' cmp "$tmp/balls" "$tmp/default"
scene balls 2 -o "$tmp/file"
check '-o writes the same file' cmp "$tmp/balls" "$tmp/file"
scene balls 2 -o - >"$tmp/dash"
check '-o - is standard output' cmp "$tmp/balls" "$tmp/dash"

# The other dialect differs in lights, materials, floor and glass, not in geometry.
scene balls 2 --dialect spd >"$tmp/spd"
check 'spd lights have no color' has 'l 4 3 2'
check 'spd floor is a square' has 'p 4'
check 'spd spheres are as dull at every size' has 'f 1 0.9 0.7 0.5 0.5 3.0827 0 1'
sed -n '/^s /p' "$tmp/balls" >"$tmp/a"
sed -n '/^s /p' "$tmp/spd" >"$tmp/b"
check 'both dialects have the same spheres' cmp "$tmp/a" "$tmp/b"
scene mount 5 --dialect p3d >"$tmp/mount"
scene mount 5 --dialect spd >"$tmp/spd"
check 'spd glass has index 1.5' has 'f 1 1 1 0.1 0.1 101.148 0.9 1.5'
check 'spd glass spheres are of one size' has 's -0.98961 0.749194 0.930598 0.17'
sed -n '15,$p' "$tmp/mount" >"$tmp/a"
sed -n '15,$p' "$tmp/spd" >"$tmp/b"
check 'both dialects have the same mountain' cmp "$tmp/a" "$tmp/b"

check 'a size too large is a usage error' complains 2 'from 0 to 12' scene mount --size 99 \
    -o "$tmp/none"
check 'and leaves no file' test ! -e "$tmp/none"
check 'a negative size is a usage error' complains 2 'whole number' scene balls --size -1
check 'a generator needs a size' complains 2 'needs --size' scene balls
check 'an unknown generator' complains 2 "no generator 'gears'" scene gears --size 4
if [ -w /dev/full ]; then
    check 'a full disk is a failure' complains 1 'No space left' scene mount --size 5 -o /dev/full
fi
finish
