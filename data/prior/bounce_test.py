# SPDX-License-Identifier: Apache-2.0
"""bounce_test.py WORK SSDO COUNT: can the answer for ao serve bounce light too?

One bounce in a white world, on the first COUNT frames of the families that are never trained on.
What the prior finds blocked sends the mean radiance of what the frame shows; what it finds open no
longer sends: B' = B + (ao - ao') L, with L the mean of albedo * ao' over the frame. Senders are lit
by ao' too: B" = q B + (ao - ao') L, with q the ratio of L to the mean of albedo * ao. Prints the
RMSE over the mean, of the tool's bounce B, of B' and of B"."""
import os
import subprocess

import numpy as np
import torch

import dataset
import features
import gbuffer
import model
from truth_test import print_unseen


def bounce_of(work, ssdo, number):
    out = f"{work}/bounce/{number}.exr"
    if not os.path.exists(out):
        frame = f"{work}/frames/frame_{number}.exr"
        options = ["--radius", "inf", "--products", "bounce", "--threads", "1", "-q"]
        subprocess.run([ssdo, frame, "-o", out, "--create-dirs", *options], check=True)
    return gbuffer.layer(gbuffer.read_channels(out), "bounce", "RGB").mean(-1)


def errors(work, ssdo, number, net):
    path = f"{work}/frames/frame_{number}.exr"
    g = gbuffer.read_gbuffer(path)
    albedo = gbuffer.layer(gbuffer.read_channels(path), "ViewLayer.DiffCol", "RGB").mean(-1)
    header, rows = dataset.read_truth(f"{work}/frames/truth_{number}.bin")
    rows = rows[g.valid.ravel()[rows[:, 0].astype(int)]]
    pixels = rows[:, 0].astype(int)
    up = np.array([0, 1.0, 0] if header[1] == 1 else [0, 0, 1.0])
    far, _ = dataset.read_estimate(f"{work}/tool", "far", number, np.inf)
    x = torch.from_numpy(features.Geometry(g, up).features(far, pixels))
    with torch.no_grad():
        ao = model.answer(net(x), x[:, 0], x[:, 1])[0].numpy()
    tool = bounce_of(work, ssdo, number).ravel()[pixels]
    truth = rows[:, 11:14].mean(1)
    sent = np.mean(albedo.ravel()[pixels] * ao)
    before = x[:, 0].numpy()
    dimmed = sent / max(np.mean(albedo.ravel()[pixels] * before), 1e-6)
    changed = [np.maximum(q * tool + (before - ao) * sent, 0) for q in (1, dimmed)]
    scale = truth.mean() + 0.01
    return [np.sqrt(np.mean((v - truth) ** 2)) / scale for v in (tool, *changed)]


def main():
    print_unseen(errors, lambda rules, blocked, lit: f"bounce rules {rules:.3f}, what is blocked sends {blocked:.3f},"
                 f" lit by the prior too {lit:.3f}")


if __name__ == "__main__":
    main()
