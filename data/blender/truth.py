# SPDX-License-Identifier: Apache-2.0
"""Path-traced answers for a scene of scenes.py, one layer per file, and their noise.

    blender -b -P truth.py -- still_life -o ../truth/still_life

Every answer is the mean of independent runs of equal length; their spread gives its standard error.
Needs oiiotool beside Blender.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from scenes import SCENES  # noqa: E402

RUNS = 4
SAMPLES_WHITE, SAMPLES_ENVIRONMENT = 256, 320  # per pixel and run
DEPTH = ",".join(["ViewLayer.Depth.Z"] * 3)  # three times, to go with colours


def render(scene, path, seed, samples, world, bounces, ao_radius):
    options = {"seed": seed, "samples": samples, "world": world, "bounces": bounces,
               "ao-radius": ao_radius}
    flags = [f"--{name}={value}" for name, value in options.items()]
    subprocess.run([bpy.app.binary_path, "-b", "-P", HERE / "export.py", "--", scene, "-o", path,
                    *flags], check=True, stdout=subprocess.DEVNULL)


def read_channels(path, channels):
    """[height, width, 3] of three channels of a multilayer file."""
    plain = path.with_suffix(".rgb.exr")
    subprocess.run(["oiiotool", path, "--ch", channels, "--chnames", "R,G,B", "-d", "float", "-o",
                    plain], check=True)
    image = bpy.data.images.load(str(plain))
    width, height = image.size
    rgba = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(rgba)
    bpy.data.images.remove(image)
    return rgba.reshape(height, width, 4)[..., :3].astype(np.float64)


def rgb(layer):
    return ",".join(f"ViewLayer.{layer}.{c}" for c in "RGB")


def write_mean(runs, layer, path):
    """Half is fine here: its rounding, 0.05 %, is far below the noise.

    Cycles lets a few samples in a thousand stray off a filter of 0.01 px, by up to half a pixel
    (seen on a straight edge), and so light into background beside a silhouette: Depth masks it.
    """
    command = ["oiiotool", "--nosoftwareattrib", runs[0], "--ch", DEPTH, "--mulc", "-1", "--addc",
               "1e9", "--clamp:min=0:max=1", runs[0], "--ch", rgb(layer)]
    for run in runs[1:]:
        command += [run, "--ch", rgb(layer), "--add"]
    command += ["--divc", str(len(runs)), "--mul", "--chnames", rgb(layer), "--eraseattrib", ".*",
                "--compression", "zip", "-d", "half", "-o", path]
    subprocess.run(command, check=True)


def noise(runs, layer, samples):
    """Standard error of the mean, rms over the channels of all pixels but the background."""
    values = np.stack([read_channels(run, rgb(layer)) for run in runs])
    foreground = read_channels(runs[0], DEPTH)[..., 0] < 1e9
    mean = float(values.mean(axis=0)[foreground].mean())
    error = values.std(axis=0, ddof=1)[foreground] / np.sqrt(len(runs))
    rms = float(np.sqrt(np.mean(error**2)))
    return {"spp": samples * len(runs), "runs": len(runs), "mean": mean,
            "rms_standard_error": rms, "rel": rms / mean}


def main():
    parser = argparse.ArgumentParser(prog="blender -b -P truth.py --")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("-o", "--output", type=Path, required=True)
    args = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    args.output.mkdir(parents=True, exist_ok=True)
    near, far = SCENES[args.scene].ao_radii

    # The AO pass costs little and ignores the world, so each of the two renders carries one radius.
    renders = {
        "white": (SAMPLES_WHITE, {"bounces": 0, "ao_radius": near},
                  {f"ao_{near:g}": "AO", "white": "DiffDir"}),
        "environment": (SAMPLES_ENVIRONMENT, {"bounces": 1, "ao_radius": far},
                        {f"ao_{far:g}": "AO", "env_direct": "DiffDir", "env_bounce1": "DiffInd"}),
    }
    report = {"definition": "standard error of the mean, from the spread of independent runs, as "
                            "rms over foreground pixels and channels; rel = rms / mean"}
    with tempfile.TemporaryDirectory() as folder:
        for world, (samples, settings, layers) in renders.items():
            runs = [Path(folder) / f"{world}{seed}.exr" for seed in range(RUNS)]
            for seed, run in enumerate(runs):
                render(args.scene, run, seed, samples, world, **settings)
            for file, layer in layers.items():
                write_mean(runs, layer, args.output / f"{file}.exr")
                report[file] = noise(runs, layer, samples)
    (args.output / "noise.json").write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
