#!/bin/sh
# raybench doctor: what it says of this machine, and of a made-up one.
. "$(dirname "$0")/tap.sh"

tree=$tmp/tree
put() { # PATH TEXT: a file of the made-up machine
    mkdir -p "$tree/$(dirname "$1")"
    printf '%s\n' "$2" >"$tree/$1"
}
put proc/sys/kernel/perf_event_paranoid 4
put proc/sys/kernel/randomize_va_space 2
put sys/devices/system/cpu/isolated 'a "quote", a \ backslash'
put sys/devices/system/clocksource/clocksource0/current_clocksource hpet

# One check a line: state, name.
lines() { grep -cE '^(ok|warn|bad|unknown) +[a-z]' "$tmp/out"; }
says() { grep -qE "$1" "$tmp/out"; }
escapes() { grep -q "$(printf '\033')" "$1"; }
plain() { [ -s "$1" ] && ! escapes "$1"; }

check 'it judges this machine' exits 0 doctor
check 'in one line each' [ "$(lines)" -ge 15 ]
check 'with a score' says '^score +([0-9]+ of 100|unknown)'
check 'no colours in a file' plain "$tmp/out"
check 'no errors' [ ! -s "$tmp/err" ]
check 'help states what the score is' exits 0 doctor --help
check 'in words' says 'ok counts'

check 'it judges a copy' exits 0 doctor --root "$tree"
check 'perf_event_paranoid 4' says '^bad +perf paranoid +4 - .*; fix: sudo sysctl'
check 'an unsound clock' says '^bad +clock source +hpet'
check 'random addresses' says '^ok +aslr +on'
check 'what is not there is unknown' says '^unknown +load +.*/proc/loadavg'
check 'the score counts the known: 1 of 2' says '^score +50 of 100'
mkdir "$tmp/none"
check 'an empty folder' exits 0 doctor --root "$tmp/none"
check 'has no score' says '^score +unknown'

# FILE: is it JSON? Where nobody can tell, 77.
is_json() {
    if command -v python3 >/dev/null && python3 -c '' 2>/dev/null; then
        python3 -m json.tool "$1" >/dev/null 2>"$tmp/err"
    elif perl -MJSON::PP -e '' 2>/dev/null; then
        perl -MJSON::PP -0777 -ne 'decode_json($_)' "$1" 2>"$tmp/err"
    else
        echo '# neither python3 nor JSON::PP: not checked'
    fi
}
for root in "" "$tree" "$tmp/none"; do
    check "JSON of root '${root##*/}'" exits 0 doctor --json ${root:+--root "$root"}
    check 'is JSON' is_json "$tmp/out"
    check 'with score and checks' says '"(score|state)":'
done
check 'an unknown score is null' says '"score": null'

terminal() { # ENVIRONMENT...: the doctor on a terminal
    env TERM=xterm "$@" script -qec "$raybench doctor" /dev/null >"$tmp/terminal" </dev/null 2>&1
}
if command -v script >/dev/null; then
    terminal NO_COLOR=
    check 'colours on a terminal' escapes "$tmp/terminal"
    terminal NO_COLOR=1
    check 'none with NO_COLOR' plain "$tmp/terminal"
else
    echo '# no script(1): colours are not checked'
fi

mkdir "$tmp/home"
chmod 555 "$tmp/home"
export HOME="$tmp/home"
check 'a read-only home' exits 0 doctor
closed() { # a closed standard output is a runtime failure, said in one line
    "$raybench" doctor >&- 2>"$tmp/err"
    [ $? = 1 ] && [ "$(wc -l <"$tmp/err")" = 1 ]
}
check 'a closed standard output' closed
check 'arguments are refused' complains 2 'unexpected argument' doctor now
check 'no folder is an error' complains 2 'no/such: cannot read' doctor --root "$tmp/no/such"
finish
