#!/usr/bin/env bash
# An exported job on a HyperQueue of a server and two workers of one processor each. A worker is killed, and its task begins
# again on the other one.
# shellcheck source=tests/farm/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# The program, if there is one. The package of Python's index has the engine, but not the program.
if command -v hq >/dev/null; then
    server() { hq --server-dir "$work/hq" server start; }
    worker() { hq --server-dir "$work/hq" worker start --cpus 1; }
    workers_there() { (($(hq --server-dir "$work/hq" --output-mode quiet worker list | wc -l) == 2)); }
    submit() { hq --server-dir "$work/hq" job submit-file --wait "$1"; }
    up() { hq --server-dir "$work/hq" server info; }
    version=$(hq --version)
else
    place=$(python_package hyperqueue) || exit
    engine() { "$place/bin/python" "$root/tests/farm/hq.py" "$@"; }
    server() { engine server "$work/hq"; }
    worker() { engine worker "$work/hq"; }
    workers_there() { (($(cat "$work"/worker-?.log | grep --count '^joined') == 2)); }
    submit() { engine submit "$work/hq" "$1"; }
    up() { grep '^up' "$work/server.log"; }
    version=$("$place/bin/pip" list 2>/dev/null | grep hyperqueue)
fi

prepare
mkdir "$work/hq"
start "$work/server.log" server
await 30 "a server" up
start "$work/worker-1.log" worker
first=${started[-1]}
start "$work/worker-2.log" worker
await 30 "two workers" workers_there

export_job hyperqueue 6
say "$version, two workers"
cd "$project"
start "$work/submit.log" submit sequences/hello.hq.toml
job=${started[-1]}

await_frames 4
# The shell's child is the worker.
pkill -KILL --parent "$first"
middle "killed a worker"

wait "$job" || fail "the job failed: $(tail -n 5 "$work/submit.log" sequences/hello.hq-logs/*)"
[[ -n $(find sequences/hello.hq-logs -name '*-1.err') ]] || fail "no task began again"
compare
