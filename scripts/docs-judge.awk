# Judges what scripts/docs-read.awk tells, for scripts/docs-check, after having read the Makefile
# (what=make) and the completions for bash (what=program); `files` are names of files with data that
# options take. Tells likewise file, line, kind, text: `say`, a finding; `link`, `block`, `path`,
# which only the file system can judge. Paths are words in code that begin with a folder of ours,
# and spans whose name has an ending.

function put(kind, text) { print where "\t" kind "\t" text }
function has(words, word) { return index(" " words " ", " " word " ") }
function placeholder(word) { return word ~ /^[A-Z<\[(]|\.\.\.|[$]/ }

# Is the word, maybe a pattern, one of the words?
function matches(words, word,   i, n, list) {
    if (word !~ /[*?]/) return has(words, word)
    gsub(/[.+]/, "[&]", word)
    gsub(/[*]/, ".*", word)
    gsub(/[?]/, ".", word)
    n = split(words, list, " ")
    for (i = 1; i <= n; i++)
        if (list[i] ~ "^" word "$") return 1
    return 0
}

# A value of what KEY takes, COMMAND:OPTION or COMMAND:POSITION. Numbers are not looked at, nor the
# many rows of Embree that are not in the table.
function judge_value(key, value,   i, n, list, part) {
    if (words[key] == "" && kinds[key] !~ /files/) return
    n = kinds[key] ~ /list/ ? split(value, list, ",") : 1
    if (n == 1) list[1] = value
    for (i = 1; i <= n; i++) {
        value = list[i]
        if (value ~ /^([0-9].*|embree-.*|-)?$/ || placeholder(value)) continue
        if (matches(words[key], value)) continue
        if (kinds[key] ~ /files/ && (value ~ /[.\/]/ || has(files, value))) continue
        if (kinds[key] ~ /folders/) continue
        split(key, part, ":")
        put("say", "\"" value "\" is nothing that raybench" (part[1] == "*" ? "" : " " part[1]) \
            (part[2] ~ /^-/ ? " " part[2] : "") " knows, see its --help")
    }
}

# The words from `at` on behind a command of raybench; "*" for options of any.
function judge_options(command, at, n,   word, value, key, position) {
    for (; at <= n; at++) {
        word = word_at[at]
        gsub(/[][]/, "", word)
        if (word ~ /^-[a-z-]/) {
            value = ""
            if (index(word, "=")) {
                value = substr(word, index(word, "=") + 1)
                word = substr(word, 1, index(word, "=") - 1)
            }
            key = command ":" word
            if (!has(options[command], word))
                put("say", command == "*" ? "no command of raybench has " word \
                    ", correct it, or say whose it is: `TOOL " word "`" : \
                    "raybench " command " has no " word ", see its --help")
            else if (key in words && value == "" && at < n) value = word_at[++at]
            if (value != "") judge_value(key, value)
        } else if (!placeholder(word) && command != "*") {
            position++
            key = command ":" position
            if (!(key in words)) key = command ":[0-9]*"
            if (key in words) judge_value(key, word)
            else put("say", "raybench " command " takes no \"" word "\", see its --help")
        }
    }
}

function judge_raybench(at, n,   command) {
    command = word_at[at]
    if (at > n || placeholder(command)) return
    if (!has(options["start"], command))
        put("say", "there is no raybench " command ", see raybench --help")
    else if (command !~ /^-/) judge_options(command, at + 1, n)
}

# Does the target use the variable: in its recipe, in variables and scripts that this uses?
function uses(target, name,   text, script, line, found) {
    text = rule[target]
    for (script in define)
        if (index(text, "$(" script ")")) text = text define[script]
    if (name in anywhere || index(text, "$(" name ")")) return 1
    while (!found && match(text, /scripts\/[a-z-]+/)) {
        script = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        while ((getline line < script) > 0)
            if (line ~ "[$][{]?" name "([^A-Z_]|$)") found = 1
        close(script)
    }
    return found
}

# Every variable must be used by a target; the values of those that are called like options are
# judged as these. With words that can be neither it is a sentence, not a command.
function judge_make(at, n,   i, j, count, targets, target, name, used, list, key) {
    for (i = at; i <= n; i++)
        if (word_at[i] !~ /^([a-z][a-z0-9_.\/-]*|[A-Z_]+=.*|-.*)$/ && !placeholder(word_at[i]))
            return
    for (i = at; i <= n; i++)
        if (word_at[i] ~ /^[a-z]/) {
            targets = targets " " word_at[i]
            if (!(word_at[i] in rule) && word_at[i] !~ /^build\//)
                put("say", "there is no make " word_at[i] ", see make help")
        }
    count = split(targets == "" ? "all" : targets, list, " ")
    for (i = at; i <= n; i++) {
        if (word_at[i] !~ /^[A-Z_]+=/) continue
        name = substr(word_at[i], 1, index(word_at[i], "=") - 1)
        used = 0
        for (j = 1; j <= count; j++) used += !(list[j] in rule) || uses(list[j], name)
        if (!used) put("say", "make" targets " does not use " name ", see the Makefile")
        key = "*:--" tolower(name)
        if (name == "SCENE") key = "*:--scenes"
        if (!(key in words)) continue
        target = substr(word_at[i], length(name) + 2)
        gsub(/ /, ",", target)
        judge_value(key, target)
    }
}

function judge_command(n,   at) {
    at = 1
    while (at <= n && word_at[at] ~ /^([A-Z_]+=.*|[$]|sudo|time|env)$/) at++
    if (word_at[at] == "make") judge_make(at + 1, n)
    if (word_at[at] ~ /^(.*\/)?raybench$/) judge_raybench(at + 1, n)
}

# A line of shell: its commands, word by word, up to a comment. Redirections are dropped.
function judge_shell(text,   i, c, quote, word, n) {
    for (i = 1; i <= length(text) + 1; i++) {
        c = i > length(text) ? ";" : substr(text, i, 1)
        if (quote != "" && i <= length(text)) {
            if (c == quote) quote = ""
            else word = word c
        } else if (c == "\"" || c == "'") {
            quote = c
        } else if (c ~ /[ ;&|]/) {
            if (word != "" && word !~ /^[0-9]?[<>]/) word_at[++n] = word
            word = ""
            if (c == " ") continue
            word_at[n + 1] = ""
            judge_command(n)
            n = 0
        } else if (c == "#" && word == "") {
            i = length(text)
        } else {
            word = word c
        }
    }
}

function find_paths(text, all,   i, n, list, path) {
    n = split(text, list, /[][ "'`=,;:(){}<>|]+/)
    for (i = 1; i <= n; i++) {
        path = list[i]
        sub(/[.]+$/, "", path)
        if (path ~ /^([.](ci|github)|bench|report|results|scripts|src|tests)\// ||
            (all && n == 1 && path ~ /^[A-Za-z_][^$]*\/.*[.][a-z0-9]+$/))
            put("path", path)
    }
}

# The block that is open must be the expected one; "" for none.
function pair_markers(expected,   name) {
    if (open == expected) return
    name = open == "" ? expected : open
    print (open == "" ? where : opened) "\tsay\tthis marker of block " name " has no partner, " \
        "begin it by <!-- " name " begin: COMMAND -->, end it by <!-- " name " end -->"
}

what == "make" && /^#   [A-Z]/ {
    while (match($0, /[A-Z]+=/)) {
        anywhere[substr($0, RSTART, RLENGTH - 1)]
        $0 = substr($0, RSTART + RLENGTH)
    }
}
what == "make" && match($0, /^[a-z_]+ *:?= /) { define[$1] = $0 }
what == "make" && /^[a-z][a-z\/-]*:([^=]|$)/ { target = $1; sub(/:.*/, "", target) }
what == "make" && /^$/ { target = "" }
what == "make" { if (target != "") rule[target] = rule[target] $0; next }

what == "program" && /words='/ {
    sub(/''[)]/, "start)")
    key = $1
    if (!sub(/[)]$/, "", key)) next
    split($0, quoted, "'")
    if ($0 !~ /kind=/) {
        options[key] = quoted[2]
        if (key != "start") options["*"] = options["*"] " " quoted[2]
        next
    }
    words[key] = quoted[2]
    kinds[key] = quoted[4]
    sub(/.*:/, "*:", key)
    if (quoted[2] != "") words[key] = words[key] " " quoted[2]
    kinds[key] = kinds[key] quoted[4]
}
what == "program" { next }

$1 != document { pair_markers(""); open = ""; document = $1 }
{ where = $1 "\t" $2; text = $4 }
$3 == "link" || $3 == "anchor" { print; next }
$3 == "begin" || $3 == "end" {
    name = text
    sub(/ .*/, "", name)
    pair_markers($3 == "end" ? name : "")
    open = opened = ""
    if ($3 == "end") next
    open = name
    opened = where
    put("block", name)
    sub(/^[^ ]* ?/, "", text)
}
$3 == "span" && /\t--[a-z]/ {
    gsub(/[|][^ ]*/, "", text)
    n = split(text, word_at, " ")
    judge_options("*", 1, n)
}
$3 == "span" && $4 ~ /^[a-z]+ .*--/ && has(options["start"], substr($4, 1, index($4, " ") - 1)) {
    text = "raybench " text
}
{ judge_shell(text); find_paths(text, $3 == "span") }
END { pair_markers("") }
