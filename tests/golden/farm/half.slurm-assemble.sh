#!/bin/bash
# Written by kinora farm export. half.slurm-submit.sh submits it.
#SBATCH --job-name=half-assemble
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=sub/half.slurm-logs/%j-assemble.log

set -e
kinora assemble 'out/f_##.png' --of sub/half.ron --frames 0-11 '--exposure=-1' "--frame-caption=it's {{{frame}}}" -o 'out/a b.gif' \
    --threads="${SLURM_CPUS_PER_TASK:-1}"
kinora assemble 'out/f_##.png' --of sub/half.ron --frames '0-1,3-4,6-8,10-11' '--exposure=-1' "--frame-caption=it's {{{frame}}}" -o out/strip.png \
    --threads="${SLURM_CPUS_PER_TASK:-1}"
