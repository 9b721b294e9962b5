#!/bin/sh
# raybench man: a page without mistakes that has every command and every option.
# shellcheck disable=SC2317 # functions reach `check` by name
. "$(dirname "$0")/tap.sh"

check 'a page' exits 0 man
cp "$tmp/out" "$tmp/page"
check 'no argument' complains 2 'unexpected argument' man bash

# No line may look like a macro by chance: these are all that the page uses.
macros='^(\.\\"|\.(TH|SH|SS|PP|TP|B|I|RI|BR|nf|fi|RS|RE|br|nh)( |$)|[^.'"'"'])'
check 'only macros we know' [ -z "$(grep -vE "$macros" "$tmp/page")" ]
for title in NAME SYNOPSIS DESCRIPTION COMMANDS SCENES VARIANTS 'EXIT STATUS' ENVIRONMENT FILES \
    EXAMPLES 'SEE ALSO'; do
    check "a section $title" grep -qx ".SH $title" "$tmp/page"
done

# COMMAND: are its options in its section?
has_options() {
    sed -n "/^\.SS raybench $1 /,/^\.S[SH] /p" "$tmp/page" | sed 's/\\-/-/g' >"$tmp/section"
    "$raybench" "$1" --help | sed -n '/^Options:/,$ s/^  \(-[^ ]*\) .*/\1/p' >"$tmp/options"
    [ -s "$tmp/options" ] || return 1
    while read -r option; do
        grep -qF -e "\\fB$option\\fR" "$tmp/section" || echo "# the page lacks $1 $option"
    done <"$tmp/options" | tee "$tmp/lacking"
    [ ! -s "$tmp/lacking" ]
}

for command in $("$raybench" --help | sed -n '/^usage/,/^Start/ s/^  \([a-z]*\) .*/\1/p'); do
    check "$command and its options" has_options "$command"
done

if command -v groff >/dev/null; then
    LC_ALL=C groff -ww -man -Tascii -P-c "$tmp/page" >"$tmp/text" 2>"$tmp/err"
    check 'groff has no warnings' [ ! -s "$tmp/err" ]
    check 'hyphens stay hyphens' grep -qE 'raybench render balls_high -o balls\.png' "$tmp/text"
    check 'quotes stay quotes' grep -qE "SPD's +test +rules" "$tmp/text"
else
    echo '# groff is not installed: the page is not formatted'
fi
if command -v mandoc >/dev/null; then
    mandoc -T lint -W warning "$tmp/page" | grep -v 'missing date' >"$tmp/err"
    check 'mandoc has no warnings' [ ! -s "$tmp/err" ]
else
    echo '# mandoc is not installed: the page is not checked by it'
fi
finish
