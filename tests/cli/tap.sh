# shellcheck shell=sh disable=SC2034
# Sourced by the command-line tests: TAP for programs. Each check is one numbered line.
cd "$(dirname "$0")/../.." || exit 1
raybench=${RAYBENCH:-build/raybench}
count=0
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT

# NAME COMMAND...: passes if the command succeeds.
check() {
    name=$1
    shift
    count=$((count + 1))
    if "$@"; then
        echo "ok $count - $name"
    else
        echo "not ok $count - $name"
        sed 's/^/# /' "$tmp/err" 2>/dev/null
    fi
}

# CODE ARGUMENTS...: runs the program, output to $tmp/out and $tmp/err; passes if it exits with CODE.
exits() {
    expected=$1
    shift
    "$raybench" "$@" >"$tmp/out" 2>"$tmp/err" </dev/null
    actual=$?
    [ "$actual" = "$expected" ] || echo "# exit code $actual of: $*"
    [ "$actual" = "$expected" ]
}

# CODE PATTERN ARGUMENTS...: fails with CODE, printing one line that matches PATTERN.
complains() {
    code=$1 pattern=$2
    shift 2
    exits "$code" "$@" && [ "$(wc -l <"$tmp/err")" = 1 ] && grep -qE -e "$pattern" "$tmp/err"
}

finish() { echo "1..$count"; }
