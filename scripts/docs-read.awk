# Reads Markdown for scripts/docs-check and tells what is in it, one thing a line: file, line, kind,
# text, with tabs between. Kinds: code (a line of a block), span, link, anchor, begin, end (markers
# of a generated block). Blocks and lists are those of CommonMark 0.31 as far as is needed here.

function put(line, kind, text) {
    gsub(/[ \t\n]+/, " ", text)
    gsub(/^ | $/, "", text)
    if (text != "") print document "\t" line "\t" kind "\t" text
}
function lines(text) { return gsub(/\n/, "", text) }

# Where the run of backticks that is as long as the first one stands in the text behind it; 0.
function closing(rest, width,   from) {
    for (from = 1; match(substr(rest, from), /`+/); from += RSTART + RLENGTH - 1)
        if (RLENGTH == width) return from + RSTART - 1
    return 0
}

# Takes the spans out of the paragraph, then the links from what is left.
function end_paragraph(   prose, rest, width, end, target, line) {
    while (match(paragraph, /`+/)) {
        width = RLENGTH
        rest = substr(paragraph, RSTART + width)
        prose = prose substr(paragraph, 1, RSTART - 1)
        end = closing(rest, width)
        if (end) {
            put(first + lines(prose), "span", substr(rest, 1, end - 1))
            for (line = lines(substr(rest, 1, end - 1)); line; line--) prose = prose "\n"
            rest = substr(rest, end + width)
        }
        paragraph = rest
    }
    prose = prose paragraph
    line = first
    while (match(prose, /\]\([^()]*\)|(src|srcset|href)="[^"]*"|(^|\n)\[[^]]*\]: *[^ \n]+/)) {
        target = substr(prose, RSTART, RLENGTH)
        line += lines(substr(prose, 1, RSTART - 1))
        prose = substr(prose, RSTART)
        sub(/^(\]\(<?|[a-z]+="|\n?\[[^]]*\]: *<?)/, "", target)
        sub(/[ )>"].*/, "", target)
        put(line, "link", target)
        line += lines(substr(prose, 1, RLENGTH))
        prose = substr(prose, RLENGTH + 1)
    }
    paragraph = held = ""
}

# As on GitHub: small letters, no punctuation, dashes for blanks, a number behind the second.
function put_anchor(title,   name) {
    name = tolower(title)
    sub(/^#+ +/, "", name)
    gsub(/[^a-z0-9 _-]/, "", name)
    gsub(/ /, "-", name)
    put(FNR, "anchor", seen[document, name]++ ? name "-" seen[document, name] - 1 : name)
}

# A line that ends in a backslash goes on.
function put_code(text) {
    if (held == "") start = FNR
    held = held text
    if (sub(/\\$/, "", held)) return
    put(start, "code", held)
    held = ""
}

FNR == 1 { end_paragraph(); fence = ""; base = 0; document = FILENAME }
fence != "" {
    text = $0
    sub(/^ +/, "", text)
    if (index(text, fence) == 1 && text ~ /^(`+|~+) *$/) fence = held = ""
    else put_code($0)
    next
}
/^ *$/ { end_paragraph(); next }
{
    indent = match($0, /[^ ]/) - 1
    if (paragraph == "" && indent < base) base = indent
}
paragraph == "" && indent >= base + 4 { put_code($0); next }
/^ *(```+[^`]*|~~~+.*)$/ {
    end_paragraph()
    match($0, /`+|~+/)
    fence = substr($0, RSTART, RLENGTH)
    next
}
/^<!-- [a-z0-9-]+ (begin: .*|end) -->$/ {
    end_paragraph()
    text = substr($0, 6, length($0) - 9)
    kind = $3 == "end" ? "end" : "begin"
    sub(" " kind ":?", "", text)
    put(FNR, kind, text)
    next
}
/^#+ / { end_paragraph(); put_anchor($0) }
match($0, /^ *([-*+]|[0-9]+[.)]) +/) { end_paragraph(); base = RLENGTH }
{
    if (paragraph == "") first = FNR
    paragraph = paragraph $0 "\n"
}
/^#+ / { end_paragraph() }
END { end_paragraph() }
