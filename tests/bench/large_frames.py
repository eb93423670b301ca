#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Time and memory of frames from 1080p to 16384 x 16384.

    tests/bench/large_frames.py SSDO FRAME.exr [SSDO options]

FRAME.exr, of Blender, is enlarged: every pixel becomes n x n, whose P lie on its tangent plane under
the frame's own camera, so that the large frame is a frame of the same scene. Frames stay in
$LARGE_FRAMES (a temporary folder if not set; 16384 x 16384 takes about 3 GB). $SIZES picks some, as
in SIZES=1920x1080,3840x2160. Every size runs once: as it is, and those up to 8K once more under
half of the memory that they took.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np
import OpenImageIO as oiio

SIZES = "1920x1080,3840x2160,7680x4320,16384x16384"
LAYER = "ViewLayer."
CHANNELS = [LAYER + c for c in ("Position.X", "Position.Y", "Position.Z", "Normal.X", "Normal.Y",
                                "Normal.Z", "DiffCol.R", "DiffCol.G", "DiffCol.B")]


def read(path):
    image = oiio.ImageInput.open(path)
    names = image.spec().channelnames
    pixels = image.read_image(oiio.FLOAT)
    image.close()
    return pixels[..., [names.index(c) for c in CHANNELS]]


def fit_rays(position, normal):
    """The camera's place, and the matrix from (x / w, y / w, 1) about the middle to a ray."""
    h, w = position.shape[:2]
    surfaces = np.flatnonzero(normal.any(-1))  # P of the background is of no ray
    chosen = np.random.default_rng(0).choice(surfaces, min(surfaces.size, 4000), False)
    points = position.reshape(-1, 3)[chosen].astype(np.float64)
    u = (chosen % w + 0.5 - w / 2) / w
    v = (chosen // w + 0.5 - h / 2) / w
    middle, scale = points.mean(0), points.std()
    homogeneous = np.c_[(points - middle) / scale, np.ones(len(points))]
    rows = np.zeros((2 * len(points), 12))
    rows[0::2, 0:4], rows[0::2, 8:12] = homogeneous, -u[:, None] * homogeneous
    rows[1::2, 4:8], rows[1::2, 8:12] = homogeneous, -v[:, None] * homogeneous
    matrix = np.linalg.svd(rows, full_matrices=False)[2][-1].reshape(3, 4)
    place = -np.linalg.solve(matrix[:, :3], matrix[:, 3]) * scale + middle
    return place, np.linalg.inv(matrix[:, :3])


def enlarge(pixels, place, to_ray, first, count, x0, columns, n, w, h):
    """Rows `first` to `first + count` of the part from column x0 on, each pixel n x n."""
    part = pixels[first:first + count, x0:x0 + columns].astype(np.float64)
    large = np.repeat(np.repeat(part, n, 0), n, 1)
    y, x = np.mgrid[0:count * n, 0:columns * n]
    u = ((x + 0.5) / n + x0 - w / 2) / w
    v = ((y + 0.5) / n + first - h / 2) / w
    ray = np.stack([u, v, np.ones_like(u)], -1) @ to_ray.T
    old, normal = large[..., 0:3] - place, large[..., 3:6]
    with np.errstate(all="ignore"):
        along = (old * normal).sum(-1) / (ray * normal).sum(-1)
    new = along[..., None] * ray
    length = np.linalg.norm(old, axis=-1)
    # Next to silhouettes the plane is seen edge-on: there the distance stays.
    off = ~(np.abs(np.linalg.norm(new, axis=-1) - length) < 0.02 * length)
    off |= (new * old).sum(-1) < 0
    toward = ray * np.sign((ray * old).sum(-1))[..., None]
    same = toward * (length / np.linalg.norm(ray, axis=-1))[..., None]
    large[..., 0:3] = np.where(off[..., None], same, new) + place
    return large.astype(np.float32)


def make_frame(source, width, height, path):
    pixels = read(source)
    h, w = pixels.shape[:2]
    place, to_ray = fit_rays(pixels[..., 0:3], pixels[..., 3:6])
    n = max(-(-width // w), -(-height // h))
    columns, rows = -(-width // n), -(-height // n)
    x0, y0 = (w - columns) // 2, (h - rows) // 2
    spec = oiio.ImageSpec(width, height, len(CHANNELS), oiio.FLOAT)
    spec.channelnames = CHANNELS
    spec.channelformats = [oiio.FLOAT] * 3 + [oiio.HALF] * 6
    spec.attribute("compression", "zip:1")
    out = oiio.ImageOutput.create(path)
    out.open(path, spec)
    per_strip = max(1, 64 // n)
    for row in range(0, rows, per_strip):
        count = min(per_strip, rows - row)
        strip = enlarge(pixels, place, to_ray, y0 + row, count, x0, columns, n, w, h)
        first, last = row * n, min((row + count) * n, height)
        out.write_scanlines(first, last, 0, np.ascontiguousarray(strip[:last - first, :width]))
    out.close()


def run(ssdo, frame, options):
    with tempfile.TemporaryDirectory() as folder:
        stats = os.path.join(folder, "stats.json")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([ssdo, frame, "-o", os.path.join(folder, "out.exr"), "-q", "--stats", stats,
                        *options], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(stats) as file:
            found = json.load(file)[0]
    found["cpu"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return found


def show(size, limit, found):
    pixels = found["width"] * found["height"]
    bands = [r for r in found["plan"]["reasons"] if " bands of " in r]
    print(f"{size:>13} {limit:>7} {found['cpu']:8.1f} {found['stages_ms']['total'] / 1000:8.1f} "
          f"{1e6 * found['cpu'] / pixels:7.2f} {found['peak_rss_bytes'] / 1e9:7.2f} "
          f"{found['peak_rss_bytes'] / pixels:6.0f}  {bands[0].split(',')[0] if bands else ''}",
          flush=True)


def main():
    ssdo, source, *options = sys.argv[1:]
    folder = os.environ.get("LARGE_FRAMES") or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    print(f"{'frame':>13} {'limit':>7} {'CPU s':>8} {'wall s':>8} {'us/px':>7} {'GB':>7} {'B/px':>6}")
    for size in os.environ.get("SIZES", SIZES).split(","):
        width, height = map(int, size.split("x"))
        path = os.path.join(folder, size + ".exr")
        if not os.path.exists(path):
            make_frame(source, width, height, path + ".part.exr")
            os.rename(path + ".part.exr", path)
        if width * height <= 40e6:
            found = run(ssdo, path, options)
            show(size, "", found)
            if height >= 2160:
                half = f"{int(found['peak_rss_bytes'] / 2 / 2**20)}M"
                show(size, half, run(ssdo, path, [*options, "--mem-limit", half]))
        else:
            show(size, "7.4G", run(ssdo, path, [*options, "--mem-limit", "7.4G"]))


if __name__ == "__main__":
    main()
