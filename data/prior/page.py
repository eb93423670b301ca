# SPDX-License-Identifier: Apache-2.0
"""page.py OUT.jpg COLUMNS PICTURE... : a page of thumbnails, each fitted into 200 x 113 pixels"""
import sys

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT = 200, 113


def thumbnail(path):
    """-> (HEIGHT, WIDTH, 3) floats in 0..1, the picture in the middle of a dark field"""
    buf = oiio.ImageBuf(path)
    spec = buf.spec()
    scale = min(WIDTH / spec.width, HEIGHT / spec.height)
    w, h = int(spec.width * scale), int(spec.height * scale)
    small = oiio.ImageBufAlgo.resize(buf, roi=oiio.ROI(0, w, 0, h, 0, 1, 0, min(3, spec.nchannels)))
    pixels = np.asarray(small.get_pixels(oiio.FLOAT)).reshape(h, w, -1)
    field = np.full((HEIGHT, WIDTH, 3), 0.12, np.float32)
    y, x = (HEIGHT - h) // 2, (WIDTH - w) // 2
    field[y : y + h, x : x + w] = pixels[..., :3]
    return field


def main():
    out, columns, paths = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    rows = -(-len(paths) // columns)
    page = np.zeros((rows * HEIGHT, columns * WIDTH, 3), np.float32)
    for i, path in enumerate(paths):
        y, x = i // columns * HEIGHT, i % columns * WIDTH
        page[y : y + HEIGHT, x : x + WIDTH] = thumbnail(path)
    file = oiio.ImageOutput.create(out)
    spec = oiio.ImageSpec(page.shape[1], page.shape[0], 3, "uint8")
    spec.attribute("CompressionQuality", 62)
    file.open(out, spec)
    file.write_image(np.clip(page, 0, 1))
    file.close()


if __name__ == "__main__":
    main()
