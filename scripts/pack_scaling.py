#!/usr/bin/env python3
"""Measures how long `vpm-pack` takes for many spheres with 1, 4, 16 … threads, each on a core of its own.

    pack_scaling.py BIN COMMIT MESH > tests/results/pack_threads.json

BIN is the folder of the programs, COMMIT what they were built of, MESH a closed mesh, such as the Stanford bunny. Times are of all that
vpm-pack does: reading and checking the mesh, packing, the certificate, without which it writes nothing, and writing. Fails if the packings
are not the same bytes for any number of threads.
"""
import os
import pathlib
import resource
import sys
import time

from thread_scaling import report

FEWEST_THREADS = {100_000: 1, 1_000_000: 4}  # for so many spheres; a million take minutes with one


def take_mesh(run, mesh):
    pathlib.Path("mesh" + mesh.suffix).symlink_to(mesh)


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def measured(run):
    mesh = next(pathlib.Path().glob("mesh*"))
    for spheres, fewest in FEWEST_THREADS.items():
        first = None
        for threads in (4 ** k for k in range(6) if fewest <= 4 ** k <= len(os.sched_getaffinity(0))):
            begin, cpu = time.perf_counter(), cpu_seconds()
            run("taskset", "-c", f"0-{threads - 1}", "vpm-pack", mesh, "-o", "packed.vpmp", "--spheres", spheres,
                "--threads", threads, "--quiet", "--force")
            yield {"spheres": spheres, "threads": threads, "seconds": time.perf_counter() - begin, "cpu_seconds": cpu_seconds() - cpu}
            packed = pathlib.Path("packed.vpmp").read_bytes()
            first = first or packed
            if packed != first:
                sys.exit(f"{threads} threads pack otherwise than {fewest}")


if __name__ == "__main__":
    report("pack_scaling.py", __doc__, take_mesh, measured, "MESH")
