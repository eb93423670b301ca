# SPDX-License-Identifier: Apache-2.0
"""G-buffers as EXR files, and the camera that made one, from its positions alone"""
import dataclasses

import numpy as np
import OpenImageIO as oiio


def read_channels(path):
    """-> {channel name: (H, W) float32}"""
    file = oiio.ImageInput.open(path)
    if file is None:
        raise OSError(f"{path}: cannot open: {oiio.geterror()}")
    spec = file.spec()
    pixels = file.read_image("float")
    file.close()
    if pixels is None:
        raise OSError(f"{path}: cannot read")
    pixels = np.asarray(pixels, np.float32).reshape(spec.height, spec.width, -1)
    return {name: pixels[..., k] for k, name in enumerate(spec.channelnames)}


def layer(channels, name, parts="XYZ"):
    """-> (H, W, len(parts)), e.g. layer(c, "bent"), layer(c, "direct", "RGB")"""
    return np.stack([channels[f"{name}.{p}"] for p in parts], -1)


@dataclasses.dataclass
class Camera:
    right: np.ndarray  # unit vectors, in the space of P
    up: np.ndarray
    forward: np.ndarray
    half_width: float  # at depth 1; orthographic: in scene units
    half_height: float
    ortho: bool

    def view_directions(self, height, width):
        """Unit directions from the camera to the centres of the pixels -> (H, W, 3)"""
        x, y = screen(height, width)
        if self.ortho:
            return np.broadcast_to(self.forward, (height, width, 3))
        d = (
            self.forward
            + (x * self.half_width)[..., None] * self.right
            + (y * self.half_height)[..., None] * self.up
        )
        return d / np.linalg.norm(d, axis=-1, keepdims=True)


@dataclasses.dataclass
class GBuffer:
    depth: np.ndarray  # planar
    position: np.ndarray
    normal: np.ndarray  # unit
    valid: np.ndarray  # a surface is there
    camera: Camera


def screen(height, width):
    """Places of the pixel centres: x in -1..1 to the right, y in -1..1 upwards"""
    row, column = np.mgrid[0:height, 0:width]
    return 2 * (column + 0.5) / width - 1, 1 - 2 * (row + 0.5) / height


def fit_camera(position, depth, valid):
    """Least squares of P = C + z (x A + y B + F), or C + x A + y B + z F if orthographic"""
    height, width = depth.shape
    x, y = (v.ravel() for v in screen(height, width))
    some = np.flatnonzero(valid.ravel())
    some = some[np.linspace(0, len(some) - 1, min(len(some), 3000)).astype(int)]
    p = position.reshape(-1, 3)[some].astype(np.float64)
    z = depth.ravel()[some].astype(np.float64)
    x, y = x[some], y[some]
    centre = p.mean(0)
    size = np.abs(p - centre).max() + 1e-9
    q, t = (p - centre) / size, z / size
    weight = 1 / np.maximum(t, 1e-6)[:, None]
    best = None
    for ortho in (False, True):
        columns = (x, y, t) if ortho else (t * x, t * y, t)
        m = np.stack([np.ones_like(x), *columns], 1)
        fit = np.linalg.lstsq(m * weight, q * weight, rcond=None)[0]
        error = np.median(np.abs((m @ fit - q) * weight))
        if best is None or error < 0.5 * best[0]:
            best = error, ortho, fit
    _, ortho, fit = best
    a, b, f = fit[1:] * (size if ortho else 1)
    unit = lambda v: v / np.linalg.norm(v)
    return Camera(
        unit(a), unit(b), unit(fit[3]), float(np.linalg.norm(a)), float(np.linalg.norm(b)), ortho
    )


def read_gbuffer(path):
    c = read_channels(path)
    depth, position = c["ViewLayer.Depth.Z"], layer(c, "ViewLayer.Position")
    normal = layer(c, "ViewLayer.Normal")
    length = np.linalg.norm(normal, axis=-1)
    valid = (depth < 1e9) & (length > 0)
    normal = normal / np.maximum(length, 1e-6)[..., None]
    return GBuffer(depth, position, normal, valid, fit_camera(position, depth, valid))
