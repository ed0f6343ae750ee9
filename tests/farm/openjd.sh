#!/usr/bin/env bash
# An exported job by the runner of Open Job Description. Two of them share the folder; a render of one is killed, which fails
# its run, and the other one goes on. Then the job is run again.
# shellcheck source=tests/farm/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

place=$(python_package openjd-cli) || exit
openjd() { "$place/bin/openjd" "$@"; }

prepare
export_job openjd 6
cd "$project"
say "$(openjd --version)"
openjd check sequences/hello.openjd.yaml
job=(openjd run sequences/hello.openjd.yaml -p Folder=.)
start "$work/first.log" "${job[@]}"
first=${started[-1]}
start "$work/second.log" "${job[@]}"
second=${started[-1]}
await_frames 4
kill_a_render
passed=0
wait "$first" && passed=$((passed + 1))
wait "$second" && passed=$((passed + 1))
say "$passed of 2 runs passed, with $(written) of $frames frames there; again"
((passed < 2)) || fail "no run noticed that its render was killed"
"${job[@]}" >"$work/third.log" 2>&1 || fail "the third run failed: $(tail -n 5 "$work/third.log")"
grep --quiet 'openjd_progress: 100' "$work/third.log" || fail "no progress was reported"
compare
