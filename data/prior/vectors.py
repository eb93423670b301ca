# SPDX-License-Identifier: Apache-2.0
"""vectors.py PRIOR.bin FRAME.exr OUT.txt: what a reader of the weights must reproduce

Features of FRAME at some pixels, for an estimate that is made up of sines so that no march is
needed, and the outputs of each model there; from the weights file alone, without torch."""
import sys

import numpy as np

import features
import gbuffer


def read_weights(path):
    """-> {kind: (mean, inverse deviation, [(weights [out][in], biases)])}"""
    with open(path, "rb") as f:
        header, models = [], {}
        while (line := f.readline().decode().strip()) != "end":
            header.append(line.split())
        take = lambda *shape: np.frombuffer(f.read(4 * int(np.prod(shape))), "<f4").reshape(shape)
        for words in header:
            if words[0] == "model":
                n = [int(w) for w in words[2:]]
                mean, scale = take(n[0]), take(n[0])
                layers = [(take(b, a), take(b)) for a, b in zip(n[:-1], n[1:])]
                models[words[1]] = mean, scale, layers
    return models


def outputs(weights, x):
    mean, scale, layers = weights
    h = np.clip((x - mean) * scale, -4, 4)
    for k, (w, b) in enumerate(layers):
        h = h @ w.T + b
        if k + 1 < len(layers):
            h = np.maximum(h, 0)
    return h


def answer(out, ao, guessed):
    """ao and spread, as model.answer"""
    low = np.maximum(ao - guessed, 0)
    width = np.minimum(ao + guessed, 1) - low
    place = np.clip((ao - low) / np.maximum(width, 1e-4), 0.02, 0.98)
    sigmoid = lambda v: 1 / (1 + np.exp(-v))
    shifted = sigmoid(np.log(place / (1 - place)) + 4 * out[:, 0])
    return low + width * shifted, 0.005 + width * sigmoid(out[:, 4] - 1)


def made_up(g, radius):
    """ao, guessed and open from the row and the column, bent = N"""
    row, column = np.mgrid[0 : g.depth.shape[0], 0 : g.depth.shape[1]]
    ao = 0.5 + 0.3 * np.sin(0.05 * column) * np.cos(0.07 * row)
    guessed = 0.3 + 0.2 * np.cos(0.03 * (row + column))
    return features.Estimate(ao, guessed, np.minimum(1, ao + 0.1), g.normal, radius)


def main():
    models, frame, out = read_weights(sys.argv[1]), sys.argv[2], sys.argv[3]
    g = gbuffer.read_gbuffer(frame)
    pixels = np.flatnonzero(g.valid.ravel())
    pixels = pixels[np.linspace(0, len(pixels) - 1, 8).astype(int)]
    c = g.camera
    with open(out, "w") as f:
        f.write("# camera: right, up, forward, half width, half height at depth 1\n")
        values = [*c.right, *c.up, *c.forward, c.half_width, c.half_height]
        f.write("camera " + " ".join(f"{v:.9g}" for v in values) + "\n")
        f.write("# model, radius, row, column, inputs, outputs, ao, spread\n")
        for kind, up in (("up", np.array([0, 0, 1.0])), ("camera", None)):
            for radius in (np.inf, 1.0):
                e = made_up(g, radius)
                x = features.Geometry(g, up).features(e, pixels)
                o = outputs(models[kind], x)
                ao, spread = answer(o, x[:, 0], x[:, 1])
                for i, p in enumerate(pixels):
                    row, column = divmod(int(p), g.depth.shape[1])
                    values = " ".join(f"{v:.7g}" for v in (*x[i], *o[i], ao[i], spread[i]))
                    f.write(f"{kind} {radius} {row} {column} {values}\n")


if __name__ == "__main__":
    main()
