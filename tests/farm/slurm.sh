#!/usr/bin/env bash
# An exported job on a Slurm of two nodes, both of them this machine. A render is killed, one is asked to make room, and a
# node dies with all that runs on it. Must be run by root, as Slurm's own daemons must.
# shellcheck source=tests/farm/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

((EUID == 0)) || skip "only root can start Slurm's daemons"
debian slurmctld slurmctld slurmd slurm-client munge
debian slurmd slurmd
debian munged munge

# All daemons have their files in the temporary folder, and listen on ports that nobody else has.
folder=$work/slurm
export SLURM_CONF=$folder/slurm.conf
free() { ! (: <"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }
port=$((20000 + RANDOM % 10000))
until free "$port" && free $((port + 1)) && free $((port + 2)); do port=$((port + 3)); done

configure() {
    local host
    host=$(hostname -s)
    mkdir -p "$folder"/{munge,state,n1,n2}
    chmod 711 "$work" "$folder" "$folder/munge"
    : >"$folder/cgroup.conf"
    cat >"$SLURM_CONF" <<CONF
ClusterName=kinora
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=$port
AuthType=auth/munge
# A task that is requeued may begin again when its credential has run out: after 2 minutes, if nothing else is said.
AuthInfo=socket=$folder/munge/socket,cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
KillWait=5
SlurmdTimeout=10
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n.pid
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + 2))] CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
}

# Munge has a user of its own, not the one that it serves: it does not run as root.
start_munge() {
    (umask 077 && head -c 1024 /dev/urandom >"$folder/munge/key")
    chown -R munge: "$folder/munge"
    start "$folder/munge.log" setpriv --reuid munge --regid munge --clear-groups munged --foreground \
        --socket="$folder/munge/socket" --key-file="$folder/munge/key" --pid-file="$folder/munge/pid" \
        --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
    await 10 "munged" test -S "$folder/munge/socket"
}

declare -A node
start_node() {
    start "$folder/$1.log" slurmd -D -N "$1"
    node[$1]=${started[-1]}
}

idle_nodes() { [[ $(sinfo --noheader --Node --states=idle --format %N | wc -l) == 2 ]]; }

stop_engine() { scontrol shutdown; }

# A process and all that runs below it, parents first.
family() {
    local child
    echo "$1"
    for child in $(ps -o pid= --ppid "$1"); do family "$child"; done
}

# The node's daemon and all of its tasks are gone at once, as when a machine loses its power; then it is there again.
crash() {
    local step killed=("${node[$1]}")
    for step in $(pgrep --full "^slurmstepd: \[[0-9]+\.batch\]"); do
        if [[ $(ps -o args= --ppid "$step") == *"$folder/$1/"* ]]; then mapfile -t -O 1 killed < <(family "$step"); fi
    done
    ((${#killed[@]} > 1)) || return 1
    # In this order: a task's step that outlives its render would report a failure instead of being gone.
    kill -KILL "${killed[@]}"
    start_node "$1"
}

gone() { [[ -z $(squeue --noheader --array) ]]; }

prepare
configure
start_munge
start "$folder/slurmctld.log" slurmctld -D
start_node n1
start_node n2
await 30 "two nodes" idle_nodes

export_job slurm 6
say "$(sbatch --version), two nodes"
"$project/sequences/hello.slurm-submit.sh" | tee "$work/submitted"
job=$(grep --only-matching --max-count=1 '[0-9]*' "$work/submitted")

await_frames 2
kill_a_render

# As before the end of its time, or when the task must make room. The last one has a number of its own kind: that of the
# whole array, of which others are in the queue still.
set_of() { tr '\0' '\n' <"/proc/$1/environ" | sed -n "s/^SLURM_ARRAY_$2=//p"; }
tell_last() {
    local render
    for render in $(workers); do
        [[ $(set_of "$render" TASK_ID) == "$(set_of "$render" TASK_MAX)" ]] || continue
        task=$(set_of "$render" JOB_ID)_$(set_of "$render" TASK_ID)
        # It would try again for minutes if the task has just ended.
        timeout 2 scancel --quiet --signal=TERM --batch "$task"
        return
    done
    return 1
}
await "$job_time" "the last task at work" tell_last
middle "asked task $task to make room"

crash_any() { crash n1 || crash n2; }
await "$job_time" "a node at work" crash_any
middle "crashed a node"

await "$job_time" "an empty queue" gone
scontrol show job "$job" | grep --only-matching 'ArrayTaskId=[0-9]*\|JobState=[A-Z]*\|Restarts=[0-9]*' | paste -sd '   \n'
[[ -f $project/turn.mp4 ]] || fail "nothing was assembled: $(tail -n 3 "$project"/sequences/*logs/*)"
# A task that was asked just as it ended has no reason to go back, and only tasks that were hit go back.
restarts=$(($(scontrol show job "$job" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p' | paste -sd +)))
((restarts >= 1 && restarts < 6)) || fail "tasks went back to the queue $restarts times, of 3 that were hit"
compare
