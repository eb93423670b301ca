#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Time by the clock of the stages of one frame, by threads, and what of it one thread does alone.

    tests/bench/threads.py SSDO FRAME.exr [SSDO options]

$THREADS (1,2,4,8,16 as far as there are cores) are run in turn, $ROUNDS times (3); the table has medians in
milliseconds. The serial share s is that of Amdahl's law, time = t1 (s + (1 - s) / n), by the most
threads n; the last columns are what it expects of 16 and 64 threads.
"""
import json
import os
import statistics
import subprocess
import sys
import tempfile

CORES = len(os.sched_getaffinity(0))
THREADS = [int(n) for n in os.environ.get("THREADS", "1,2,4,8,16").split(",") if int(n) <= CORES]
ROUNDS = int(os.environ.get("ROUNDS", 3))
STAGES = ("read", "prepare", "estimate", "filter", "write", "total")


def stages_of(command, threads, folder):
    stats = f"{folder}/stats.json"
    subprocess.run([*command, "-o", f"{folder}/out.exr", "--overwrite", "--quiet", "--stats", stats,
                    "--threads", str(threads)], check=True)
    with open(stats) as file:
        times = json.load(file)[0]["stages_ms"]
    times["write"] += times["compose"]
    return times


def main():
    command = sys.argv[1:]
    runs = {n: [] for n in THREADS}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(ROUNDS):
            for n in THREADS:
                runs[n].append(stages_of(command, n, folder))
    most = THREADS[-1]
    print(f"{'':10}" + "".join(f"{n:>8}" for n in THREADS) + "  serial   at 16   at 64")
    for stage in STAGES:
        times = [statistics.median(run[stage] for run in runs[n]) for n in THREADS]
        row = f"{stage:10}" + "".join(f"{t:8.1f}" for t in times)
        if THREADS[0] == 1 and most > 1 and times[0] > 0:
            serial = max(0.0, (times[-1] / times[0] - 1 / most) / (1 - 1 / most))
            row += f"{serial:8.3f}" + "".join(f"{times[0] * (serial + (1 - serial) / n):8.1f}"
                                              for n in (16, 64))
        print(row)


if __name__ == "__main__":
    main()
