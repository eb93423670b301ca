# SPDX-License-Identifier: Apache-2.0
"""Inputs of the prior. README.md states each of them; the order is that of NAMES."""
import dataclasses

import numpy as np

from gbuffer import screen

EPSILON = 1e-3  # weight of the frame's mean along sides that show little
SIDES = ("top", "bottom", "left", "right")
SIDE_WIDTH = 1 / 12  # of the strip along a side, over the geometric mean of width and height


PIXEL = (
    "ao guessed open_minus_ao log_radius bent_x bent_y bent_z n_x n_y n_z d_x d_y d_z "
    "screen_x screen_y log_depth facing log_lens log_aspect"
).split()
FRAME = (
    "n_x n_y n_z n_length n_up_abs depth_dev coverage ao guessed open_minus_ao bent_x bent_y "
    "bent_z ao_dev guessed_dev pitch"
).split()
SIDE = "coverage log_depth n_z ao guessed open_minus_ao".split()
NAMES = (
    [f"pixel.{n}" for n in PIXEL]
    + [f"frame.{n}" for n in FRAME]
    + [f"{s}.{n}" for s in SIDES for n in SIDE]
)


def mirror():
    """Indices and signs that give the features of the frame seen in a mirror, left for right"""
    order = list(range(len(NAMES)))
    sign = np.ones(len(NAMES), np.float32)
    for i, name in enumerate(NAMES):
        group, what = name.split(".")
        if what in ("n_x", "d_x", "bent_x", "screen_x"):
            sign[i] = -1
        if group in ("left", "right"):
            order[i] = NAMES.index(("right" if group == "left" else "left") + "." + what)
    return np.array(order), sign


@dataclasses.dataclass
class Estimate:
    """What one march gives at each pixel, for one radius"""

    ao: np.ndarray
    guessed: np.ndarray  # share of the cosine-weighted hemisphere
    open: np.ndarray  # ao where surfaces end at the border
    bent: np.ndarray  # (H, W, 3), in the space of N
    radius: float  # scene units; inf


def axes(camera, up):
    """Rows right, forward, up of the frame in which directions are given

    up known: upright, with the heading of the camera, continuous also where it looks down.
    up None: the camera's own axes."""
    if up is None:
        return np.stack([camera.right, camera.forward, camera.up])
    flat = lambda v: v - (v @ up) * up
    ahead = flat(camera.forward) - (camera.forward @ up) * flat(camera.up)
    ahead = ahead / np.linalg.norm(ahead)
    return np.stack([np.cross(ahead, up), ahead, up])


def strips(height, width):
    """The pixels whose centres lie along each of SIDES -> 4 slices of rows, 4 of columns"""
    every = slice(None)
    inside = lambda count, other: int(
        np.sum((np.arange(count) + 0.5) / count < SIDE_WIDTH * np.sqrt(other / count))
    )
    down, across = inside(height, width), inside(width, height)
    return (
        (slice(0, down), every),
        (slice(height - down, height), every),
        (every, slice(0, across)),
        (every, slice(width - across, width)),
    )


def mean_along(values, valid, frame):
    """Values (h, w, C) and surfaces of a strip -> share of surfaces, means (C): the frame's where
    nothing is seen"""
    count = max(valid.size, 1)
    covered = valid.sum() / count
    return covered, (values[valid].sum(0) / count + EPSILON * frame) / (covered + EPSILON)


def deviation(square, mean):
    return np.sqrt(np.maximum(square - mean * mean, 0))


class Geometry:
    """What does not depend on the radius, of one G-buffer and one choice of axes"""

    def __init__(self, g, up):
        height, width = g.depth.shape
        c = g.camera
        self.valid, self.axes = g.valid, axes(c, up)
        self.n = g.normal @ self.axes.T
        self.d = c.view_directions(height, width) @ self.axes.T
        self.x, self.y = screen(height, width)
        lens = np.sqrt(c.half_width * c.half_height)
        z = np.where(g.valid, g.depth, 1).astype(np.float64)
        if c.ortho:
            self.extent = np.full_like(z, lens)
            offset = (z - z[g.valid].mean()) / (4 * lens)
        else:
            z = np.maximum(z, 1e-30)
            self.extent = lens * z
            offset = (np.log(z) - np.log(z[g.valid]).mean()) / 2
        self.log_depth = np.clip(np.where(g.valid, offset, 0), -3, 3)
        self.log_lens = -3.0 if c.ortho else float(np.clip(np.log(lens), -3, 1))
        self.log_aspect = float(np.log(width / height))
        self.pitch = 0.0 if up is None else float(c.forward @ up)

    def features(self, e, pixels):
        """Estimate, indices of valid pixels (n) -> (n, len(NAMES)) float32"""
        bent = e.bent @ self.axes.T
        if np.isinf(e.radius):
            log_radius = np.full_like(self.extent, 1.5)
        else:
            log_radius = np.clip(np.log(e.radius / self.extent) / 2, -1.5, 1.5)
        column = lambda v: v[..., None]
        open_minus_ao = e.open - e.ao
        values = np.concatenate(
            [self.n, column(np.abs(self.n[..., 2])), column(self.log_depth)]
            + [column(self.log_depth**2), column(e.ao), column(e.guessed), column(open_minus_ao)]
            + [bent, column(e.ao**2), column(e.guessed**2)],
            -1,
        )
        coverage = self.valid.mean()
        frame = values[self.valid].mean(0)
        at = lambda v: v.reshape(self.valid.size, -1)[pixels]
        x, y = at(self.x)[:, 0], at(self.y)[:, 0]
        own_depth = at(self.log_depth)[:, 0]
        constant = lambda v: np.full(len(pixels), v)
        out = [at(v) for v in (e.ao, e.guessed, open_minus_ao, log_radius, bent, self.n, self.d)]
        out += [x, y, own_depth, -(at(self.n) * at(self.d)).sum(-1)]
        out += [constant(self.log_lens), constant(self.log_aspect)]
        whole = [*frame[:3], np.linalg.norm(frame[:3]), frame[3], deviation(frame[5], frame[4])]
        whole += [coverage, *frame[6:12], deviation(frame[12], frame[6])]
        whole += [deviation(frame[13], frame[7]), self.pitch]
        for strip in strips(*self.valid.shape):
            covered, m = mean_along(values[strip], self.valid[strip], frame)
            whole += [covered, m[4], m[2], m[6], m[7], m[8]]
        out += [constant(v) for v in whole]
        return np.concatenate([v.reshape(len(pixels), -1) for v in out], 1).astype(np.float32)
