# SPDX-License-Identifier: Apache-2.0
"""train.py WORK OUT [ablate]: trains candidates on WORK/cache, chooses by the worst validation
family, and writes the weights OUT/prior.bin; with `ablate` tables only"""
import concurrent.futures
import dataclasses
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
RADII = ("far", "near")


class Data:
    """All frames of a kind of model: x, by radius (frames, pixels, inputs) float16, and so on; and
    pairs (frames, 2, pixels, inputs), the same points before and after the camera turns."""

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
        self.held = self.unseen | (self.number % 13 == 5)
        self.train = np.flatnonzero(~self.held)
        self.pairs = torch.from_numpy(join(f"{prefix}_turned"))
        family, number = join("turned_family"), join("turned_number")
        self.pairs_unseen = np.flatnonzero(np.isin(family, held_families))
        self.pairs_train = np.flatnonzero(
            ~np.isin(family, held_families) & (number % 13 != 5)
        )


def balanced(light):
    """Chances that spread the mean truth of the frames evenly: those with 0.1 to 0.2, 0.2 to 0.3,
    .. 0.8 to 0.9 are drawn equally often, those below 0.1 and above 0.9 half as often"""
    bins = np.minimum((light * 10).astype(int), 9)
    share = np.array([0.5] + [1.0] * 8 + [0.5])
    chance = share[bins] / np.bincount(bins, minlength=10)[bins]
    return chance / chance.sum()


def ao_loss(net, x, y, rule, worse):
    """Error of a frame over that of the rules, and `worse` times what is worse than the rules"""
    out = net(x)
    ao, width, spread = model.answer(out, x[..., 0], x[..., 1])
    error = ao - y
    rmse = (error.square().mean(1) + 3e-4).sqrt()
    loss = rmse / (rule + 0.03) + worse * torch.relu(rmse / (rule + 0.003) - 1)
    expected = (error.abs().detach() / spread + spread.log()).mean(1)
    return loss.mean() + 0.1 * expected.mean(), out, width


def moment_loss(out, width, truth, tool, worse):
    error = (model.moments(out, width, tool) - truth).square().mean(1)
    rule = (tool - truth).square().mean(1).sqrt()
    ratio = (error + 1e-4).sqrt() / (rule + 0.03)
    return (ratio + worse * torch.relu(ratio - 1)).mean()


def rms(v):
    return (v.square().mean(-1) + 1e-5).sqrt()


def turned_loss(net, x):
    """How much ao' of the same points changes as the camera turns, over the change of the rules"""
    after = [model.answer(net(v), v[..., 0], v[..., 1])[0] for v in (x[:, 0], x[:, 1])]
    return (rms(after[0] - after[1]) / (rms(x[:, 0, :, 0] - x[:, 1, :, 0]) + 0.01)).mean()


@dataclasses.dataclass
class Options:
    seed: int = 0
    hidden: tuple = (48, 32)
    epochs: float = 20
    worse: float = 1  # weight of what is worse than the rules
    steady: float = 0.25  # weight of what changes as the camera turns
    noise: float = 0.1  # of the inputs, in their deviations, the same for all pixels of a frame
    blind: float = 0  # share of the frames that are shown without the context of their pixels
    balance: bool = True  # see balanced()
    drop: tuple = ()  # inputs that are hidden always
    directions: bool = True  # learn moments 1
    limit: float = 1  # share of the frames


# A candidate is the mean of networks that differ in their seeds.
CANDIDATES = [[Options(seed=0), Options(seed=1)], [Options(seed=2), Options(seed=3)]]


def train(data, o):
    """-> Prior"""
    torch.manual_seed(o.seed)
    rng = np.random.default_rng(o.seed)
    net = model.Prior(len(features.NAMES), o.hidden)
    frames = rng.permutation(data.train)[: int(o.limit * len(data.train))]
    some = data.x["far"][data.train].reshape(-1, len(features.NAMES))[::23].float()
    net.mean[:] = some.mean(0)
    net.inverse_deviation[:] = 1 / (some.std(0) + 1e-2)
    k = features.NAMES.index("pixel.log_radius")  # it varies only where it is limited
    radius = torch.cat([some[:, k], data.x["near"][data.train][..., k].reshape(-1)[::23].float()])
    net.mean[k], net.inverse_deviation[k] = radius.mean(), 1 / radius.std()
    net.inverse_deviation[list(o.drop)] = 0
    order, sign = features.mirror()
    sign_t = torch.from_numpy(sign)
    chance = balanced(data.light[frames]) if o.balance else None
    context = torch.tensor([not n.startswith("pixel") for n in features.NAMES])
    batch = {"far": 14, "near": 10}
    steps = int(o.epochs * len(frames) / batch["far"])
    optimizer = torch.optim.AdamW(net.parameters(), 4e-3, weight_decay=3e-3)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimizer, 4e-3, total_steps=steps, pct_start=0.1)
    turned = 6  # frames
    jitter = o.noise / net.inverse_deviation.clamp(min=0.1)
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
            blind = torch.from_numpy(rng.random(len(f)) < o.blind)
            seen = torch.where(blind[:, None, None] & context, net.mean, seen)
            part, out, width = ao_loss(net, seen, data.y[r][f], data.rule[r][f], o.worse)
            loss = loss + part
            if r == "far" and o.directions:
                turn = torch.where(flip, -1.0, 1.0)[:, None, None] * torch.tensor([1.0, 0, 0])
                turn = turn + torch.tensor([0, 1.0, 1.0])
                side = lambda v: v * torch.where(flip[:, None, None], turn, torch.ones(3))
                truth, tool = side(data.truth1[f]), side(data.tool1[f])
                loss = loss + 0.5 * moment_loss(out, width, truth, tool, o.worse)
        f = data.pairs_train[rng.choice(len(data.pairs_train), turned)]
        x = data.pairs[f].float()
        flip = torch.from_numpy(rng.random(turned) < 0.5)[:, None, None, None]
        loss = loss + o.steady * turned_loss(net, torch.where(flip, x[..., order] * sign_t, x))
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


