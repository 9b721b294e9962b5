#!/bin/sh
# raybench completions: every command and option in every script, and bash's candidates as a user
# gets them. The options come from --help, which reads the tables that parse.
# shellcheck disable=SC2317 # functions reach `check` by name
. "$(dirname "$0")/tap.sh"

for shell in bash zsh fish; do
    check "a script for $shell" exits 0 completions $shell
    cp "$tmp/out" "$tmp/$shell"
done
check 'an unknown shell' complains 2 "not 'csh'" completions csh
check 'no shell' complains 2 'missing argument' completions

# has_shell SHELL: says that it is missing.
has_shell() {
    command -v "$1" >/dev/null || {
        echo "# $1 is not installed: its script is not run"
        false
    }
}
for shell in bash zsh fish; do
    has_shell $shell && check "$shell reads its script" $shell -n "$tmp/$shell"
done

# COMMAND: the options of its help page, one a line.
options() {
    "$raybench" "$1" --help | sed -n '/^Options:/,$ s/^  \(-[^ ]*\) .*/\1/p'
}

# The section of a command in the zsh script.
zsh_section() { sed -n "/^    $1)/,/;;/p" "$tmp/zsh"; }

# COMMAND: is each of its options in each of the scripts?
complete_options() {
    zsh_section "$1" >"$tmp/section"
    [ -s "$tmp/section" ] && [ -n "$(options "$1")" ] || return 1
    for option in $(options "$1"); do
        long=${option#--}
        flag="-l $long"
        [ "$long" != "$option" ] || flag="-s ${option#-}"
        grep -qE "^    $1\) words='(.* )?${option}[ ']" "$tmp/bash" || echo "# bash lacks $option"
        grep -qE "^ +'$option(=?\[|=\[)" "$tmp/section" || echo "# zsh lacks $option"
        grep -qE "__raybench_at $1' .* $flag( |\$)" "$tmp/fish" || echo "# fish lacks $option"
    done | tee "$tmp/lacking"
    [ ! -s "$tmp/lacking" ]
}

commands=$("$raybench" --help | sed -n '/^usage/,/^Start/ s/^  \([a-z]*\) .*/\1/p')
check 'there are commands' [ "$(echo "$commands" | wc -w)" -ge 6 ]
for command in $commands; do
    check "the options of $command are in all scripts" complete_options "$command"
    check "zsh tells about $command" grep -q "^        '$command:" "$tmp/zsh"
    check "fish tells about $command" grep -qE "__raybench_at' .* -a $command\$" "$tmp/fish"
done

# WORD...: what bash offers for the last word, the candidates on one line.
candidates() {
    # shellcheck disable=SC2016 # a script for another shell
    bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _raybench
        printf "%s\n" "${COMPREPLY[@]}"' "$tmp/bash" raybench "$@" | tr '\n' ' ' | sed 's/ $//'
}

# EXPECTED WORD...
offers() {
    wanted=$1
    shift
    actual=$(candidates "$@")
    [ "$actual" = "$wanted" ] || echo "# offered: $actual"
    [ "$actual" = "$wanted" ]
}

if has_shell bash; then
    every=$(echo "$commands" | tr '\n' ' ')
    check 'commands' offers "$every--help --version" ''
    check 'a command' offers render ren
    check 'options' offers '--specular --spd' render --sp
    check 'all options' offers "$(options render | tr '\n' ' ' | sed 's/ $//')" render -
    check 'words' offers 'blinn phong' render --specular ''
    check 'words between commas' offers 'time,simulate' bench --measure time,s
    check 'what can be drawn' offers 'triangles tests' count --heatmap t
    check 'the value behind =' offers phong render --specular = p
    check 'nothing typed behind =' offers 'blinn phong' render --specular =
    check 'variants' offers "$("$raybench" list variants | sed -n 's/^\(packet[^ ]*\) .*/\1/p' |
        tr '\n' ' ' | sed 's/ $//')" render --variant packet
    check 'a number is not known' offers '' render --depth ''
    check 'scenes' offers 'mount_low' render mount_l
    check 'the second argument behind options' offers '' pixel --depth 3 mount_low --spd ''
    check 'arguments without end' offers 'balls_high' bench a b balls_h
    check 'what list lists' offers 'variants scenes' list ''
    check 'an unknown command has nothing' offers '' nonsense ''
    mkdir -p "$tmp/files/some folder"
    touch "$tmp/files/some file"
    check 'files' offers "$tmp/files/some file $tmp/files/some folder" render -o "$tmp/files/s"
    check 'folders' offers "$tmp/files/some folder" bench --out "$tmp/files/s"
    check 'scenes may be files' offers "$tmp/files/some file" info "$tmp/files/some fi"
fi
finish
