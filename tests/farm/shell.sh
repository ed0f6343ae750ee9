#!/usr/bin/env bash
# An exported job in a shell, by `xargs`. A render is killed, and the script is run again.
# shellcheck source=tests/farm/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

prepare
export_job shell 6
cd "$project"
start "$work/job.log" sh sequences/hello.farm.sh
job=${started[-1]}
await_frames 4
kill_a_render
if wait "$job"; then fail "the script did not notice that a render was killed"; fi
[[ ! -f turn.mp4 ]] || fail "it was assembled of a part of the frames"
say "it ended with $(written) of $frames frames; again"
sh sequences/hello.farm.sh || fail "the second run failed"
compare
