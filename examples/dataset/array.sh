#!/bin/sh
# Answers of one tool in all clouds as an array of Slurm, without Snakemake; the first word is the number of tasks:
#
#   sbatch --array=1-100 array.sh 100 clouds.txt tool.vpmg poses.jsonl results
#
# To be sure that all is done, run it without Slurm at the end: it makes what is missing, and fails where an input does.
# `sbatch --wait` returns 0 also for tasks that were cancelled.
#SBATCH --requeue --output=array.%A.log --open-mode=append
set -eu
shard=1/1
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then shard=$SLURM_ARRAY_TASK_ID/$1; fi
cores=${SLURM_CPUS_ON_NODE:-0}
exec vpm-query --list "$2" --shard "$shard" --tool "$3" --poses "$4" -o "$5" --jobs "$cores" --threads "$cores"