def changes(data, net):
    """RMS change of ao' of unseen families as the camera turns a little, and that of the rules"""
    with torch.no_grad():
        x = data.pairs[data.pairs_unseen].float()
        after = [model.answer(net(v), v[..., 0], v[..., 1])[0] for v in (x[:, 0], x[:, 1])]
        change = after[0] - after[1], x[:, 0, :, 0] - x[:, 1, :, 0]
    return [float(rms(v).mean()) for v in change]


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
    """The largest ratio to the rules of any family: ao at both radii, light with moments"""
    pairs = [(r, r + "_rule") for r in RADII] + [("light_both", "light_rules")]
    return max(v[a] / (v[b] + 0.003) for v in t.values() for a, b in pairs)


def easy(rows):
    """-> errors of the rules and of the prior, far, light by rules, by ao and with moments, means
    over the quarter of the frames of each family where the rules' ao is least wrong"""
    picked = []
    for k in {row["family"] for row in rows}:
        frames = sorted((r for r in rows if r["family"] == k), key=lambda r: r["far_rule"])
        picked += frames[: max(1, len(frames) // 4)]
    columns = ("far_rule", "far", "light_rules", "light_ao", "light_both")
    return [float(np.mean([r[c] for r in picked])) for c in columns]


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


@dataclasses.dataclass
class Chosen:
    kind: str
    net: model.Prior
    frames: int  # that it was trained on
    report: list  # (title, table or None)


def choose(work, kind):
    torch.set_num_threads(1)
    data = Data(work, kind)
    unseen = np.flatnonzero(data.unseen)
    best = None
    for options in CANDIDATES:
        start = time.process_time()
        net = model.mean_of([train(data, o) for o in options])
        rows = errors(data, net, unseen)
        t = table(data, rows)
        seconds = time.process_time() - start
        print(kind, options, f"worst {worst(t):.3f}, {seconds:.0f} CPU s", flush=True)
        if best is None or worst(t) < best[0]:
            best = worst(t), options, net, t, rows
    _, options, net, t, rows = best
    seen = np.flatnonzero(data.held & ~data.unseen)
    return Chosen(kind, net, len(data.train), [
        (f"{kind}: chosen {options}; families never trained on", t),
        ("change of ao by a degree: prior {:.4f}, rules {:.4f}".format(*changes(data, net)), None),
        ("easiest quarter: far rules {:.3f} prior {:.3f}, light {:.3f} {:.3f} {:.3f}".format(
            *easy(rows)), None),
        (f"{kind}: other frames of families trained on", table(data, errors(data, net, seen))),
    ])


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


def write(work, folder, chosen):
    header = ["ssdo-prior 1", f"source {digest(work)}", f"frames {chosen[0].frames}"]
    header += ["inputs " + " ".join(features.NAMES)]
    for c in chosen:
        header.append(f"model {c.kind} " + " ".join(str(n) for n in model.sizes(c.net)))
    with open(f"{folder}/prior.bin", "wb") as f:
        f.write(("\n".join(header) + "\nend\n").encode())
        for c in chosen:
            f.write(model.flat_weights(c.net).tobytes())


ABLATIONS = {
    "all inputs": lambda n: False,
    "no n, d, bent": lambda n: n.split(".")[1].split("_")[0] in ("n", "d", "bent"),
    "no open": lambda n: "open" in n,
    "no depth": lambda n: "depth" in n,
    "no guessed": lambda n: "guessed" in n and n != "pixel.guessed",
    "pixel only": lambda n: not n.startswith("pixel"),
}


def ablate(work):
    data = Data(work, "up")
    unseen = np.flatnonzero(data.unseen)
    runs = []
    for name, hides in ABLATIONS.items():
        drop = tuple(i for i, n in enumerate(features.NAMES) if hides(n))
        runs.append((name, dict(drop=drop)))
    runs.append(("a quarter of the frames", dict(limit=0.25, epochs=40)))
    runs.append(("no directions", dict(directions=False)))
    runs.append(("no turned frames", dict(steady=0)))
    runs.append(("frames as they are", dict(balance=False)))
    for name, options in runs:
        net = train(data, Options(**{"epochs": 10, **options}))
        t = table(data, errors(data, net, unseen))
        print(
            f"{name:24s} far {ratio(t, 'far'):.3f} near {ratio(t, 'near'):.3f}"
            f" light {ratio(t, 'light_both', 'light_rules'):.3f} worst {worst(t):.3f}"
            f" change {changes(data, net)[0]:.4f}",
            flush=True,
        )


def main():
    torch.set_num_threads(1)
    work, folder = sys.argv[1], sys.argv[2]
    if len(sys.argv) > 3:
        ablate(work)
        return
    with concurrent.futures.ProcessPoolExecutor() as pool:
        chosen = list(pool.map(choose, [work] * len(AXES), AXES))
    for c in chosen:
        for title, t in c.report:
            show(title, t) if t else print(title)
    write(work, folder, chosen)
    for c in chosen:
        torch.save({"sizes": model.sizes(c.net), "state": c.net.state_dict()}, f"{work}/{c.kind}.pt")


if __name__ == "__main__":
    main()
