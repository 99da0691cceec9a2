#!/bin/bash
# Runs the study in study.sh round by round until its results are written. The first argument is what runs all shards of
# a round:
#
#   rounds.sh slurm       a Slurm array (slurm.sh)
#   rounds.sh parallel    GNU parallel on this machine; options for it may follow, such as --sshloginfile
#   rounds.sh xargs       the same without another program
set -eu
. ./study.sh
with=${1:-xargs}
shift || true
round() {
    case $with in
    slurm) sbatch --wait --array="1-$workers" slurm.sh ;;
    parallel) seq "$workers" | parallel "$@" --workdir . bash -c "'. ./study.sh; study --shard {}/$workers'" ;;
    xargs) seq "$workers" | xargs -P "$(nproc)" -I{} bash -c ". ./study.sh; study --shard {}/$workers" ;;
    *) echo "unknown: $with" >&2; exit 2 ;;
    esac
}
for _ in $(seq 20); do
    # Killed workers are no failure: the merge tells what is missing, and the next round computes it.
    round "$@" || true
    status=0
    merge || status=$?
    # 5: pieces are missing.
    [ $status = 5 ] || exit $status
done
echo "still not complete after 20 rounds" >&2
exit 1
