#!/bin/bash
# Written by kinora farm export. Passes its options to sbatch: --partition=NAME --account=NAME --mem=2G --time=2:00:00
# Submit it again to render missing frames.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")"/..
mkdir -p sub/half.slurm-logs

frames=$(sbatch --parsable "$@" sub/half.slurm.sh)
frames=${frames%%;*}
echo "job $frames renders the frames"
# Runs only if all tasks succeed.
after=$(sbatch --parsable --dependency="afterok:$frames" --kill-on-invalid-dep=yes "$@" sub/half.slurm-assemble.sh)
echo "job ${after%%;*} assembles them"
