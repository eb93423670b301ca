# SPDX-License-Identifier: Apache-2.0
"""truth_test.py WORK SSDO TRUTH: the rules and the model on path-traced scenes, after training

TRUTH holds public/SCENE/ with gbuffer.exr, truth_white.exr, truth_ao_R.exr, truth_env_direct.exr and
camera.json, and env/. Prints RMSE of ao at the smaller and the larger radius and without limit, and
of direct light relative to its mean, with the rules, with the prior's ao, and with its moments;
then, over blocks of 8 x 8 pixels of white ao, how spread and guessed predict the error."""
import glob
import json
import os
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio
import torch

import dataset
import features
import gbuffer
import model
from train import rank_correlation

UP = np.array([0, 0, 1.0])
BLOCK = 8


def load_model(path):
    saved = torch.load(path)
    net = model.Prior(saved["sizes"][0], saved["sizes"][1:-1])
    net.load_state_dict(saved["state"])
    return net.eval()


def run(ssdo, gbuffer_path, out, *options):
    if not os.path.exists(out):
        common = ["--env-up", "z", "--pixel-type", "float", "--threads", "1", "-q", "--create-dirs"]
        subprocess.run([ssdo, gbuffer_path, "-o", out, *common, *options], check=True)
    return gbuffer.read_channels(out)


def sky_of(path, out):
    """The map without its suns, and the moments 0 and 1 (4, 3) of its radiance, of which
    irradiance / pi = moments . [ao, moments 1 of the visibility] in part"""
    file = oiio.ImageInput.open(path)
    a = np.asarray(file.read_image("float"), np.float32)[..., :3]
    file.close()
    h, w, _ = a.shape
    limit = 4 * np.sort(a.mean(2).ravel())[int(0.9 * h * w)]
    a = a * np.minimum(1, limit / np.maximum(a.mean(2), 1e-9))[..., None]
    if not os.path.exists(out):
        file = oiio.ImageOutput.create(out)
        file.open(out, oiio.ImageSpec(w, h, 3, "float"))
        file.write_image(np.ascontiguousarray(a))
        file.close()
    f = (0.5 - (np.arange(w) + 0.5) / w) * 2 * np.pi
    t = (np.arange(h) + 0.5) / h * np.pi
    one = np.ones((h, w))
    b = np.stack([one, np.sin(t)[:, None] * np.cos(f), np.sin(t)[:, None] * np.sin(f)], -1)
    b = np.concatenate([b, (np.cos(t)[:, None] * one)[..., None]], -1)
    weight = np.sin(t)[:, None] * one
    weight = weight / weight.sum()
    scale = np.einsum("hw,hwk->k", weight, b * b)
    return np.einsum("hw,hwk,hwc->kc", weight, b, a) / scale[:, None]


def estimate(ssdo, path, out, radius, *options):
    at = ("--radius", str(radius))
    c = run(ssdo, path, f"{out}_{radius}.exr", *at, "--products", "ao,guessed,bent", *options)
    o = run(ssdo, path, f"{out}_{radius}_open.exr", *at, "--products", "ao", "--offscreen", "open")
    bent = gbuffer.layer(c, "bent")
    return features.Estimate(c["ao.Y"], c["guessed.Y"], o["ao.Y"], bent, float(radius)), c


def blocks(values, valid):
    """Means over blocks of which at least half is valid"""
    h, w = (n // BLOCK * BLOCK for n in valid.shape)
    tile = lambda v: v[:h, :w].reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK).sum((1, 3))
    count = tile(valid.astype(float))
    keep = count >= BLOCK * BLOCK / 2
    return [(tile(np.where(valid, v, 0)) / np.maximum(count, 1))[keep] for v in values]


