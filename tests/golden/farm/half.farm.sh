#!/bin/sh
# Written by kinora farm export. With a number, so many processes at a time.
# Run again, it renders what is missing; run on several machines that share this folder, they share the work.
set -eu
cd -- "$(dirname -- "$0")"/..
processes=${1:-5}

# Frames of a task in each line; those that should take longest come first.
status=0
exec 4>&1
codes=$(xargs -n 1 -P "$processes" sh -c '"$@" 3>&- || { echo "$?" >&3; exit 1; }' sh kinora render sub/half.ron -o 'out/f_##.png' --claim --expect 0.1.0:fee505183bae --exposure=-1 '--caption=it'\''s {{{frame}}}' --quiet --threads=2 --frames 3>&1 >&4 4>&- <<'FRAMES'
0-1
2-3
4-11
FRAMES
) || status=$?
# Of the tasks' exit codes the least says most: with 2 it does not help to try again, with 3 it may.
if [ "$status" -ne 0 ]; then
    code=$(printf '%s\n' $codes | sort -n | head -n 1)
    exit "${code:-$status}"
fi

# Only when all frames are there.
kinora assemble 'out/f_##.png' --of sub/half.ron --frames 0-11 --exposure=-1 '--frame-caption=it'\''s {{{frame}}}' -o 'out/a b.gif'
kinora assemble 'out/f_##.png' --of sub/half.ron --frames 0-1,3-4,6-8,10-11 --exposure=-1 '--frame-caption=it'\''s {{{frame}}}' -o out/strip.png
