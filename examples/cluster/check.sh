#!/usr/bin/env bash
# Runs the array job of soak.sbatch on this machine, task by task, and compares the merged result with that
# of one machine: they must be equal to the byte, but for times. Usage: check.sh FOLDER_OF_PROGRAMS [TICKS] [TASKS]
set -euo pipefail
export PROGRAMS="$1" TICKS="${2:-12000}" SLURM_ARRAY_TASK_COUNT="${3:-3}" OPTIONS='--kinematic'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export FOLDER="$folder/shards"
for task in $(seq "$SLURM_ARRAY_TASK_COUNT"); do
    SLURM_ARRAY_TASK_ID=$task bash "$(dirname "$0")/soak.sbatch" > /dev/null
done
without_times() { sed -e '/^tick, /d' -e 's/"tick_us_p[0-9]*":[0-9.]*,//g'; }
"$PROGRAMS/merge" "$FOLDER"/*.json --json | without_times > "$folder/merged"
"$PROGRAMS/soak" --ticks "$TICKS" --seed 1 --kinematic --quiet --json | without_times > "$folder/whole"
cmp "$folder/merged" "$folder/whole"
echo "$SLURM_ARRAY_TASK_COUNT shards of $TICKS ticks merge to the same bytes"
