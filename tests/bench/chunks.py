#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""CPU time per frame against the number of frames per process, and bytes from and to storage.

    tests/bench/chunks.py SSDO FRAME.exr [SSDO options]

FRAME.exr stands for $FRAMES frames (16 if not set) of a shot, which is done once for each chunk length
that $CHUNKS names (1,2,4,8,16), in turn, $ROUNDS times (3). The table has medians; the start of a
process is what the shortest chunks take longer than the longest, per process.
"""
import os
import resource
import statistics
import subprocess
import sys
import tempfile

FRAMES = int(os.environ.get("FRAMES", 16))
CHUNKS = [int(n) for n in os.environ.get("CHUNKS", "1,2,4,8,16").split(",")]
ROUNDS = int(os.environ.get("ROUNDS", 3))


def children_cpu():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run_shot(ssdo, folder, length, options):
    """CPU seconds of the processes that do the shot in chunks of `length` frames."""
    before = children_cpu()
    for first in range(1, FRAMES + 1, length):
        last = min(first + length - 1, FRAMES)
        subprocess.run([ssdo, f"{folder}/in.####.exr", "-o", f"{folder}/out.####.exr", "-q",
                        "--overwrite", "--frames", f"{first}-{last}", *options], check=True)
    return children_cpu() - before


def main():
    ssdo, frame, *options = sys.argv[1:]
    seconds = {length: [] for length in CHUNKS}
    with tempfile.TemporaryDirectory() as folder:
        for number in range(1, FRAMES + 1):
            os.symlink(os.path.abspath(frame), f"{folder}/in.{number:04d}.exr")
        for _ in range(ROUNDS):
            for length in CHUNKS:
                seconds[length].append(run_shot(ssdo, folder, length, options))
        written = os.path.getsize(f"{folder}/out.0001.exr")
    medians = {length: statistics.median(found) for length, found in seconds.items()}
    print("frames per process   CPU s per frame")
    for length, found in medians.items():
        print(f"{length:18}   {found / FRAMES:15.3f}")
    processes = {length: -(-FRAMES // length) for length in CHUNKS}
    most, least = max(CHUNKS), min(CHUNKS)
    start = (medians[least] - medians[most]) / (processes[least] - processes[most])
    print(f"start {start:.3f} s of CPU time; read {os.path.getsize(frame) / 1e6:.1f} MB, "
          f"written {written / 1e6:.1f} MB per frame")


if __name__ == "__main__":
    main()
