#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CPU time of whole processes against oiiotool, which copies the channels that ssdo reads.

    tests/bench/processes.py [--ssdo BINARY] [--threads N] [--rounds N] [FILE ...]

Files are those of data/ where none is given. Everything is run in turn, round after round, so that
what else the machine does affects all alike; the table has the medians, and ratios to the copy. A
sequence should take at most its frames' CPU time / (0.95 x threads). Needs oiiotool. Ends with 1 where
outputs of one and of two threads differ, as oiiotool reads them.
"""
import argparse
import hashlib
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SEQUENCE = 8  # frames
ROLES_READ = ("position", "normal", "depth", "albedo", "alpha")


def run(command):
    """Runs a process to its end. Gives seconds of CPU time and by the clock."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - start


def output_of(command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def channels_read(ssdo, file):
    """The channels of a frame that a composite is made from."""
    layers = json.loads(output_of([ssdo, "info", file, "--json"]))["layers"]
    names = [name for role in ROLES_READ if role in layers for name in layers[role]["channels"]]
    return ",".join(dict.fromkeys(names))


def commands(ssdo, file, threads, folder):
    """What is compared: name, command line, and the output."""
    copy = folder / "copy.exr"
    oiio = ["oiiotool", "--threads", str(threads)]
    channels = channels_read(ssdo, file)
    relight = [ssdo, file, "--env", ROOT / "data/environments/sky.exr", "--threads", str(threads),
               "--overwrite", "--quiet", "--stats", folder / "stats.json", "-o"]
    return [
        ("oiiotool: read", oiio + [f"-i:now=1:ch={channels}", file, "--printinfo"], None),
        ("oiiotool: copy", oiio + [file, "--ch", channels, "-o", copy], copy),
        ("ssdo: composite", relight + [folder / "composite.exr", "--products", "composite"],
         folder / "composite.exr"),
        ("ssdo: default products", relight + [folder / "products.exr"], folder / "products.exr"),
    ]


def stages(folder):
    """Seconds by the clock of reading and writing of the latest run."""
    times = json.loads((folder / "stats.json").read_text())[0]["stages_ms"]
    return times["read"] / 1000, (times["compose"] + times["write"]) / 1000


def measure(ssdo, file, threads, rounds, folder):
    rows = commands(ssdo, file, threads, folder)
    found = {name: [] for name, _, _ in rows}
    for _ in range(rounds):
        for name, command, _ in rows:
            seconds = run(command)
            found[name].append(seconds + (stages(folder) if name.startswith("ssdo") else ()))
    medians = {name: [statistics.median(column) for column in zip(*times)]
               for name, times in found.items()}
    reference = medians["oiiotool: copy"][0]
    print(f"\n{file}, {threads} threads, medians of {rounds}")
    print(f"{'':26}{'CPU s':>8}{'ratio':>8}{'clock s':>9}{'read s':>8}{'write s':>9}{'MB':>7}")
    for name, _, output in rows:
        cpu, clock, *parts = medians[name]
        line = f"{name:26}{cpu:8.2f}{cpu / reference:8.2f}{clock:9.2f}"
        line += f"{parts[0]:8.2f}{parts[1]:9.2f}" if parts else " " * 17
        print(line + (f"{output.stat().st_size / 1e6:7.1f}" if output else ""))


def measure_sequence(ssdo, file, threads, rounds, folder):
    """A sequence by the clock, against the CPU time of so many single frames."""
    inputs = folder / "frame.@.exr"
    for number in range(1, SEQUENCE + 1):
        link = folder / f"frame.{number}.exr"
        link.unlink(missing_ok=True)
        link.symlink_to(pathlib.Path(file).resolve())
    flags = ["--env", ROOT / "data/environments/sky.exr", "--threads", str(threads),
             "--overwrite", "--quiet", "-o", folder / "out.@.exr"]
    one, clock = [], []
    for _ in range(rounds):
        one.append(run([ssdo, inputs, "--frames", "1", *flags])[0])
        clock.append(run([ssdo, inputs, *flags])[1])
    cpu, seconds = statistics.median(one), statistics.median(clock)
    print(f"{SEQUENCE} frames: {seconds:.2f} s by the clock; single ones take {SEQUENCE} x {cpu:.2f} "
          f"s of CPU time, {SEQUENCE * cpu / seconds:.2f} times that")


def as_oiiotool_reads(file):
    """SHA-1 of the pixels, and statistics of all channels without the file's name."""
    pixels = [line for line in output_of(["oiiotool", "--info", "--hash", file]).splitlines()
              if "SHA-1" in line]
    lines = output_of(["oiiotool", "--stats", file]).splitlines()
    return pixels[0].split()[-1], [line for line in lines if str(file) not in line]


def check_threads(ssdo, file, folder):
    """Whether oiiotool reads the same from outputs that were made with one thread and two."""
    found = []
    for threads in (1, 2):
        output = folder / f"threads_{threads}.exr"
        run([ssdo, file, "--threads", str(threads), "--overwrite", "--quiet", "-o", output])
        found.append(as_oiiotool_reads(output))
        whole = hashlib.sha1(output.read_bytes()).hexdigest().upper()
        print(f"--threads {threads}: pixels {found[-1][0]}, file {whole}")
    return found[0] == found[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ssdo", default=ROOT / "build/release/ssdo", help="binary to run")
    parser.add_argument("--threads", type=int, default=2, help="of every process (2)")
    parser.add_argument("--rounds", type=int, default=7, help="runs of each command (7)")
    parser.add_argument("files", nargs="*", metavar="FILE", help="frames (those of data/)",
                        default=[ROOT / "data/still_life.exr", ROOT / "data/room_corner.exr"])
    options = parser.parse_args()
    same = True
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in options.files:
            measure(options.ssdo, file, options.threads, options.rounds, folder)
            measure_sequence(options.ssdo, file, options.threads, options.rounds, folder)
            same = check_threads(options.ssdo, file, folder) and same
    if not same:
        sys.exit("outputs of one and two threads differ")


if __name__ == "__main__":
    main()
