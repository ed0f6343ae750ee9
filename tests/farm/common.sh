# shellcheck shell=bash
# What the scripts beside this one share: a place to work in, the job, a worker to kill, and the comparison of bytes.
#
# Each of them exports the same 24 frames for its engine, runs them there, kills a worker in the middle, and compares all
# files with those of a single run. Exit codes: 0 if they are the same, 1 if not, 77 if the engine cannot be had here, 75 if the
# middle was missed or did not come in time.
# KINORA names the program to test.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
kinora=${KINORA:-$root/target/release/kinora}
engine=$(basename "$0" .sh)
# Seconds that an engine may take to install, and a job to run.
install_time=${INSTALL_TIME:-120}
job_time=${JOB_TIME:-180}

say() { echo "$engine: $*"; }
fail() {
    say "FAILED: $*" >&2
    exit 1
}
# Printed if the machine was too slow, or too fast, for a verdict.
miss() {
    say "undecided: $*" >&2
    exit 75
}
# Said where the engine cannot be had.
skip() {
    say "skipped: $*" >&2
    exit 77
}

[[ -x $kinora ]] || fail "there is no $kinora; build it with cargo build --release, or name another by KINORA"

work=$(mktemp -d "${TMPDIR:-/tmp}/kinora-farm-$engine-XXXXXX")
project=$work/project
# The files of one run, which several scripts may share.
single=${SINGLE:-$work/single}
# What was started, in order.
started=()

# All processes that were started by this script or on its behalf: their environment names its folder.
ours() {
    # Without it itself.
    env -i grep --files-with-matches --fixed-strings --text "$work/" /proc/[0-9]*/environ 2>/dev/null | env -i cut -d / -f 3
}

# Ends all that was started, and what that started, whatever happened.
leave() {
    local code=$? pid
    trap - EXIT INT TERM
    set +e
    if declare -F stop_engine >/dev/null; then stop_engine >/dev/null 2>&1; fi
    for pid in "${started[@]}" $(ours); do kill -TERM "$pid" 2>/dev/null; done
    # What does not listen within 5 s.
    for _ in {1..50}; do [[ -n $(ours) ]] && sleep 0.1; done
    for pid in "${started[@]}" $(ours); do kill -KILL "$pid" 2>/dev/null; done
    wait 2>/dev/null
    if ((code == 0 || code == 77)) || [[ -z ${KEEP:-} ]]; then
        rm -rf "$work"
    else
        say "left in $work" >&2
    fi
    exit "$code"
}
trap leave EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Starts something that lasts, with its messages in a file.
start() {
    local log=$1
    shift
    "$@" >>"$log" 2>&1 &
    started+=($!)
}

# Waits until a command succeeds.
await() {
    local seconds=$1 what=$2 end
    shift 2
    end=$((SECONDS + seconds))
    until "$@" >/dev/null 2>&1; do
        ((SECONDS < end)) || miss "$what: not within $seconds s"
        sleep 0.1
    done
}

# Installs Debian packages if a program is missing that they hold.
debian() {
    local program=$1
    shift
    command -v "$program" >/dev/null && return
    command -v apt-get >/dev/null || skip "there is no $program, and no apt-get to install it"
    ((EUID == 0)) || skip "there is no $program, and only root can install it"
    say "installing $*"
    {
        timeout "$install_time" apt-get update -qq
        DEBIAN_FRONTEND=noninteractive timeout "$install_time" apt-get install -y -qq --no-install-recommends "$@"
    } >"$work/apt.log" 2>&1 || true
    command -v "$program" >/dev/null || skip "cannot install $*: $(tail -n 1 "$work/apt.log")"
}

# Installs a Python package into an environment of its own, if there is none yet, and prints its place.
python_package() {
    local package=$1 place
    place=${FARM_CACHE:-${TMPDIR:-/tmp}/kinora-farm-engines}/$package
    if [[ ! -x $place/bin/python ]] || ! "$place/bin/pip" show -q "$package" 2>/dev/null; then
        command -v python3 >/dev/null || skip "there is no python3"
        say "installing $package" >&2
        { python3 -m venv "$place" && timeout "$install_time" "$place/bin/pip" install -q "$package"; } \
            >"$work/pip.log" 2>&1 || skip "cannot install $package: $(tail -n 1 "$work/pip.log")"
    fi
    echo "$place"
}

# What is rendered: small, but long enough that a worker can be met at its work.
sequence=sequences/hello.ron
settings=(-r 8 -s 240x180 --antialias 6)
files=(-o frames/f_##.png -o turn.gif -o turn.mp4)
frames=24

# Lays a project with the sequence, and renders it in one run beside it.
prepare() {
    local place
    mkdir -p "$work/bin"
    ln -s "$(realpath "$kinora")" "$work/bin/kinora"
    export PATH=$work/bin:$PATH
    for place in "$project" "$single"; do
        mkdir -p "$place/sequences"
        cp "$root/$sequence" "$place/$sequence"
    done
    [[ -f $single/turn.mp4 ]] && return
    say "one run"
    (cd "$single" && kinora render -q "$sequence" "${settings[@]}" "${files[@]}")
}

# Writes the job for an engine, in about as many tasks.
export_job() {
    (cd "$project" && kinora farm export "$1" "$sequence" "${settings[@]}" "${files[@]}" --chunks "$2" --throttle 2)
}

# Process ids of all renders of the project: they run in its folder, or name it.
workers() {
    local pid
    for pid in $(pgrep --full 'kinora render '); do
        [[ $(readlink "/proc/$pid/exe") == */kinora* ]] || continue
        if [[ $(readlink "/proc/$pid/cwd") == "$project" || $(tr '\0' ' ' <"/proc/$pid/cmdline") == *" $project/"* ]]; then
            echo "$pid"
        fi
    done
}

written() { find "$project" -name 'f_??.png' | wc -l; }
more_than() { (($(written) > $1)); }
# Waits until more than so many frames are there.
await_frames() { await "$job_time" "more than $1 frames" more_than "$1"; }

# Says what happened in the middle, and makes sure that it was the middle.
middle() {
    local there
    there=$(written)
    ((there < frames)) || miss "$*, but all frames were there already"
    say "$*, with $there of $frames frames there"
}

kill_any() {
    local all
    mapfile -t all < <(workers)
    ((${#all[@]})) && kill -KILL "${all[RANDOM % ${#all[@]}]}"
}

# Kills one of the renders.
kill_a_render() {
    await "$job_time" "a render at work" kill_any
    middle "killed a render"
}

# Compares all files of the job with those of the single run.
compare() {
    local file all
    mapfile -t all < <(cd "$single" && find . -type f ! -path './sequences/*')
    ((${#all[@]} == frames + 2)) || fail "one run wrote ${#all[@]} files"
    for file in "${all[@]}"; do
        cmp "$single/$file" "$project/$file" || fail "$file has not the bytes of one run"
    done
    say "passed: ${#all[@]} files with the bytes of one run"
}
