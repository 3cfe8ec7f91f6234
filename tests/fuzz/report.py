#!/usr/bin/env python3
"""Adds the logs of fuzzing to a table: report.py BUILD fuzz.json TARGET...

Executions and seconds are sums over all runs that the table has seen, coverage is that of the last
run (edges of the program), findings are the files in BUILD/findings. Command and commit are those
of the last run, machines those of all runs. Exit status: 1 if there are findings.
"""
import json
import os
import pathlib
import re
import subprocess
import sys


def numbers(pattern, text):
    return [int(number) for number in re.findall(pattern, text)]


def processor():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    return next(iter(re.findall(r"model name\s*: (.*)", text)), "unknown")


def main():
    build, table = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    results = json.loads(table.read_text()) if table.exists() else {"targets": {}}
    found_any = False
    for target in sys.argv[3:]:
        log = build / f"{target}.log"
        text = log.read_text(errors="replace") if log.exists() else ""
        executions = sum(numbers(r"stat::number_of_executed_units: *(\d+)", text))
        # A run that a finding ends prints no statistics, but its number of executions before.
        for run in text.split("INFO: Seed: ")[1:]:
            if "stat::number_of_executed_units" not in run:
                executions += max(numbers(r"^#(\d+)", run) + numbers(r"\n#(\d+)", run), default=0)
        entry = results["targets"].setdefault(target, {"executions": 0, "seconds": 0})
        entry["executions"] += executions
        entry["seconds"] += sum(numbers(r"Done \d+ runs in (\d+) second", text))
        entry["coverage"] = max(numbers(r"cov: (\d+)", text), default=entry.get("coverage", 0))
        folder = build / "findings" / target
        entry["findings"] = sorted(path.name for path in folder.glob("*")) if folder.exists() else []
        found_any = found_any or bool(entry["findings"])
        print(f"{target:12} {executions:10} executions, coverage {entry['coverage']:6}, "
              f"{len(entry['findings'])} findings")
    results["targets"] = dict(sorted(results["targets"].items()))
    results["command"] = "scripts/fuzz.sh"
    results["commit"] = subprocess.run(["git", "rev-parse", "HEAD"], text=True, check=True,
                                       stdout=subprocess.PIPE).stdout.strip()
    machine = {"cores": os.cpu_count(), "processor": processor()}
    if machine not in results.setdefault("machines", []):
        results["machines"].append(machine)
    table.write_text(json.dumps(results, indent=2) + "\n")
    sys.exit(1 if found_any else 0)


if __name__ == "__main__":
    main()