def scene(ssdo, folder, work, truth, nets, kind):
    name = os.path.basename(folder)
    path, out = f"{folder}/gbuffer.exr", f"{work}/{name}"
    g = gbuffer.read_gbuffer(path)
    geometry = features.Geometry(g, UP if kind == "up" else None)
    pixels = np.flatnonzero(g.valid.ravel())
    at = lambda v: v.reshape(g.valid.size, -1)[pixels]
    read = lambda f, n: at(gbuffer.layer(gbuffer.read_channels(f"{folder}/{f}"), n, "RGB"))
    radii = sorted((os.path.basename(f)[9:-4] for f in glob.glob(f"{folder}/truth_ao_*")), key=float)
    rmse = lambda a, b: float(np.sqrt(np.mean((np.asarray(a, np.float64) - b) ** 2)))
    row, extra = [], {}
    for radius in [*radii, "inf"]:
        options = ("--env", f"{work}/linear.exr") if radius == "inf" else ()
        e, c = estimate(ssdo, path, out, radius)
        truth_ao = read("truth_white.exr", "ViewLayer.DiffDir") if radius == "inf" else read(
            f"truth_ao_{radius}.exr", "ViewLayer.AO")
        truth_ao = truth_ao.mean(1)
        x = torch.from_numpy(geometry.features(e, pixels))
        with torch.no_grad():
            o = nets[kind](x)
            ao, width, spread = model.answer(o, x[:, 0], x[:, 1])
        row += [rmse(x[:, 0], truth_ao), rmse(ao, truth_ao)]
    linear = run(ssdo, path, f"{out}_linear.exr", "--radius", "inf", "--products", "direct", *options)
    tool1 = (gbuffer.layer(linear, "direct", "RGB") - (0.5 * (e.ao + e.open))[..., None])
    zero, tool1 = at(0.5 * (e.ao + e.open))[:, 0], at(tool1) @ geometry.axes.T
    with torch.no_grad():
        m1 = model.moments(o, width, torch.from_numpy(tool1.astype(np.float32))).numpy()
    env = os.path.basename(json.load(open(f"{folder}/camera.json"))["env"])
    sky_path = f"{work}/sky_{env}"
    sky = sky_of(f"{truth}/env/{env}", sky_path)
    light = lambda p, n: at(gbuffer.layer(
        run(ssdo, path, f"{out}_{n}.exr", "--radius", "inf", "--products", "direct", "--env", p),
        "direct", "RGB"))
    direct, from_sky = light(f"{truth}/env/{env}", "env"), light(sky_path, "sky")
    known = read("truth_env_direct.exr", "ViewLayer.DiffDir")
    change = np.concatenate([(ao.numpy() - zero)[:, None], (m1 - tool1) @ geometry.axes], 1)
    lit = lambda k: np.clip(from_sky + change[:, :k] @ sky[:k], 0, None) + direct - from_sky
    row += [rmse(v, known) / known.mean() for v in (direct, lit(1), lit(4))]
    fields = np.zeros((4, g.valid.size))
    for k, v in enumerate((truth_ao, ao, spread, x[:, 1])):
        fields[k, pixels] = v
    error = np.abs(fields[0] - fields[1]).reshape(g.valid.shape)
    signed, sure, guess = blocks([error, fields[2].reshape(g.valid.shape), fields[3].reshape(g.valid.shape)], g.valid)
    low = sure < 0.05
    extra = [rank_correlation(sure, signed), rank_correlation(guess, signed), low.mean(),
             float(np.sqrt(np.mean(signed[low] ** 2))) if low.any() else 0.0]
    return name, row, extra


def main():
    torch.set_num_threads(1)
    work, ssdo, truth = sys.argv[1:4]
    out = f"{work}/truth"
    os.makedirs(out, exist_ok=True)
    if not os.path.exists(f"{out}/linear.exr"):
        subprocess.run([sys.executable, f"{os.path.dirname(__file__)}/linear_map.py", f"{out}/linear.exr"], check=True)
    nets = {kind: load_model(f"{work}/{kind}.pt") for kind in ("up", "camera")}
    for kind in nets:
        print(f"model {kind}\n{'':10s} near rules prior | far rules prior | white rules prior |"
              " direct rules, ao, moments | rank (guessed) sure rmse")
        rows = []
        for folder in sorted(glob.glob(f"{truth}/public/*")):
            if not os.path.exists(f"{folder}/truth_white.exr"):
                continue
            name, row, extra = scene(ssdo, folder, out, truth, nets, kind)
            rows.append(row + extra)
            show(name, rows[-1])
        show("mean", np.mean(rows, 0))


def show(name, r):
    print(f"{name:10s} {r[0]:.3f} {r[1]:.3f} | {r[2]:.3f} {r[3]:.3f} | {r[4]:.3f} {r[5]:.3f} |"
          f" {r[6]:.3f} {r[7]:.3f} {r[8]:.3f} | {r[9]:.2f} ({r[10]:.2f}) {r[11]:.2f} {r[12]:.3f}", flush=True)


if __name__ == "__main__":
    main()
