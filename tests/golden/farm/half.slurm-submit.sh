#!/bin/bash
# Written by kinora farm export. Options go to sbatch: --partition=NAME --account=NAME --mem=2G --time=2:00:00
# Submitted again, it renders what is missing.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")"/..
mkdir -p sub/half.slurm-logs

frames=$(sbatch --parsable "$@" sub/half.slurm.sh)
frames=${frames%%;*}
echo "job $frames renders the frames"
# Only when all frames are there; if a task has failed for good, not at all.
after=$(sbatch --parsable --dependency="afterok:$frames" --kill-on-invalid-dep=yes "$@" sub/half.slurm-assemble.sh)
echo "job ${after%%;*} assembles them"
