#!/bin/sh
# raybench bench: verifies, measures, and keeps what it measured.
. "$(dirname "$0")/tap.sh"

check 'a small benchmark runs' exits 0 bench balls_low mount_low --size 48x48 --budget 0.5 \
    --out "$tmp/results"
check 'it prints time per ray' grep -qE '^ +trace_shadow +[0-9]' "$tmp/out"
check 'it prints what the probes cost' grep -q 'A probe costs' "$tmp/out"
csv=$tmp/results/latest/kernels.csv
check 'latest points at the results' [ -s "$csv" ]
key=scene,width,height,depth,aa,light_samples,tile,variant,threads,kernel,bounce
check 'the CSV begins with its key columns' [ "$(head -1 "$csv" | cut -d, -f1-11)" = "$key" ]
check 'every line has all columns' \
    [ "$(tr -d '\r' <"$csv" | awk -F, '{print NF}' | sort -u | wc -l)" = 1 ]
check 'all kernels, the build and the frame' [ "$(sed 1d "$csv" | cut -d, -f10 | sort -u |
    tr '\n' ' ')" = 'build frame generate other resolve shade trace trace_shadow ' ]
check 'camera rays are pixels' grep -q '^"balls_low",48,48,5,1,1,64,bvh,1,generate,0,2304,' "$csv"
check 'no zero stands for a time' [ "$(awk -F, '$13 == "0"' "$csv" | wc -l)" = 0 ]
check 'a bad scene is reported' complains 2 'cannot open' bench "$tmp/none.nff" --out "$tmp/results"
check 'an unwritable folder is reported' complains 1 'cannot make' bench balls_low \
    --out "$tmp/no/such/folder"
finish
