#!/bin/sh
# make install, into a folder of its own: everything is there and works from there.
. "$(dirname "$0")/tap.sh"

root="$tmp/a root"
# What was built is installed as it is (-o all), whatever the flags it was built with.
env -u MAKEFLAGS -u MAKEOVERRIDES make -s -o all install "B=${BUILD:-build/release}" PREFIX=/opt \
    "DESTDIR=$root" >"$tmp/log" 2>"$tmp/err"
check 'make install' [ $? = 0 ]
share=$root/opt/share
raybench=$(realpath "$raybench")
check 'the program' cmp "$raybench" "$root/opt/bin/raybench"
check 'which can be run' [ -x "$root/opt/bin/raybench" ]
raybench=$root/opt/bin/raybench
"$raybench" man >"$tmp/page"
check 'the manual page' cmp "$tmp/page" "$share/man/man1/raybench.1"
for place in bash:bash-completion/completions/raybench zsh:zsh/site-functions/_raybench \
    fish:fish/vendor_completions.d/raybench.fish; do
    "$raybench" completions "${place%%:*}" >"$tmp/script"
    check "the completion of ${place%%:*}" cmp "$tmp/script" "$share/${place#*:}"
done
for plan in bench/plans/*.plan; do
    [ ! -e "$plan" ] || check "the plan ${plan##*/}" cmp "$plan" "$share/raybench/plans/${plan##*/}"
done
check 'and nothing else' \
    [ "$(find "$root" -type f | wc -l)" = $((5 + $(find bench/plans -name '*.plan' | wc -l))) ]
cd "$tmp" || exit 1
check 'the installed program finds its plans' exits 0 bench smoke --dry-run
finish
