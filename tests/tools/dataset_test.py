#!/usr/bin/env python3
"""Runs the workflow of examples/dataset on this machine and under a Slurm of its own, on two nodes of which one is killed.

    dataset_test.py --bin DIR [local|slurm|array]

local: a workflow that is killed goes on, and a third run repeats nothing. slurm: a node is killed amid its job, and the results have
the bytes of those of one machine. array: a thousand tasks end, and each has done its part. Exit status: 0 if all holds, 1 otherwise,
77 if Snakemake or Slurm is not installed.
"""
import argparse
import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import slurm_cluster

SOURCE = pathlib.Path(__file__).resolve().parents[2]
INPUTS = SOURCE / "tests/tools/inputs"
FRAMES = 24
SECONDS = 300
CONFIGURATION = """\
frames: frames.txt
poses: poses.jsonl
tools: {cube: cube.off, block: block.off}
normals: --intrinsics 60,60,31.5,23.5
query: ""
spheres: 40
shards: 3
cores: 1
"""


def make_inputs(folder, poses=4):
    """Makes a copy of the example, with frames of equal names in two folders."""
    shutil.copytree(SOURCE / "examples/dataset", folder)
    for mesh in ("cube.off", "block.off"):
        shutil.copy(INPUTS / mesh, folder)
    for name in ("left", "right"):
        subprocess.run([sys.executable, SOURCE / "tests/tools/frames.py", "numbered", folder / name, str(FRAMES // 2)], check=True)
    names = sorted(str(path.relative_to(folder)) for path in folder.glob("*/*.png"))
    (folder / "frames.txt").write_text("\n".join(names) + "\n")
    (folder / "poses.jsonl").write_text("".join(json.dumps([0, 0, 0.7 + 0.3 * k / poses, 0, 0, 0, 1]) + "\n" for k in range(poses)))
    (folder / "config.yaml").write_text(CONFIGURATION)


def outputs_of(folder):
    """Maps the names of all that was made for a frame to bytes and time."""
    return {str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns)
            for top in ("clouds", "results") for path in (folder / top).rglob("*") if path.suffix in (".vpmc", ".jsonl")}


def bytes_of(outputs):
    return {name: content for name, (content, _) in outputs.items()}


def snakemake(folder, environment, *options):
    return subprocess.Popen(["snakemake", "--nolock", *options], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                            stdout=open(folder / "said", "ab"), stderr=subprocess.STDOUT, start_new_session=True)


def end(process, folder):
    if process.wait(SECONDS) != 0:
        sys.exit(f"exit status {process.returncode}: {process.args}\n{(folder / 'said').read_text()}")


def wait_until(condition, what):
    start = time.monotonic()
    while not condition():
        if time.monotonic() > start + SECONDS:
            sys.exit(f"{what} is waited for in vain")
        time.sleep(0.02)


def check(holds, what):
    if not holds:
        sys.exit(f"not true: {what}")


def check_whole(folder):
    made = outputs_of(folder)
    check(len(made) == 3 * FRAMES, f"{FRAMES} clouds and as many results of two tools are there: {len(made)}")
    check(not list(folder.rglob("*.part")), "nothing is left half made")
    return made


def test_local(folder, environment):
    """Returns the bytes of all outputs."""
    make_inputs(folder)
    first = snakemake(folder, environment, "--cores", "2")
    wait_until(lambda: len(outputs_of(folder)) > FRAMES + 3, "the first results")
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    before = outputs_of(folder)
    end(snakemake(folder, environment, "--cores", "2", "--rerun-incomplete"), folder)
    made = check_whole(folder)
    kept = [name for name, at in before.items() if made[name] == at]
    check(len(kept) >= len(before) - 2, "of two jobs that were killed, at most the two files at work are made again")
    shutil.rmtree(folder / "done")  # a workflow that knows nothing of what was done
    end(snakemake(folder, environment, "--cores", "2"), folder)
    check(outputs_of(folder) == made, "a workflow that is run again repeats nothing")
    return bytes_of(made)


def test_slurm(folder, environment, cluster, wanted):
    make_inputs(folder)
    workflow = snakemake(folder, environment, "--profile", "slurm", "--latency-wait", "10")
    running = lambda: [line.split() for line in cluster.say("squeue", "-h", "-t", "R", "-o", "%N %j").splitlines()]
    wait_until(lambda: ["n1", "answers"] in running() or ["n1", "clouds"] in running(), "a job on n1")
    cluster.kill_node("n1")
    wait_until(lambda: "down" in cluster.say("sinfo", "-h", "-n", "n1", "-o", "%T"), "the loss of n1")
    cluster.start_node("n1")
    cluster.wait_until("n1", lambda: "idle" in cluster.say("sinfo", "-h", "-n", "n1", "-o", "%T"))
    for job in cluster.say("squeue", "-h", "-t", "PD", "-o", "%i").split():
        cluster.say("scontrol", "update", f"JobId={job}", "StartTime=now")  # else Slurm waits two minutes with what it requeues
    end(workflow, folder)
    check(bytes_of(check_whole(folder)) == wanted, "results are those of one machine, bit for bit")
    made = outputs_of(folder)
    end(snakemake(folder, environment, "--profile", "slurm", "--forceall"), folder)
    check(outputs_of(folder) == made, "a workflow that is run again repeats nothing")


def test_array(folder, environment, tasks):
    make_inputs(folder, poses=1)
    run = lambda *command: subprocess.run(command, cwd=folder, env=environment, check=True, timeout=SECONDS, stdin=subprocess.DEVNULL,
                                          capture_output=True, text=True).stdout
    run("bash", "-c", "vpm-pack cube.off -o - --spheres 20 --quiet | vpm-graph - -o cube.vpmg --quiet")
    run("vpm-normals", "left/frame-000000.depth.png", "-o", "wall.vpmc", "--intrinsics", "60,60,31.5,23.5", "--quiet")
    (folder / "list").write_text("".join(f'{{"cloud":"wall.vpmc","output":"answers/{k}.jsonl"}}\n' for k in range(tasks)))
    command = ["array.sh", str(tasks), "list", "cube.vpmg", "poses.jsonl", "answers"]
    run("sbatch", "--wait", f"--array=1-{tasks}", *command)
    there = [path.stat().st_mtime_ns for path in sorted((folder / "answers").glob("*.jsonl"))]
    check(len(there) == tasks, f"each of {tasks} tasks has done its part: {len(there)}")
    run("sh", *command)
    check(there == [path.stat().st_mtime_ns for path in sorted((folder / "answers").glob("*.jsonl"))], "nothing was left to do")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--tasks", type=int, default=1000)
    parser.add_argument("part", choices=["local", "slurm", "array"], nargs="+")
    arguments = parser.parse_args()
    missing = ([] if shutil.which("snakemake") else ["snakemake"]) + (slurm_cluster.missing() if arguments.part != ["local"] else [])
    if missing:
        print("skipped: apt install snakemake slurmctld slurmd slurm-client munge; not there: " + ", ".join(missing))
        sys.exit(77)
    path = f"{pathlib.Path(arguments.bin).resolve()}:{os.environ['PATH']}"
    os.environ["PATH"] = path
    with contextlib.ExitStack() as stack:
        folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="vpm-dataset.")))
        os.environ["HOME"] = str(folder)  # Snakemake keeps a cache of sources there
        if "slurm" in arguments.part or "array" in arguments.part:
            cluster = stack.enter_context(slurm_cluster.Cluster(folder / "cluster"))
        begin = time.monotonic()
        if "local" in arguments.part or "slurm" in arguments.part:
            wanted = test_local(folder / "local", os.environ)
            print(f"local: {time.monotonic() - begin:.0f} s")
        if "slurm" in arguments.part:
            test_slurm(folder / "slurm", cluster.environment, cluster, wanted)
            print(f"slurm: {time.monotonic() - begin:.0f} s")
        if "array" in arguments.part:
            test_array(folder / "array", cluster.environment, arguments.tasks)
            print(f"array: {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    main()
