# SPDX-License-Identifier: Apache-2.0
"""Inputs of the prior. README.md states each of them; the order is that of NAMES."""
import dataclasses

import numpy as np

from gbuffer import screen

EPSILON = 1e-3  # weight of the frame's mean in cells that show little
CELLS = 48  # of a square frame, per side, at the finest level
LEVELS = (1, 4, 12)  # cells of the finest level per cell of a level


PIXEL = (
    "ao guessed open_minus_ao log_radius bent_x bent_y bent_z n_x n_y n_z d_x d_y d_z "
    "screen_x screen_y log_depth facing log_lens log_aspect"
).split()
CONTEXT = (
    "n_x n_y n_z n_length n_up_abs depth_off depth_dev coverage ao guessed open_minus_ao bent_z"
).split()
FRAME = (
    "n_x n_y n_z n_length n_up_abs depth_dev coverage ao guessed open_minus_ao bent_x bent_y "
    "bent_z ao_dev guessed_dev pitch"
).split()
SIDE = "coverage log_depth n_z ao guessed open_minus_ao".split()
NAMES = (
    [f"pixel.{n}" for n in PIXEL]
    + [f"level{k}.{n}" for k in range(len(LEVELS)) for n in CONTEXT]
    + [f"frame.{n}" for n in FRAME]
    + [f"{s}.{n}" for s in ("top", "bottom", "left", "right") for n in SIDE]
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


def grid_size(height, width, level):
    """Cells across and down: about square, CELLS^2 in all at level 0"""
    a = np.sqrt(width / height)
    n = lambda v: max(1, int(v / LEVELS[level] + 0.5))
    return n(CELLS * a), n(CELLS / a)


def grids(values, valid):
    """Sums over the valid pixels of each cell, divided by the number of its pixels, of 1 and the
    values (H, W, C) -> a list by level of (rows, columns, 1 + C). A pixel belongs to the cell that
    holds its centre; a cell of a coarser level is the mean of the finest level's cells whose
    centres it holds. The picture has at least as many pixels as cells, each way."""
    height, width = valid.shape
    v = np.concatenate([np.ones_like(values[..., :1]), values], -1) * valid[..., None]
    out = []
    for level in range(len(LEVELS)):
        columns, rows = grid_size(height, width, level)
        column = (2 * np.arange(v.shape[1]) + 1) * columns // (2 * v.shape[1])
        row = (2 * np.arange(v.shape[0]) + 1) * rows // (2 * v.shape[0])
        first = lambda index: np.flatnonzero(np.diff(index, prepend=-1))
        down = np.add.reduceat(v, first(row), axis=0)
        cells = np.add.reduceat(down, first(column), axis=1)
        count = np.bincount(row, minlength=rows)[:, None] * np.bincount(column, minlength=columns)
        out.append(cells / np.maximum(count, 1)[..., None])
        if level == 0:
            v = out[0]
    return out


def lookup(grid, x, y):
    """Bilinear, clamped at the border; x, y: places on screen -> (n, C)"""
    rows, columns, _ = grid.shape
    u = np.clip((x + 1) / 2 * columns - 0.5, 0, columns - 1)
    v = np.clip((1 - y) / 2 * rows - 0.5, 0, rows - 1)
    i = np.minimum(u.astype(int), max(columns - 2, 0))
    j = np.minimum(v.astype(int), max(rows - 2, 0))
    s, t = (u - i)[:, None], (v - j)[:, None]
    i1, j1 = np.minimum(i + 1, columns - 1), np.minimum(j + 1, rows - 1)
    top = grid[j, i] * (1 - s) + grid[j, i1] * s
    bottom = grid[j1, i] * (1 - s) + grid[j1, i1] * s
    return top * (1 - t) + bottom * t


def means(sums, frame):
    """Sums with their coverage (..., 1 + C) -> means (..., C), the frame's where nothing is seen"""
    return (sums[..., 1:] + EPSILON * frame) / (sums[..., :1] + EPSILON)


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
        levels = grids(values, self.valid)
        coverage = self.valid.mean()
        frame = values[self.valid].mean(0)
        at = lambda v: v.reshape(self.valid.size, -1)[pixels]
        x, y = at(self.x)[:, 0], at(self.y)[:, 0]
        own_depth = at(self.log_depth)[:, 0]
        constant = lambda v: np.full(len(pixels), v)
        out = [at(v) for v in (e.ao, e.guessed, open_minus_ao, log_radius, bent, self.n, self.d)]
        out += [x, y, own_depth, -(at(self.n) * at(self.d)).sum(-1)]
        out += [constant(self.log_lens), constant(self.log_aspect)]
        for grid in levels:
            sums = lookup(grid, x, y)
            m = means(sums, frame)
            out += [m[:, :3], np.linalg.norm(m[:, :3], axis=1), m[:, 3], m[:, 4] - own_depth]
            out += [deviation(m[:, 5], m[:, 4]), sums[:, 0], m[:, 6:9], m[:, 11]]
        whole = [*frame[:3], np.linalg.norm(frame[:3]), frame[3], deviation(frame[5], frame[4])]
        whole += [coverage, *frame[6:12], deviation(frame[12], frame[6])]
        whole += [deviation(frame[13], frame[7]), self.pitch]
        middle = levels[1]
        for side in (middle[0], middle[-1], middle[:, 0], middle[:, -1]):
            sums = side.mean(0)
            m = means(sums, frame)
            whole += [sums[0], m[4], m[2], m[6], m[7], m[8]]
        out += [constant(v) for v in whole]
        return np.concatenate([v.reshape(len(pixels), -1) for v in out], 1).astype(np.float32)
