# SPDX-License-Identifier: Apache-2.0
"""sun_test.py WORK SSDO COUNT: can the moments say whether a sun shines past what is not seen?

On the first COUNT frames of the families that are never trained on: V of a sun times the cosine of
its angle, RMSE over the mean of the truth, of the tool; of the tool's V and what the prior's change
of ao adds to every direction alike; and of that with the change of moments 1. Moments of V over the
hemisphere of N give the linear function of direction s0 + s1 . d that has them:

    m0 = s0 + 2/3 s1.N,   m = 2/3 s0 N + (s1 + (s1.N) N) / 4

Then, with the true moments, how well the best function of order 1 and of order 2 does."""
import json
import os
import subprocess

import numpy as np
import torch

import dataset
import features
import gbuffer
import model
from truth_test import print_unseen


def sun_of(work, ssdo, number, header):
    """Light of a sun of irradiance pi, as the tool finds it"""
    out, lights = f"{work}/sun/{number}.exr", f"{work}/sun/{number}.json"
    if not os.path.exists(out):
        os.makedirs(f"{work}/sun", exist_ok=True)
        sun = {"type": "distant", "angle": 0.5, "intensity": float(np.pi), "normalize": True,
               "direction": [-float(v) for v in header[6:9]]}
        with open(lights, "w", encoding="ascii") as f:
            json.dump({"lights": [sun]}, f)
        frame = f"{work}/frames/frame_{number}.exr"
        options = ["--radius", "inf", "--products", "direct", "--lights", lights, "--env", "0,0,0",
                   "--prior", "rules", "--threads", "1", "-q"]
        subprocess.run([ssdo, frame, "-o", out, *options], check=True)
    return gbuffer.layer(gbuffer.read_channels(out), "direct", "RGB").mean(-1)


def linear(zero, one, n, d):
    """s0 + s1 . d from moments (k), (k, 3) over the hemispheres of n"""
    along = (one * n).sum(1)
    # Along N: m0 = s0 + 2/3 b, m.N = 2/3 s0 + b / 2, b = s1.N; across: m = s1 / 4.
    b = (along - 2 / 3 * zero) / (1 / 2 - 4 / 9)
    across = 4 * (one - along[:, None] * n)
    return zero - 2 / 3 * b + b * (n @ d) + across @ d


def best_fit(moments, n, d, order):
    """The true moments' function of `order` at the direction d, by its moments over hemispheres"""
    rng = np.random.default_rng(0)
    u, f = rng.random(4000), 2 * np.pi * rng.random(4000)
    local = np.stack([np.sqrt(u) * np.cos(f), np.sqrt(u) * np.sin(f), np.sqrt(1 - u)], 1)

    def basis(v):
        x, y, z = v.T
        parts = [np.ones_like(x), x, y, z, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y]
        return np.stack(parts[: (order + 1) ** 2], 1)

    out = []
    for m, normal in zip(moments, n):
        side = np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.9 else [0, 1.0, 0])
        side /= np.linalg.norm(side)
        around = basis(local @ np.stack([side, np.cross(normal, side), normal]))
        gram = around.T @ around / len(around)
        weights = np.linalg.solve(gram + 1e-3 * np.eye(len(gram)), m[: len(gram)])
        out.append(weights @ basis(d[None])[0])
    return np.array(out)


def errors(work, ssdo, number, net):
    g = gbuffer.read_gbuffer(f"{work}/frames/frame_{number}.exr")
    path = f"{work}/frames/truth_{number}.bin"
    header, rows = dataset.read_truth(path)
    raw = np.fromfile(path, np.float32)[dataset.HEADER :].reshape(-1, dataset.COLUMNS)
    keep = g.valid.ravel()[rows[:, 0].astype(int)]
    rows, raw = rows[keep][::7], raw[keep][::7]
    pixels, d = rows[:, 0].astype(int), header[6:9].astype(np.float64)
    n = g.normal.reshape(-1, 3)[pixels]
    cosine = np.maximum(n @ d, 0)
    truth = rows[:, 14] * cosine
    tool = sun_of(work, ssdo, number, header).ravel()[pixels]
    up = np.array([0, 1.0, 0] if header[1] == 1 else [0, 0, 1.0])
    far, _ = dataset.read_estimate(f"{work}/tool", "far", number, np.inf)
    geometry = features.Geometry(g, up)
    x = torch.from_numpy(geometry.features(far, pixels))
    with torch.no_grad():
        o = net(x)
        ao, width, _ = model.answer(o, x[:, 0], x[:, 1])
        change1 = (width[:, None] * o[:, 1:4]).numpy() @ geometry.axes
    change0 = ao.numpy() - x[:, 0].numpy()
    lit = lambda change: np.clip(tool + cosine * change, 0, cosine)
    # The generator's axes have z up, those of the file may have y up.
    turn = lambda v: np.stack([v[..., 0], -v[..., 2], v[..., 1]], -1) if header[1] == 1 else v
    fits = [cosine * np.clip(best_fit(raw[:, 2:11], turn(n), turn(d), k), 0, 1) for k in (1, 2)]
    scale = truth.mean() + 0.02
    values = (tool, lit(change0), lit(linear(change0, change1, n, d)), *fits)
    return [np.sqrt(np.mean((v - truth) ** 2)) / scale for v in values]


def main():
    print_unseen(errors, lambda *means: "sun: rules, with ao, with moments, truth of order 1, of order 2: "
                 + " ".join(f"{v:.3f}" for v in means))


if __name__ == "__main__":
    main()
