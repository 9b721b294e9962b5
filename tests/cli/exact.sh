# shellcheck shell=sh
# Sourced by tests/cli/exact.t and scripts/exact: do all rows of all builds give the same bits?
#
# A cell is one row of a program at one level of RAYBENCH_CPU_DISABLE. It stands for renders of all
# scenes with all tile sizes and thread counts, each of which has to give what the reference gave:
# the row naive of $RAYBENCH. A level is `none` or a comma-separated list of features to do without.
# A PROGRAM is one or more words: an emulator may come before its path. Callers export
#   tmp      a directory: `expected` has the reference's renders, `differs.*` those that differ
#   size     WxH of the images
#   tiles    tile sizes
#   threads  thread counts of the +omp rows
: "${tmp:?}" "${size:?}" "${tiles:?}" "${threads:?}" "${RAYBENCH:?}"
scenes='balls_low balls_medium balls_high mount_low mount_high mount_very_high'
# Packets of 16 rays in vector extensions, whatever the instruction set has.
export sixteen_lanes='-DRB_LANES=16 -Wno-psabi'
jobs=$(nproc 2>/dev/null || echo 1)
export OMP_WAIT_POLICY=passive # cells share the processors

# SCENE ROW: the image size. Rows that test every primitive get less of the large scenes, but more
# than one tile of 16 pixels.
size_of() {
    case $1/$2 in
    balls_high/naive* | mount_high/naive*) echo 17x5 ;;
    mount_very_high/naive*) echo 17x3 ;;
    *) echo "$size" ;;
    esac
}

# PROGRAM...: a line `NAME AVAILABLE NEEDS` per row that is exact.
list_rows() {
    "$@" list variants --json |
        grep '"exact": true' |
        sed -n 's/.*"name": "\([^"]*\)", "available": \([a-z]*\), "needs": "\([^"]*\)".*/\1 \2 \3/p'
}

# PROGRAM...: the levels; the features that its rows need are taken away one by one, the last first.
list_levels() {
    list_rows "$@" | awk '
        $2 == "true" {
            count = split($3, needs, ",")
            for (i = 1; i <= count; i++)
                if (needs[i] !~ /OpenMP|[*]/ && !seen[needs[i]]++) features[++last] = needs[i]
        }
        END {
            print "none"
            for (; last; last--) print level = level (level ? "," : "") features[last]
        }'
}

# FUNCTION WORDS...: calls FUNCTION of this file with WORDS and those of a line of standard input,
# for all lines, as many at a time as there are processors.
spread() {
    # shellcheck disable=SC2016 # for the inner shell
    xargs -P "$jobs" -L 1 sh -c '. tests/cli/exact.sh; "$0" "$@"' "$@"
}

# SCENE SIZE ROW TILE THREADS PROGRAM...: renders; `command` is how, `got` is what came of it:
# scene, size, both hashes and the SHA-256 of the PFM.
render() {
    got="$1 $2" image=$tmp/image.$$.pfm
    set -- "$@" render "$1" --size "$2" --variant "$3" --tile "$4" --threads "$5" --hash --quiet
    shift 5
    command=$*
    got="$got $("$@" -o "$image" 2>&1) $(sha256sum <"$image")"
    rm -f "$image"
}

# SCENE SIZE: prints the reference.
reference() {
    render "$1" "$2" naive 64 1 "$RAYBENCH"
    echo "$got"
}

# SIZE...: notes what the reference gives for all scenes in these sizes.
expect() {
    for edge in "$@"; do
        for scene in $scenes; do
            echo "$scene $edge"
            echo "$scene $(size_of "$scene" naive)"
        done
    done | sort -u | spread reference >"$tmp/expected"
    [ "$(grep -c ' image .* hits .* -$' "$tmp/expected")" = "$(wc -l <"$tmp/expected")" ]
}

# NUMBER LEVEL ROW PROGRAM...: renders the row; prints `NUMBER|LEVEL|ROW|VERDICT|REASON`, where the
# verdict is same, DIFFERS, or - for a row that is not available.
cell() {
    head="$1|$2|$3" level=$2 row=$3
    shift 3
    export RAYBENCH_CPU_DISABLE="${level#none}"
    echo "$head|$(judge "$row" "$@")"
}

# ROW PROGRAM...
judge() {
    row=$1
    shift
    needs=$(list_rows "$@" | awk -v row="$row" '$1 == row {print $2, $3}')
    case $needs in
    true*) ;;
    false*) echo "-|needs ${needs#false }" && return ;;
    *) echo 'DIFFERS|not listed' && return ;;
    esac
    for feature in $(echo "$RAYBENCH_CPU_DISABLE" | tr , ' '); do
        case ",${needs#true }," in
        *",$feature,"*) echo "DIFFERS|available without $feature" && return ;;
        esac
    done
    if all_match "$row" "$@"; then echo 'same|'; else echo 'DIFFERS|see below'; fi
}

# ROW PROGRAM...
all_match() {
    row=$1 verdict=0 counts=1
    shift
    case $row in *+omp) counts=$threads ;; esac
    for scene in $scenes; do
        for tile in $tiles; do
            for count in $counts; do
                matches "$scene" "$(size_of "$scene" "$row")" "$row" "$tile" "$count" "$@" ||
                    verdict=1
            done
        done
    done
    return $verdict
}

# As render; fails and notes it if that is not what the reference gave.
matches() {
    render "$@"
    grep -qxF "$got" "$tmp/expected" && return
    {
        echo "RAYBENCH_CPU_DISABLE=$RAYBENCH_CPU_DISABLE $command"
        echo "    gives    $got"
        echo "    expected $(grep "^$1 $2 " "$tmp/expected")"
    } >>"$tmp/differs.$$"
    return 1
}

# PROGRAM...: a line `LEVEL|ROW|VERDICT|REASON` for all rows at $levels, or at all levels.
cells() {
    for level in ${levels:-$(list_levels "$@")}; do
        for row in $(list_rows "$@" | sed 's/ .*//'); do echo "$level $row $*"; done
    done | awk '{print NR, $0}' | spread cell | sort -n | cut -d '|' -f 2-
}

# COMPILER OPT CONFIG [TARGET]: builds, without Embree, whose rows are not exact; variables of a
# calling make must not leak in.
build() {
    mkdir -p build
    env -u MAKEFLAGS -u MAKEOVERRIDES -u MAKELEVEL -u SANITIZE -u OPENMP -u PNG \
        make -s -j "$jobs" CC="$1" OPT="$2" CONFIG="$3" EMBREE=0 "${4:-all}" >"build/$3.log" 2>&1
}
