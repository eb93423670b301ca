# SPDX-License-Identifier: Apache-2.0
"""dataset.py WORK FIRST LAST OUT.npz: features and truth at some pixels of the frames FIRST..LAST

Per frame FAR pixels with unlimited radius and NEAR pixels with its random radius; features with
the up axis known (x_*) and unknown (c_*); moments in the axes of each. Of frames that WORK/turned
has too, seen by a camera that is turned a little, the features of PAIRS points in both frames,
with unlimited radius (*_turned)."""
import os
import sys

import numpy as np

import features
import gbuffer

FAR, NEAR, PAIRS = 320, 160, 320
HEADER = 12
COLUMNS = 16


def read_truth(path):
    """-> header (12), rows (n, 16): generator/ray_cast.h. Moments 1 are turned from the generator's
    axes, z up, to those of the file; moments 2 are left in the generator's."""
    raw = np.fromfile(path, np.float32)
    header, rows = raw[:HEADER], raw[HEADER:].reshape(-1, COLUMNS)
    if header[1] == 1:  # y up
        rows[:, 3:6] = np.stack([rows[:, 3], rows[:, 5], -rows[:, 4]], 1)
    return header, rows


def up_axis(header):
    return np.array([0, 1.0, 0] if header[1] == 1 else [0, 0, 1.0])


def read_estimate(folder, name, number, radius):
    c = gbuffer.read_channels(f"{folder}/{name}_{number}.exr")
    o = gbuffer.read_channels(f"{folder}/{name}_open_{number}.exr")
    e = features.Estimate(
        c["ao.Y"], c["guessed.Y"], o["ao.Y"], gbuffer.layer(c, "bent"), radius
    )
    return e, c


def tool_moments(channels, estimate):
    """Moments 1 of the tool's visibility, from direct light under the linear map -> (H, W, 3).
    Its moment 0, as it lights with a map, lies halfway between the two treatments of the border."""
    zero = 0.5 * (estimate.ao + estimate.open)
    return gbuffer.layer(channels, "direct", "RGB") - zero[..., None], zero


def frame_samples(work, number, rng):
    g = gbuffer.read_gbuffer(f"{work}/frames/frame_{number}.exr")
    header, rows = read_truth(f"{work}/frames/truth_{number}.bin")
    far, channels = read_estimate(f"{work}/tool", "far", number, np.inf)
    near, _ = read_estimate(f"{work}/tool", "near", number, 1.0)
    rows = rows[g.valid.ravel()[rows[:, 0].astype(int)]]
    up = up_axis(header)
    m1, m0 = tool_moments(channels, far)
    pick = lambda n: rows[rng.choice(len(rows), n, replace=len(rows) < n)]
    far_rows, near_rows = pick(FAR), pick(NEAR)
    far_pixels, near_pixels = far_rows[:, 0].astype(int), near_rows[:, 0].astype(int)
    all_pixels = rows[:, 0].astype(int)
    rmse = lambda a, b: np.sqrt(np.mean((a.ravel()[all_pixels] - b) ** 2))
    out = dict(
        family=int(header[0]),
        number=int(header[9]),
        far_y=far_rows[:, 2],
        near_y=near_rows[:, 1],
        far_rule=rmse(far.ao, rows[:, 2]),
        near_rule=rmse(near.ao, rows[:, 1]),
        light=rows[:, 2].mean(),
        zero=m0.ravel()[far_pixels],
        bounce=far_rows[:, 11:14],
    )
    for prefix, direction in (("x", up), ("c", None)):
        geometry = features.Geometry(g, direction)
        out[f"{prefix}_far"] = geometry.features(far, far_pixels).astype(np.float16)
        out[f"{prefix}_near"] = geometry.features(near, near_pixels).astype(np.float16)
        out[f"{prefix}_truth1"] = far_rows[:, 3:6] @ geometry.axes.T
        out[f"{prefix}_tool1"] = m1.reshape(-1, 3)[far_pixels] @ geometry.axes.T
        out[f"{prefix}_up"] = geometry.axes @ up
    return out


def pairs(work, number, rng):
    """The same points in a frame and in the turned one; None where these share too few"""
    header, rows = read_truth(f"{work}/turned/frames/truth_{number}.bin")
    pixels = rows[:, [15, 0]].astype(int).T
    folders = work, f"{work}/turned"
    frames = [gbuffer.read_gbuffer(f"{f}/frames/frame_{number}.exr") for f in folders]
    shown = np.logical_and(*[g.valid.ravel()[p] for g, p in zip(frames, pixels)])
    pixels = pixels[:, shown]
    if pixels.shape[1] < PAIRS:
        return None
    pixels = pixels[:, rng.choice(pixels.shape[1], PAIRS, replace=False)]
    found = [read_estimate(f"{f}/tool", "far", number, np.inf)[0] for f in folders]
    out = dict(turned_family=int(header[0]), turned_number=int(header[9]))
    for prefix, direction in (("x", up_axis(header)), ("c", None)):
        both = [
            features.Geometry(g, direction).features(e, p)
            for g, e, p in zip(frames, found, pixels)
        ]
        out[f"{prefix}_turned"] = np.stack(both).astype(np.float16)
    return out


def stacked(samples):
    return {k: np.array([s[k] for s in samples]) for k in samples[0]}


def main():
    work, first, last, path = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    rng = np.random.default_rng(first)
    samples, turned = [], []
    for i in range(first, last + 1):
        number = f"{i:05d}"
        if not os.path.exists(f"{work}/frames/truth_{number}.bin"):
            continue
        try:
            samples.append(frame_samples(work, number, rng))
            if os.path.exists(f"{work}/turned/frames/truth_{number}.bin"):
                turned.append(pairs(work, number, rng))
        except OSError as error:
            print(error)
    np.savez(path, **stacked(samples), **stacked([s for s in turned if s]))


if __name__ == "__main__":
    main()
