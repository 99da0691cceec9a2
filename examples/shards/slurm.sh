#!/bin/bash
#SBATCH --array=1-64
#SBATCH --cpus-per-task=1
#SBATCH --output=shard-%a.log
# One worker of the study in study.sh, in the folder from which it was submitted. The number of workers is that of
# study.sh, not of the array, so that `sbatch --array=3,17 slurm.sh` runs two of them again.
set -eu
. ./study.sh
study --shard "$SLURM_ARRAY_TASK_ID/$workers"
