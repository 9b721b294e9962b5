#!/bin/sh
# scripts/docs-check: finds each kind of mistake, once, where it is, and nothing in what is right.
# shellcheck disable=SC2016,SC2317 # backticks are Markdown; functions reach `check` by name
. "$(dirname "$0")/tap.sh"
RAYBENCH=$raybench
export RAYBENCH
doc=$tmp/doc.md

run() { # TEXT: the document is this
    printf '%b\n' "$1" >"$doc"
    scripts/docs-check "$doc" >"$tmp/out" 2>"$tmp/err"
}
finds_one() { # LINE PATTERN TEXT: exactly this
    run "$3" && return 1
    sed 's/^/# /' "$tmp/out"
    [ "$(wc -l <"$tmp/out")" = 1 ] && grep -E -e "^$doc:$1: .*$2" "$tmp/out" | grep -q ', '
}
finds() { check "finds: $2" finds_one "$@"; }
fine_one() {
    run "$1" && [ ! -s "$tmp/err" ] && return
    sed 's/^/# /' "$tmp/out"
    return 1
}
fine() { check "fine: $1" fine_one "$2"; }

finds 1 'there is no make benchmark' '`make benchmark`'
finds 3 'there is no make benchmark' 'Say\n\n    make benchmark # now\n'
finds 1 'make table does not use SCENES' '`make table SCENES=balls_high`'
finds 1 '"ballz" is nothing' '`make explain SCENE=ballz`'
finds 1 'there is no raybench bnech' '`raybench bnech`'
finds 2 'raybench bench has no --buget' '```sh
build/raybench bench --budget 2m && raybench bench --buget 1s\n```'
finds 2 'raybench bench has no --buget' '```\nraybench bench \\\n  --buget 1s\n```'
finds 2 'raybench render has no --buget' 'A span may\n`raybench render\n--buget 1m` break.'
finds 1 'raybench compare has no --gates' 'See `compare --gates`.'
finds 1 'no command of raybench has --buget' '`--buget 2m`'
finds 1 '"bvhh" is nothing that raybench bench --variants' '`raybench bench --variants bvh,bvhh`'
finds 1 '"pocket-\*" is nothing' "\`raybench bench --variants 'pocket-*,stream-*'\`"
finds 1 '"balls_hi" is nothing' '`raybench render balls_hi`'
finds 1 '"laddder" is nothing that raybench bench knows' '`raybench bench laddder`'
finds 1 '"sums" is nothing that raybench bench --measure' '`raybench bench --measure time,sums`'
finds 1 '"horse" is nothing that raybench count --heatmap' '`raybench count --heatmap horse`'
finds 1 '"xml" is nothing that raybench export --format' '`raybench export A --format=xml`'
finds 1 '"guess" is nothing that raybench replay --mode' '`raybench replay A --mode guess`'
finds 1 '"z80" is nothing that raybench bench --events' '`raybench bench --events z80`'
finds 1 'raybench doctor takes no "please"' '`raybench doctor please`'
finds 1 'there is no scripts/chek' '`scripts/chek style`'
finds 3 'there is no bench/plans/laddder.plan' 'Text\n\n    cat bench/plans/laddder.plan\n'
finds 1 'there is no kernels/kernal.h' '`kernels/kernal.h`'
finds 1 'there is no bench/plans/NAME.plam' '`bench/plans/NAME.plam`'
finds 2 'the link nowhere.md leads nowhere' 'A [link\nthat](nowhere.md) leads'
finds 1 'the link nowhere.png leads nowhere' '<img src="nowhere.png" width="3">'
finds 3 'the link nowhere.md' 'A [reference].\n\n[reference]: nowhere.md'
finds 2 'the link #there has no heading' '# Here\n[`it`](#there)'
finds 1 'does not know the block fish' '<!-- fish begin: make table -->\n<!-- fish end -->'
finds 3 'marker of block fish has no partner' 'text\n\n<!-- fish end -->'
table1='<!-- table1 begin: make table -->'
finds 1 'block table1: .*stale, or edited; run make table' "$table1\n| 1 | 2 |\n<!-- table1 end -->"

fine 'what there is' '# A title: of `this`!\n\n# A title: of `this`!\n
[one](#a-title-of-this), [two](#a-title-of-this-1), [web](https://example.org/x), [me](doc.md)
`make -j4 test CC=clang` `make gate BASE=main GATE="--markdown FILE"` `make check FUZZ_S=5`
`raybench bench SCENE --variants "packet-*,embree,bvh8-neon" --measure time,count --budget 2m`
`raybench replay x.rays --mode hardware --events generic` `raybench bench [--resume]` `--depth N`
``a `make x` `` `a/b` is'
fine 'other code' '    make up your mind? no: text\n\nThen\n\n1. list\n\n   text, no code: make x\n
    raybench: balls.nff:1:2: a message\n\n~~~\nmakefile nonsense | raybench_x --what\n~~~'
if git rev-parse --git-dir >/dev/null 2>&1; then
    fine 'what is made' '`build/perf/flame.svg` `results/latest/frame.csv`'
else
    echo '# not a checkout: .gitignore is not looked at'
fi
check 'options are not for it' [ "$(scripts/docs-check --what 2>&1)" = \
    'usage: scripts/docs-check [FILE...]' ]
finish
