# SPDX-License-Identifier: Apache-2.0
"""truth_test.py WORK SSDO TRUTH [tool]: rules and model on path-traced scenes, after training

TRUTH holds env/, and public/SCENE/ with gbuffer.exr, truth_white.exr, truth_ao_R.exr,
truth_env_direct.exr and camera.json. Prints RMSE of ao at the smaller and the larger radius and
without limit, and of direct light relative to its mean, with the rules, with the prior's ao, and
with its moments; then, over blocks of 8 x 8 pixels of white ao, how spread and guessed predict the
error. With `tool`, the prior is what SSDO makes of it with --prior learned. Where an answer has a
second render, FILE_again.exr, the mean of both is taken, and the variance of its noise is
subtracted."""
import dataclasses
import glob
import json
import os
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio
import torch

import features
import gbuffer
import model
import train
from train import rank_correlation

UP = np.array([0, 0, 1.0])
BLOCK = 8


def print_unseen(errors, line):
    """errors(work, ssdo, number, net) -> figures of a frame; prints line(*means) by family, of frames that were never
    trained on. Arguments of the command: WORK SSDO FRAMES."""
    torch.set_num_threads(1)
    work, ssdo, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    net, data = load_model(f"{work}/up.pt"), train.Data(work, "up")
    result = {}
    for f in np.flatnonzero(data.unseen)[:count]:
        name = data.names[data.family[f]]
        result.setdefault(name, []).append(errors(work, ssdo, f"{data.number[f]:05d}", net))
    for name, rows in result.items():
        print(f"{name:12s} {len(rows):3d} frames, {line(*np.mean(rows, 0))}", flush=True)


def load_model(path):
    saved = torch.load(path)
    net = model.Prior(saved["sizes"][0], saved["sizes"][1:-1])
    net.load_state_dict(saved["state"])
    return net.eval()


def run(ssdo, gbuffer_path, out, *options):
    if not os.path.exists(out):
        common = ["--env-up", "z", "--pixel-type", "float", "--threads", "1", "-q", "--create-dirs"]
        if "--prior" not in options:
            common += ["--prior", "rules"]
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


def blocks(values, valid):
    """Means over blocks of which at least half is valid"""
    h, w = (n // BLOCK * BLOCK for n in valid.shape)
    tile = lambda v: v[:h, :w].reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK).sum((1, 3))
    count = tile(valid.astype(float))
    keep = count >= BLOCK * BLOCK / 2
    return [(tile(np.where(valid, v, 0)) / np.maximum(count, 1))[keep] for v in values]


class Scene:
    """A scene with its truth, at the valid pixels"""

    def __init__(self, ssdo, folder, work, kind):
        self.ssdo, self.folder, self.path = ssdo, folder, f"{folder}/gbuffer.exr"
        self.name = os.path.basename(folder)
        self.out = f"{work}/{self.name}"
        g = gbuffer.read_gbuffer(self.path)
        self.valid = g.valid
        self.geometry = features.Geometry(g, UP if kind == "up" else None)
        self.pixels = np.flatnonzero(g.valid.ravel())
        names = {os.path.basename(f)[9:-4] for f in glob.glob(f"{folder}/truth_ao_*")}
        names = {name for name in names if not name.endswith("_again")}
        self.radii = [*sorted(names, key=float), "inf"]

    def at(self, field):
        return field.reshape(self.valid.size, -1)[self.pixels]

    def truth(self, file, layer):
        """-> Truth"""
        read = lambda path: self.at(
            gbuffer.layer(gbuffer.read_channels(path), f"ViewLayer.{layer}", "RGB"))
        first, again = f"{self.folder}/{file}.exr", f"{self.folder}/{file}_again.exr"
        if not os.path.exists(again):
            return Truth(read(first))
        a, b = read(first), read(again)
        return Truth((a + b) / 2, b - a)

    def estimate(self, radius):
        at = ("--radius", radius)
        c = run(self.ssdo, self.path, f"{self.out}_{radius}.exr", *at, "--products",
                "ao,guessed,bent")
        o = run(self.ssdo, self.path, f"{self.out}_{radius}_open.exr", *at, "--products", "ao",
                "--offscreen", "open")
        bent = gbuffer.layer(c, "bent")
        return features.Estimate(c["ao.Y"], c["guessed.Y"], o["ao.Y"], bent, float(radius))

    def learned(self, radius, *options):
        """Products of the tool with its own prior"""
        at = ("--radius", radius, "--prior", "learned", *options)
        name = "_".join(o.strip("-") for o in options if "/" not in o)
        return run(self.ssdo, self.path, f"{self.out}_{radius}_learned_{name}.exr", *at)

    def light(self, env, name):
        c = run(self.ssdo, self.path, f"{self.out}_{name}.exr", "--radius", "inf", "--products",
                "direct", "--env", env)
        return self.at(gbuffer.layer(c, "direct", "RGB"))


