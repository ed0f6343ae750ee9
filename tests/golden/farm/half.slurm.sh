#!/bin/bash
# Written by kinora farm export. half.slurm-submit.sh submits it.
#SBATCH --job-name=half
#SBATCH --array=0-2%5
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=sub/half.slurm-logs/%A_%a.log
#SBATCH --signal=B:TERM@120

# The frames of each task, longest tasks first.
chunks=(
    0-1
    2-3
    4-11
)
frames=${chunks[SLURM_ARRAY_TASK_ID]}
echo "frames $frames on ${SLURMD_NODENAME:-$HOSTNAME}, restart ${SLURM_RESTART_COUNT:-0}"
# Not SLURM_JOB_ID: for the last task, that is the ID of the whole array.
task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID

# Slurm signals only this script. After the first SIGTERM, Kinora stops after the current frame. The second one stops
# it at once, so that there is time to requeue the task.
stop_render() {
    kill -TERM "$render"
    { sleep 90 && kill -TERM "$render"; } &
} 2>/dev/null
trap stop_render TERM

kinora render sub/half.ron --frames "$frames" -o 'out/f_##.png' --claim --expect 0.1.0:fee505183bae '--exposure=-1' "--caption=it's {{{frame}}}" \
    --threads="${SLURM_CPUS_PER_TASK:-1}" &
render=$!
wait "$render"
code=$?
# The signal interrupts `wait` while the render continues.
while kill -0 "$render" 2>/dev/null; do
    wait "$render"
    code=$?
done

# Stopped (143) or killed (137): requeue the task for its missing frames, unless the job is being cancelled.
running() { [[ $(squeue --noheader --jobs="$task" --format=%T) == RUNNING ]]; }
if ((code == 143 || code == 137)) && ((${SLURM_RESTART_COUNT:-0} < 20)) && running; then
    scontrol requeue "$task"
fi
exit "$code"
