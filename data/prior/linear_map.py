# SPDX-License-Identifier: Apache-2.0
"""linear_map.py OUT.exr: a lat-long map of radiance 1 + x, 1 + y, 1 + z, with z as its pole

Direct light under it holds moments 0 and 1 of the visibility: its channels are E0 + Ex, E0 + Ey,
E0 + Ez, where E0 is ao and Ex the cosine-weighted mean of V x."""
import sys

import numpy as np
import OpenImageIO as oiio


def main():
    w, h = 128, 64
    f = (0.5 - (np.arange(w) + 0.5) / w) * 2 * np.pi
    t = (np.arange(h) + 0.5) / h * np.pi
    x = np.sin(t)[:, None] * np.cos(f)
    y = np.sin(t)[:, None] * np.sin(f)
    z = np.repeat(np.cos(t)[:, None], w, 1)
    file = oiio.ImageOutput.create(sys.argv[1])
    file.open(sys.argv[1], oiio.ImageSpec(w, h, 3, "float"))
    file.write_image(np.stack([1 + x, 1 + y, 1 + z], 2).astype(np.float32))
    file.close()


if __name__ == "__main__":
    main()
