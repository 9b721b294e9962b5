#!/bin/sh
# raybench table: measures a cheap scene with hyperfine and without, and finds stale files.
. "$(dirname "$0")/tap.sh"

out=$tmp/report readme=$tmp/README.md csv=$tmp/report/table1.csv
markers() {
    printf 'top\n<!-- table1 begin: make table -->\n<!-- table1 end -->\nbottom\n' >"$readme"
}
small() { # CODE OPTION...: runs a small table
    code=$1
    shift
    exits "$code" table --scenes balls_low --variants naive,bvh,bvh+omp --out "$out" \
        --readme "$readme" "$@"
}
table() { small "$1" --runs 3 --budget 1m; }
checked() { # PATTERN: --check fails with one line that matches
    small 2 --check && [ "$(wc -l <"$tmp/err")" = 1 ] && grep -qE -e "$1" "$tmp/err"
}

# LINE COLUMN: a field of the CSV, which has no quotes up to `runs`.
field() { tr -d '\r' <"$csv" | sed -n "$1p" | cut -d, -f"$2"; }

# Both clocks: the same files.
look() { # SOURCE
    check "$1: it measures" table 0
    check "$1: it says what it will take" grep -qE '^[0-9]+ rows, about [0-9]+ s of a budget' \
        "$tmp/out"
    key=scene,paper_s,variant,threads,median_s,mean_s,min_s,max_s,runs,source
    check "$1: the CSV begins with its columns" [ "$(head -1 "$csv" | cut -d, -f1-10)" = "$key" ]
    check "$1: naive comes first, with the paper's seconds" \
        [ "$(field 2 1),$(field 2 2),$(field 2 3),$(field 2 4)" = balls_low,3,naive,1 ]
    check "$1: the source is a column" grep -q ",$1" "$csv"
    # A sanitizer on a busy machine may take the whole budget for fewer.
    [ "${TEST_SLOW:-1}" = 0 ] || check "$1: three runs of every row" \
        [ "$(sed 1d "$csv" | cut -d, -f9 | sort -u)" = 3 ]
    # shellcheck disable=SC2016 # awk's
    check "$1: min <= median <= max, and three times the mean is their sum" awk -F, '
        NR > 1 && $9 == 3 && !($7 > 0 && $7 <= $5 && $5 <= $8 &&
            (3 * $6 - $5 - $7 - $8) ^ 2 < (1e-4 * $6) ^ 2) { bad = 1 }
        END { exit bad || NR < 3 }' "$csv"
    # shellcheck disable=SC2016
    check "$1: speed-ups are ratios of medians" awk -F, '
        NR == 2 { naive = $5; measured = $9 == 3 }
        NR > 1 && $9 == 3 && measured && !((naive / $5 / $11 - 1) ^ 2 < 1e-8 &&
            (3 / $5 / $12 - 1) ^ 2 < 1e-8) { bad = 1 }
        END { exit bad || NR < 3 }' "$csv"
    # A row that no run of hyperfine fitted in the budget of names our own clock.
    check "$1: the Markdown has every row" \
        [ "$(grep -cE '\| (hyperfine|raybench)' "$out/table1.md")" = $(($(wc -l <"$csv") - 1)) ]
    check "$1: the README has the block, and keeps the rest" \
        [ "$(sed -n -e '1p;$p' -e 's/^| balls_low | 3 | .*/row/p' "$readme" | tr '\n' ' ')" = \
        'top row bottom ' ]
    check "$1: and --check agrees" small 0 --check
}
markers
if command -v hyperfine >/dev/null; then
    look hyperfine
else
    echo '# hyperfine is not installed: only our own clock is tested'
fi
mkdir "$tmp/bin"
for tool in sh git; do ln -s "$(command -v $tool)" "$tmp/bin/$tool"; done
printf '#!%s\nPATH=%s exec "%s" "$@"\n' "$(command -v sh)" "$tmp/bin" \
    "$(cd "$(dirname "$raybench")" && pwd)/$(basename "$raybench")" >"$tmp/bare"