@dataclasses.dataclass
class Truth:
    value: np.ndarray  # (n, 3); of ao (n)
    apart: np.ndarray | float = 0.0  # a second render less a first one, of which value is the mean

    def mean(self):
        """Of the three channels"""
        apart = self.apart.mean(1) if isinstance(self.apart, np.ndarray) else 0.0
        return Truth(self.value.mean(1), apart)


def rmse(a, truth):
    """Less the noise of the truth, whose variance is that of half of `apart`"""
    error = np.mean((np.asarray(a, np.float64) - truth.value) ** 2)
    return float(np.sqrt(max(error - np.mean(np.square(truth.apart)) / 4, 0)))


def test(s, net, work, truth, tool):
    """-> the columns that main() prints"""
    row = []
    for radius in s.radii:
        e = s.estimate(radius)
        file, layer = ("truth_white", "DiffDir") if radius == "inf" else (
            f"truth_ao_{radius}", "AO")
        known = s.truth(file, layer).mean()
        x = torch.from_numpy(s.geometry.features(e, s.pixels))
        with torch.no_grad():
            out = net(x)
            ao, width, spread = model.answer(out, x[:, 0], x[:, 1])
        if tool:
            ao = torch.from_numpy(s.at(s.learned(radius, "--products", "ao")["ao.Y"])[:, 0])
        row += [rmse(x[:, 0], known), rmse(ao, known)]
    row += direct(s, e, tool, ao.numpy(), (width[:, None] * out[:, 1:4]).detach().numpy(), work, truth)
    fields = np.zeros((3, s.valid.size))
    for k, v in enumerate((np.abs(ao - known.value), spread, x[:, 1])):
        fields[k, s.pixels] = v
    error, spread, guessed = blocks(fields.reshape(3, *s.valid.shape), s.valid)
    sure = spread < 0.05
    row += [rank_correlation(spread, error), rank_correlation(guessed, error), sure.mean()]
    return row + [float(np.sqrt(np.mean(error[sure] ** 2))) if sure.any() else 0.0]


def direct(s, e, tool, ao, change1, work, truth):
    """Relative errors with the rules, with the prior's ao for the mean radiance of the sky, and
    with its moments for the sky's gradient; suns are left as they are"""
    env = os.path.basename(json.load(open(f"{s.folder}/camera.json"))["env"])
    sky = sky_of(f"{truth}/env/{env}", f"{work}/sky_{env}")
    all_light = s.light(f"{truth}/env/{env}", "env")
    from_sky = s.light(f"{work}/sky_{env}", "sky")
    known = s.truth("truth_env_direct", "DiffDir")
    change0 = ao - s.at(0.5 * (e.ao + e.open))[:, 0]
    change = np.concatenate([change0[:, None], change1 @ s.geometry.axes], 1)
    lit = lambda k: np.clip(from_sky + change[:, :k] @ sky[:k], 0, None) + all_light - from_sky
    values = [all_light, lit(1), lit(4)]
    if tool:
        c = s.learned("inf", "--products", "direct", "--env", f"{truth}/env/{env}")
        values[1:] = [s.at(gbuffer.layer(c, "direct", "RGB"))] * 2
    return [rmse(v, known) / known.value.mean() for v in values]


def main():
    torch.set_num_threads(1)
    (work, ssdo, truth), tool = sys.argv[1:4], sys.argv[4:] == ["tool"]
    out = f"{work}/truth"
    os.makedirs(out, exist_ok=True)
    for kind in ("up",) if tool else ("up", "camera"):
        net = load_model(f"{work}/{kind}.pt")
        print(f"model {kind}\n{'':10s} near rules prior | far rules prior | white rules prior |"
              " direct rules, ao, moments | rank (guessed) sure rmse")
        rows = []
        for folder in sorted(glob.glob(f"{truth}/public/*")):
            if os.path.exists(f"{folder}/truth_white.exr"):
                s = Scene(ssdo, folder, out, kind)
                rows.append(test(s, net, out, truth, tool))
                show(s.name, rows[-1])
        show("mean", np.mean(rows, 0))


def show(name, r):
    print(f"{name:10s} {r[0]:.3f} {r[1]:.3f} | {r[2]:.3f} {r[3]:.3f} | {r[4]:.3f} {r[5]:.3f} |"
          f" {r[6]:.3f} {r[7]:.3f} {r[8]:.3f} | {r[9]:.2f} ({r[10]:.2f}) {r[11]:.2f} {r[12]:.3f}",
          flush=True)


if __name__ == "__main__":
    main()
