# SPDX-License-Identifier: Apache-2.0
"""The error of composites at edges and elsewhere, against an antialiased picture.

    blender -b -P edges.py -- gbuffer.exr picture.exr picture.exr -- relit.exr relit_2x.exr

`gbuffer.exr` is the scene of export.py at the size of the picture, and the picture the mean of those
that were rendered with `--antialiased`, of different seeds. An edge is a pixel within one pixel of
a step in depth or another albedo. Errors are RMSE, relative to the mean of the picture over the
surfaces. Needs oiiotool beside Blender.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from truth import DEPTH, read_channels, rgb  # noqa: E402

DEPTH_STEP = 0.02  # second difference of 1 / depth, which is 0 on planes, relative to it
ALBEDO_STEP = 0.02


def neighbours(plane):
    """The 3x3 values around each pixel, itself among them: [9, height, width]."""
    wide = np.pad(plane, 1, mode="edge")
    height, width = plane.shape
    return np.stack([wide[y:y + height, x:x + width] for y in range(3) for x in range(3)])


def find_edges(depth, albedo):
    inverse = 1 / np.minimum(depth, 1e4)
    around = neighbours(inverse)
    bends = np.maximum(abs(around[1] + around[7] - 2 * inverse),
                       abs(around[3] + around[5] - 2 * inverse))
    step = neighbours(bends > DEPTH_STEP * inverse).any(axis=0)
    for channel in np.moveaxis(albedo, -1, 0):
        near = neighbours(channel)
        step |= near.max(axis=0) - near.min(axis=0) > ALBEDO_STEP
    step[[0, -1]] = step[:, [0, -1]] = False
    return step & ~neighbours(depth > 1e9).all(axis=0)


def main():
    words = sys.argv[sys.argv.index("--") + 1:]
    split = words.index("--")
    gbuffer, *pictures = [Path(word) for word in words[:split]]
    depth = read_channels(gbuffer, DEPTH)[..., 0]
    edges = find_edges(depth, read_channels(gbuffer, rgb("DiffCol")))
    elsewhere = ~edges & (depth < 1e9)
    picture = np.mean([read_channels(path, rgb("Combined")) for path in pictures], axis=0)
    mean = picture[edges | elsewhere].mean()
    print(f"edges: {edges.mean():.1%} of the pixels")
    for composite in words[split + 1:]:
        off = read_channels(Path(composite), "R,G,B") - picture
        at_edges, other = (np.sqrt(np.mean(off[where]**2)) / mean for where in (edges, elsewhere))
        print(f"{composite}: edges {at_edges:.3f}, elsewhere {other:.3f}")


main()
