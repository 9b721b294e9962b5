#!/bin/sh
# make report: a page from results that are whole, partial, foreign or none; and in a browser.
# shellcheck disable=SC2016 # awk programs
. "$(dirname "$0")/tap.sh"

python=/usr/bin/python3
report() {
    code=$1
    shift
    "$python" scripts/report -o "$tmp/page" --raybench "$raybench" "$@" >"$tmp/out" 2>"$tmp/err"
    actual=$?
    [ $actual = "$code" ] || sed 's/^/# /' "$tmp/err"
    [ $actual = "$code" ]
}
says() { grep -qE -e "$1" "$tmp/page/report.md"; }

if ! "$python" -c 'import pandas, matplotlib, jinja2, PIL' 2>"$tmp/err"; then
    if command -v "$python" >/dev/null; then
        check 'without its libraries it says what to install' report 1 "$tmp"
        check 'in one line' grep -q 'apt-get install python3-pandas' "$tmp/err"
    fi
    echo '# skipped: pandas, matplotlib, jinja2 or PIL is missing'
    finish
    exit 0
fi

"$raybench" bench balls_low --variants naive,bvh,auto,bvh+omp --size 24x24 --processes 2 \
    --budget 0.2s --quiet --out "$tmp/results" >"$tmp/out" 2>"$tmp/err"
run=$tmp/results/latest
"$raybench" peaks "$run" >"$tmp/out"
check 'a page of a run' report 0 "$run"
check 'has twelve sections' [ "$(grep -c '<section' "$tmp/page/report.html")" = 12 ]
check 'each with a finding' [ "$(grep -c '<p class="finding">.' "$tmp/page/report.html")" = 12 ]
check 'as has the text' [ "$(grep -c '^\*\*.*\*\*$' "$tmp/page/report.md")" = 12 ]
check 'it needs nothing else' \
    [ "$(grep -cE '(src|href)="(http|[a-z]+\.)' "$tmp/page/report.html")" = 0 ]
check 'figures have words' [ "$(grep -c '<figure' "$tmp/page/report.html")" -gt 10 ]
check 'all of them' [ "$(tr '\n' ' ' <"$tmp/page/report.html" |
    grep -oE 'class="wide" tabindex="0" role="img" +aria-label="[^"]{10}' | wc -l)" = \
    "$(grep -c '<svg' "$tmp/page/report.html")" ]
sed -n 's/^!.*(\(figures[^)]*\))$/\1/p' "$tmp/page/report.md" >"$tmp/links"
check 'the text links figures' [ "$(wc -l <"$tmp/links")" -gt 10 ]
check 'that are there' [ "$(cd "$tmp/page" && xargs ls <"$tmp/links" | wc -l)" = \
    "$(wc -l <"$tmp/links")" ]
check 'what was not measured is said' says '^- By hardware: '
check 'energy is empty and not 0' says 'No energy was measured or modelled'
check 'the machine is named' grep -q 'raybench bench balls_low' "$tmp/page/report.md"
cp "$tmp/page/report.md" "$tmp/first.md"
cp "$tmp/page/report.html" "$tmp/whole.html"
check 'once more' report 0 "$run"
check 'is the same' cmp "$tmp/first.md" "$tmp/page/report.md"

# A folder that lacks files, columns, ends of lines.
cp -r "$run/" "$tmp/part"
rm "$tmp/part/samples.csv" "$tmp/part/peaks.csv" "$tmp/part/env.json"
check 'a partial folder' report 0 "$tmp/part"
check 'has no samples' says 'the folder has no samples.csv'
check 'nor roofs' says 'raybench peaks RESULT'
cut -d, -f1-33 "$run/kernels.csv" >"$tmp/part/kernels.csv"
cut -d, -f1-20 "$run/frame.csv" >"$tmp/part/frame.csv"
check 'an older schema' report 0 "$tmp/part"
check 'has times, too' says 'ns at the camera'
for file in kernels frame; do
    head -c 3000 "$run/$file.csv" >"$tmp/part/$file.csv"
done
check 'a table that ends in the middle' report 0 "$tmp/part"
rm "$tmp/part/kernels.csv"
check 'one table alone' report 0 "$tmp/part"
check 'has no time of kernels' says 'No kernel has a time'
head -c 4096 /dev/urandom >"$tmp/part/kernels.csv"
check 'noise for a table' report 0 "$tmp/part"
sed 's/AMD\|Intel\|unknown/another &/; 2,$s/^/another/' "$run/peaks.csv" >"$tmp/part/peaks.csv"
cp "$run/env.json" "$tmp/part"
cp "$run/kernels.csv" "$tmp/part"
check 'peaks of another machine' report 0 "$tmp/part"
check 'are no roofs' says 'The peaks are another machine'
check 'a folder that is none' report 1 "$tmp/nothing"
check 'is said in one line' [ "$(wc -l <"$tmp/err")" = 1 ]
check 'a place that cannot be written' report 1 -o /proc/page "$run"
check 'nor is one without a program' report 0 --raybench "$tmp/none" "$run"
check 'the page says so' says '^- balls_low: .*none'

# What a browser makes of it: wide, narrow, light, dark.
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
if [ -z "$browser" ] || grep -qE '__(asan|tsan)_init' "$raybench"; then
    echo '# skipped: no browser here, or a sanitizer'
    finish
    exit 0
fi
cp "$tmp/whole.html" "$tmp/page/report.html"
for width in 1280 390; do
    cat >"$tmp/page/frame$width.html" <<END
<iframe src="report.html" width="$width" height="2000"></iframe><p id="said"></p><script>
onload = function () {
  var d = document.querySelector("iframe").contentDocument, shown = 0, empty = 0;
  d.querySelectorAll("figure").forEach(function (f) {
    var box = f.querySelector("svg, img").getBoundingClientRect();
    if (box.width > 50 && box.height > 50) shown++; else empty++;
  });
  document.getElementById("said").textContent = "width " + d.documentElement.scrollWidth +
    " shown " + shown + " empty " + empty +
    " back " + getComputedStyle(d.body).backgroundColor + " ink " + getComputedStyle(d.body).color;
};
</script>
END
done
# WIDTH SCHEME: loads the page; 0 is dark, 1 is light.
look() {
    timeout 60 "$browser" --headless --no-sandbox --disable-gpu --allow-file-access-from-files \
        --user-data-dir="$tmp/browser" --enable-logging=stderr --virtual-time-budget=5000 \
        --blink-settings=preferredColorScheme="$2" --dump-dom \
        "file://$tmp/page/frame$1.html" >"$tmp/dom" 2>"$tmp/err"
    sed -n 's/.*<p id="said">\(.*\)<\/p>.*/\1/p' "$tmp/dom" >"$tmp/said"
}
figures=$(grep -c '<figure' "$tmp/page/report.html")
for width in 1280 390; do
    look $width 1
    check "at $width pixels all figures are shown" grep -q " shown $figures empty 0 " "$tmp/said"
    check 'nothing is wider than the page' awk -v most=$width '{ exit !($2 <= most) }' "$tmp/said"
    check 'nor is there an error' [ "$(grep -c 'CONSOLE' "$tmp/err")" = 0 ]
    cp "$tmp/said" "$tmp/light"
    look $width 0
    check 'dark, too' grep -q " shown $figures empty 0 " "$tmp/said"
    check 'paper and ink are others then' [ "$(sed 's/.* back//' "$tmp/said")" != \
        "$(sed 's/.* back//' "$tmp/light")" ]
done
finish
