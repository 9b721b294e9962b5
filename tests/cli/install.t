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
for data in bench/plans/*.plan bench/events/*.events bench/energy/*.energy; do
    [ ! -e "$data" ] || check "the data ${data##*/}" cmp "$data" "$share/raybench/${data#bench/}"
done
check 'and nothing else' [ "$(find "$root" -type f | wc -l)" = $((5 + $(find bench \
    -name '*.plan' -o -name '*.events' -o -name '*.energy' | wc -l))) ]
cd "$tmp" || exit 1
check 'the installed program finds its plans' exits 0 bench smoke --dry-run
check 'and its events and models' exits 0 bench smoke --dry-run --measure time,hardware \
    --events amd-zen4 --energy-model jouppi21-7nm
finish