chmod +x "$tmp/bare"
raybench=$tmp/bare
look raybench

# What is stale is found, wherever it is.
edit() { # FILE EXPRESSION
    cp "$1" "$tmp/saved"
    sed "$2" "$tmp/saved" >"$1"
}
restore() { cp "$tmp/saved" "$1"; }
digit='s/\(.*[0-9]\)\([0-9]\)/\1x\2/;s/x1/2/;s/x[02-9]/1/'
edit "$csv" '2s/\(naive,1,[0-9]*\.\)[0-9]*/\14242/'
check 'an edited time in the CSV' checked 'table1\.(csv|md):[0-9]+:1: .*run make table'
restore "$csv"
edit "$out/table1.md" "/| naive |/{$digit;}"
check 'an edited digit in the Markdown' checked 'table1.md:[0-9]+:1: .*run make table'
restore "$out/table1.md"
edit "$readme" "/balls_low/{$digit;}"
check 'an edited digit in the README' checked 'README.md:[0-9]+:1: .*run make table'
check '--rewrite mends it' small 0 --rewrite
check 'byte for byte' cmp -s "$readme" "$tmp/saved"
check 'the whole table wants six scenes' complains 2 'no row of naive on balls_medium' \
    table --check --variants naive,bvh,bvh+omp --out "$out"
edit "$csv" '/,bvh,/d'
check 'a row is missing' checked 'no row of bvh on balls_low'
restore "$csv"
edit "$readme" '/table1 end/d'
check 'a marker is missing' checked 'README.md: there is no line <!-- table1 end -->'
check 'and found before anything is measured' table 2
restore "$readme"
check 'all is as before' small 0 --check

# The budget: what does not fit is extrapolated, and says so.
check 'a small budget' exits 0 table --scenes balls_low,mount_high --variants naive,bvh \
    --budget 1s --runs 1 --out "$tmp/small"
check 'naive is extrapolated and marked' grep -qE \
    '^mount_high,272,naive,1,[0-9.]+,,,,0,raybench,1,[^,]*,est' "$tmp/small/table1.csv"
[ "${TEST_SLOW:-1}" = 0 ] || check 'in the Markdown, too' grep -qE \
    '^\| naive \| [0-9.]+ \| [0-9.]+ est\. \|' "$tmp/small/table1.md"
[ "${TEST_SLOW:-1}" = 0 ] || check 'what is short is measured' grep -qE \
    '^balls_low,3,bvh,1(,[0-9.]+){4},1,' "$tmp/small/table1.csv"

# Bad usage, and a machine that lets us down.
check 'a part is not for report/' complains 2 'add --out DIR' table --scenes balls_low
check 'unknown scene' complains 2 "'balls' matches no scene" table --scenes balls --out "$tmp/x"
check 'an alias is no row' complains 2 "'packet' matches no variant" table --variants packet \
    --out "$tmp/x"
check 'a folder that cannot be made' complains 1 'cannot make the folder' table --out "$tmp/no/such"
check 'no table yet' complains 2 'there is no table yet' table --check --out "$tmp/none"
check 'no temporary folder' env TMPDIR="$tmp/none" sh -c "! '$raybench' table --scenes balls_low \
    --out '$tmp/x' 2>'$tmp/err' && grep -q 'temporary folder' '$tmp/err'"

# A signal ends the render, too, and leaves nothing behind.
mkdir "$tmp/tmpdir"
TMPDIR=$tmp/tmpdir "$raybench" table --scenes mount_very_high --variants naive --out "$tmp/killed" \
    >/dev/null 2>&1 &
pid=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do [ -n "$(ls "$tmp/tmpdir")" ] || sleep 0.2; done
sleep 0.2
kill -TERM $pid
wait $pid 2>/dev/null # the shell would say "Terminated"
check 'SIGTERM ends it' [ $? = 143 ]
check 'without temporary files' [ -z "$(ls "$tmp/tmpdir")" ]
check 'without a table' [ -z "$(ls "$tmp/killed")" ]
finish
