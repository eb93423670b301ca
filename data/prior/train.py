# SPDX-License-Identifier: Apache-2.0
"""train.py WORK OUT [ablate]: trains candidates on WORK/cache, chooses by the worst validation
family, and writes the weights OUT/prior.bin; with `ablate` tables only"""
import glob
import hashlib
import os
import subprocess
import sys
import time

import numpy as np
import torch

import features
import model

AXES = {"up": "x", "camera": "c"}  # kind of model -> prefix in the caches
CANDIDATES = [dict(seed=0), dict(seed=1, light=0.15), dict(seed=2, hidden=(64, 32), light=0.15)]
RADII = ("far", "near")


class Data:
    """All frames of a kind of model. far_x (frames, pixels, inputs) float16, and so on."""

    def __init__(self, work, kind):
        paths = sorted(glob.glob(f"{work}/cache/*.npz"))
        files = [np.load(p) for p in paths]
        join = lambda k: np.concatenate([f[k] for f in files])
        prefix = AXES[kind]
        self.family, self.number = join("family"), join("number")
        self.light = join("light")
        self.x = {r: torch.from_numpy(join(f"{prefix}_{r}")) for r in RADII}
        self.y = {r: torch.from_numpy(join(f"{r}_y").astype(np.float32)) for r in RADII}
        self.rule = {r: torch.from_numpy(join(f"{r}_rule").astype(np.float32)) for r in RADII}
        self.truth1 = torch.from_numpy(join(f"{prefix}_truth1").astype(np.float32))
        self.tool1 = torch.from_numpy(join(f"{prefix}_tool1").astype(np.float32))
        self.zero = torch.from_numpy(join("zero").astype(np.float32))
        self.up = torch.from_numpy(join(f"{prefix}_up").astype(np.float32))
        names = subprocess.run([f"{work}/generate"], capture_output=True, text=True).stdout
        lines = [line.split(maxsplit=1)[1] for line in names.splitlines()[1:]]
        self.names = [n.removesuffix(" *") for n in lines]
        held_families = [i for i, n in enumerate(lines) if n.endswith("*")]
        self.unseen = np.isin(self.family, held_families)
        self.held = self.unseen | (self.number // len(lines) % 12 == 5)
        self.train = np.flatnonzero(~self.held)


def ao_loss(net, x, y, rule):
    """Error of a frame over that of the rules, and once more what is worse than the rules"""
    out = net(x)
    ao, width, spread = model.answer(out, x[..., 0], x[..., 1])
    error = ao - y
    rmse = (error.square().mean(1) + 3e-4).sqrt()
    loss = rmse / (rule + 0.03) + torch.relu(rmse / (rule + 0.003) - 1)
    expected = (error.abs().detach() / spread + spread.log()).mean(1)
    return loss.mean() + 0.1 * expected.mean(), out, width


def moment_loss(out, width, truth, tool):
    error = (model.moments(out, width, tool) - truth).square().mean(1)
    rule = (tool - truth).square().mean(1).sqrt()
    ratio = (error + 1e-4).sqrt() / (rule + 0.03)
    return (ratio + torch.relu(ratio - 1)).mean()


def train(
    data, hidden=(48, 32), seed=0, light=0.35, epochs=10, drop=(), directions=True, limit=1.0
):
    """-> Prior. drop: inputs that are hidden from it; light: frames whose mean truth is darker are
    drawn less often, as some light gets into what people render."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    net = model.Prior(len(features.NAMES), hidden)
    frames = data.train if limit == 1 else data.train[: int(limit * len(data.train))]
    some = data.x["far"][frames].reshape(-1, len(features.NAMES))[::23].float()
    net.mean[:] = some.mean(0)
    net.inverse_deviation[:] = 1 / (some.std(0) + 1e-2)
    k = features.NAMES.index("pixel.log_radius")  # it varies only where it is limited
    radius = torch.cat([some[:, k], data.x["near"][frames][..., k].reshape(-1)[::23].float()])
    net.mean[k], net.inverse_deviation[k] = radius.mean(), 1 / radius.std()
    net.inverse_deviation[list(drop)] = 0
    order, sign = features.mirror()
    sign_t = torch.from_numpy(sign)
    chance = np.clip(data.light[frames] / light, 0.1, 1)
    chance = chance / chance.sum()
    batch = {"far": 14, "near": 10}
    steps = int(epochs * len(frames) / batch["far"])
    optimizer = torch.optim.AdamW(net.parameters(), 4e-3, weight_decay=3e-3)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimizer, 4e-3, total_steps=steps, pct_start=0.1)
    jitter = 0.1 / net.inverse_deviation.clamp(min=0.1)
    jitter[:2] = 0
    for _ in range(steps):
        loss = 0
        for r in RADII:
            f = frames[rng.choice(len(frames), batch[r], p=chance)]
            x = data.x[r][f].float()
            flip = torch.from_numpy(rng.random(len(f)) < 0.5)
            x = torch.where(flip[:, None, None], x[..., order] * sign_t, x)
            seen = x + jitter * torch.randn(len(f), 1, x.shape[-1])
            seen[..., :2] = x[..., :2]
            part, out, width = ao_loss(net, seen, data.y[r][f], data.rule[r][f])
            loss = loss + part
            if r == "far" and directions:
                turn = torch.where(flip, -1.0, 1.0)[:, None, None] * torch.tensor([1.0, 0, 0])
                turn = turn + torch.tensor([0, 1.0, 1.0])
                side = lambda v: v * torch.where(flip[:, None, None], turn, torch.ones(3))
                loss = loss + 0.5 * moment_loss(
                    out, width, side(data.truth1[f]), side(data.tool1[f])
                )
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 2.0)
        optimizer.step()
        rate.step()
    return net.eval()


def skies(up, seed=0):
    """Gradients of six skies 1 + g . d: lit from above, and from some side -> (frames, 6, 3)"""
    g = torch.from_numpy(np.random.default_rng(seed).normal(size=(6, 3)).astype(np.float32))
    return 0.6 * up[:, None] + 0.6 * g / g.norm(dim=1, keepdim=True)


def errors(data, net, frames):
    """Per frame: RMSE of ao far and near; of direct light under skies, relative to its mean, with
    the rules, with the prior's ao, with its moments too; rank correlation of spread and |error|"""
    rows = []
    with torch.no_grad():
        for f in frames:
            row = {"family": int(data.family[f])}
            for r in RADII:
                x, y = data.x[r][f].float(), data.y[r][f]
                out = net(x)
                ao, width, spread = model.answer(out, x[:, 0], x[:, 1])
                rmse = lambda v, t: float((v - t).square().mean().sqrt())
                row[r] = rmse(ao, y)
                row[r + "_rule"] = rmse(x[:, 0], y)
                if r == "near":
                    continue
                row["truth"], row["bias"] = float(y.mean()), float((ao - y).mean())
                error = (ao - y).abs()
                row["spread"], row["error"] = spread.numpy(), error.numpy()
                row["guessed"] = x[:, 1].numpy()
                m1 = model.moments(out, width, data.tool1[f])
                row["d_tool"] = rmse(data.tool1[f], data.truth1[f])
                row["d_model"] = rmse(m1, data.truth1[f])
                light = {}
                for g in skies(data.up[f : f + 1])[0]:
                    truth = y + data.truth1[f] @ g
                    floor = truth.mean().abs() + 0.02
                    for name, zero, one in (
                        ("rules", data.zero[f], data.tool1[f]),
                        ("ao", ao, data.tool1[f]),
                        ("both", ao, m1),
                    ):
                        error = rmse(zero + one @ g, truth) / float(floor)
                        light.setdefault(name, []).append(error)
                for name, v in light.items():
                    row["light_" + name] = float(np.mean(v))
            rows.append(row)
    return rows


def rank_correlation(a, b):
    rank = lambda v: np.argsort(np.argsort(v)).astype(float)
    return float(np.corrcoef(rank(a), rank(b))[0, 1])


def table(data, rows):
    """-> {family or group: {column: value}}, means over its frames"""
    groups = {}
    for row in rows:
        groups.setdefault(row["family"], []).append(row)
    out = {}
    for k, g in sorted(groups.items()):
        mean = lambda c: float(np.mean([r[c] for r in g]))
        v = {c: mean(c) for c in g[0] if c not in ("family", "spread", "error", "guessed")}
        spread = np.concatenate([r["spread"] for r in g])
        error = np.concatenate([r["error"] for r in g])
        v["rank"] = rank_correlation(spread, error)
        v["rank_guessed"] = rank_correlation(np.concatenate([r["guessed"] for r in g]), error)
        sure = spread < 0.05
        v["sure"] = float(sure.mean())
        v["sure_rmse"] = float(np.sqrt(np.mean(error[sure] ** 2))) if sure.any() else 0.0
        v["frames"] = len(g)
        out[data.names[k]] = v
    return out


def worst(t):
    """The largest ratio to the rules of any family at any radius"""
    return max(v[r] / (v[r + "_rule"] + 0.003) for v in t.values() for r in RADII)


def show(title, t):
    print(title)
    print(
        f"{'':14s} frames truth | far rules prior ratio | near rules prior ratio |"
        " moment rules prior | light rules ao both | rank (guessed) sure rmse"
    )
    for name, v in t.items():
        print(
            f"{name:14s} {v['frames']:5d} {v['truth']:.2f} | {v['far_rule']:.3f} {v['far']:.3f}"
            f" {v['far'] / v['far_rule']:.2f} | {v['near_rule']:.3f} {v['near']:.3f}"
            f" {v['near'] / v['near_rule']:.2f} | {v['d_tool']:.3f} {v['d_model']:.3f} |"
            f" {v['light_rules']:.3f} {v['light_ao']:.3f} {v['light_both']:.3f} |"
            f" {v['rank']:.2f} ({v['rank_guessed']:.2f}) {v['sure']:.2f} {v['sure_rmse']:.3f}"
        )
    mean = lambda c: np.mean([v[c] for v in t.values()])
    print(
        f"mean of families: far {mean('far_rule'):.3f} -> {mean('far'):.3f},"
        f" near {mean('near_rule'):.3f} -> {mean('near'):.3f}; ratios far {ratio(t, 'far'):.3f},"
        f" near {ratio(t, 'near'):.3f}, moments {ratio(t, 'd_model', 'd_tool'):.3f},"
        f" light by ao {ratio(t, 'light_ao', 'light_rules'):.3f}, with moments"
        f" {ratio(t, 'light_both', 'light_rules'):.3f}; worst ratio {worst(t):.3f}",
        flush=True,
    )


def ratio(t, column, rule=None):
    """Geometric mean over families of a column over that of the rules"""
    rule = rule or column + "_rule"
    return np.exp(np.mean([np.log(v[column] / v[rule]) for v in t.values()]))


def choose(work, kind):
    data = Data(work, kind)
    unseen = np.flatnonzero(data.unseen)
    best = None
    for options in CANDIDATES:
        start = time.process_time()
        net = train(data, **options)
        t = table(data, errors(data, net, unseen))
        seconds = time.process_time() - start
        print(kind, options, f"worst {worst(t):.3f}, {seconds:.0f} CPU s", flush=True)
        if best is None or worst(t) < best[0]:
            best = worst(t), options, net, t
    show(f"{kind}: chosen {best[1]}; families never trained on", best[3])
    seen = np.flatnonzero(data.held & ~data.unseen)
    show(f"{kind}: other frames of families trained on", table(data, errors(data, best[2], seen)))
    return data, best[2]


def digest(work):
    """A hash of the sources and of the caches they made"""
    here = os.path.dirname(os.path.abspath(__file__))
    h = hashlib.sha256()
    used = ("linear_map", "gbuffer", "features", "dataset", "model", "train")
    sources = [f"{here}/make.sh"] + [f"{here}/{name}.py" for name in used]
    sources += sorted(glob.glob(f"{here}/generator/*"))
    for path in sources + sorted(glob.glob(f"{work}/cache/*.npz")):
        with open(path, "rb") as f:
            h.update(f.read())
    return h.hexdigest()


def write(work, folder, nets, data):
    header = ["ssdo-prior 1", f"source {digest(work)}", f"frames {len(data.train)}"]
    header += ["inputs " + " ".join(features.NAMES)]
    for kind, net in nets.items():
        header.append(f"model {kind} " + " ".join(str(n) for n in model.sizes(net)))
    with open(f"{folder}/prior.bin", "wb") as f:
        f.write(("\n".join(header) + "\nend\n").encode())
        for net in nets.values():
            f.write(model.flat_weights(net).tobytes())


ABLATIONS = {
    "all inputs": lambda n: False,
    "no n, d, bent": lambda n: n.split(".")[1].split("_")[0] in ("n", "d", "bent"),
    "no open": lambda n: "open" in n,
    "no depth": lambda n: "depth" in n,
    "no guessed": lambda n: "guessed" in n and n != "pixel.guessed",
    "no surroundings": lambda n: n.startswith("level"),
    "no frame": lambda n: n.split(".")[0] in ("frame", "top", "bottom", "left", "right"),
    "pixel only": lambda n: not n.startswith("pixel"),
}


def ablate(work):
    data = Data(work, "up")
    unseen = np.flatnonzero(data.unseen)
    runs = []
    for name, hides in ABLATIONS.items():
        runs.append((name, dict(drop=[i for i, n in enumerate(features.NAMES) if hides(n)])))
    runs.append(("a quarter of the frames", dict(limit=0.25, epochs=20)))
    runs.append(("no directions", dict(directions=False)))
    for name, options in runs:
        net = train(data, **{"epochs": 5, **options})
        t = table(data, errors(data, net, unseen))
        print(
            f"{name:24s} far {ratio(t, 'far'):.3f} near {ratio(t, 'near'):.3f}"
            f" light {ratio(t, 'light_both', 'light_rules'):.3f} worst {worst(t):.3f}",
            flush=True,
        )


def main():
    torch.set_num_threads(1)
    work, folder = sys.argv[1], sys.argv[2]
    if len(sys.argv) > 3:
        ablate(work)
        return
    chosen = {kind: choose(work, kind) for kind in AXES}
    nets = {kind: net for kind, (_, net) in chosen.items()}
    write(work, folder, nets, chosen["up"][0])
    for kind, net in nets.items():
        torch.save({"sizes": model.sizes(net), "state": net.state_dict()}, f"{work}/{kind}.pt")


if __name__ == "__main__":
    main()
