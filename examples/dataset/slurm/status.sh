#!/bin/sh
# status.sh JOB: says for Snakemake how a job of Slurm stands. A job that Slurm has forgotten counts as failed: it is started
# again, and passes over what is done. A killed node's job waits to be started again by Slurm itself.
state=$(scontrol -o show job "$1" 2>/dev/null | grep -o 'JobState=[A-Z_]*')
case ${state#JobState=} in
  COMPLETED) echo success ;;
  PENDING | RUNNING | CONFIGURING | COMPLETING | SUSPENDED | REQUEUED) echo running ;;
  *) echo failed ;;
esac
