# SPDX-License-Identifier: Apache-2.0
"""Makes this folder from the scene it is a smaller copy of: make.py SCENE_FOLDER ENVIRONMENT.

The scene is a box with blocks, a ball, a teapot and a head in it, open to the viewer, path-traced by
Blender Cycles under a map of Poly Haven (CC0). Here are its G-buffer, the same with overscan, four
other views, and the truth of ao at two radii and without one, of direct light and of one bounce, under the
map and under each of three lamps alone, and of light that all surfaces mirror (GGX of two roughnesses,
colour 1, no Fresnel, no bounces).

Every third pixel of every third row is kept, the middle one of its block, and every fourth of the
panorama, whose size three does not divide. So P still lies in the middle of its pixel, and the truth
is that of the pixel: nothing is averaged. The environment is averaged over blocks of 4 x 4.
"""
import json
import os
import sys
from math import acos, cos, degrees, pi, radians

import numpy
import OpenImageIO as oiio

HERE = os.path.dirname(os.path.abspath(__file__))
HALF, FLOAT = oiio.TypeDesc("half"), oiio.TypeDesc("float")


def read(path):
    image = oiio.ImageBuf(path)
    return image.get_pixels(oiio.FLOAT), image.spec()


def write(name, pixels, channels, floats=(), window=(0, 0), display=None):
    height, width = pixels.shape[:2]
    spec = oiio.ImageSpec(width, height, len(channels), oiio.FLOAT)
    spec.x, spec.y = window
    spec.full_x, spec.full_y = 0, 0
    spec.full_width, spec.full_height = display or (width, height)
    spec.channelnames = channels
    spec.channelformats = [FLOAT if c.split(".")[-2:][0] in floats else HALF for c in channels]
    spec.attribute("compression", "zip")
    out = oiio.ImageOutput.create(name)
    if not out.open(os.path.join(HERE, name), spec):
        sys.exit(out.geterror())
    out.write_image(numpy.ascontiguousarray(pixels))
    out.close()


def keep(source, name, layers, stride=3):
    pixels, spec = read(source)
    middle = stride // 2
    columns = [x for x in range(spec.x, spec.x + spec.width) if x % stride == middle]
    rows = [y for y in range(spec.y, spec.y + spec.height) if y % stride == middle]
    channels = [c for c in spec.channelnames if c.split(".")[1] in layers]
    at = numpy.ix_([y - spec.y for y in rows], [x - spec.x for x in columns],
                   [spec.channelnames.index(c) for c in channels])
    overscan = (spec.full_width, spec.full_height) != (spec.width, spec.height)
    display = (spec.full_width // stride, spec.full_height // stride) if overscan else None
    write(name, pixels[at], channels, ("Position", "Depth"),
          (columns[0] // stride, rows[0] // stride), display)


def lamp(name, blender):
    """A lamp for `ssdo --lights`, as data/blender/lamps.py makes it from Blender's values."""
    turn = numpy.array(blender["matrix"])[:3, :3]
    power = blender["power"]
    if blender["type"] == "area":
        keys = {"type": "rect", "width": blender["size"][0], "height": blender["size"][1],
                "intensity": power / 4}
    elif blender["type"] == "spot":
        border = radians(blender["spot_angle_deg"]) / 2
        inner = acos(cos(border) + (1 - cos(border)) * blender["blend"])
        keys = {"type": "disk", "radius": blender["radius"], "intensity": power / (4 * pi),
                "cone_angle": degrees(border), "cone_softness": 1 - inner / border,
                "cone_by_cosine": True}
    else:
        keys = {"type": "sphere", "radius": blender["radius"], "intensity": power / pi,
                "soft_falloff": True}
    return {"name": name, **keys, "normalize": True, "color": blender["colour"],
            "position": blender["location"], "direction": list(-turn[:, 2]), "up": list(turn[:, 1])}


def main():
    scene, environment = sys.argv[1:]
    with open(f"{scene}/lights.json") as file:
        lights = json.load(file)["lights"]
    for name, values in lights.items():
        with open(os.path.join(HERE, f"light_{name}.json"), "w") as file:
            json.dump({"lights": [lamp(name, values)]}, file, indent=1)
            file.write("\n")
        for part in ("direct", "bounce"):
            keep(f"{scene}/truth_light_{name}_{part}.exr", f"truth_light_{name}_{part}.exr",
                 ("DiffDir", "DiffInd"))
    for name in ("gbuffer", "overscan", "also_left", "also_right", "also_top", "also_pano"):
        keep(f"{scene}/{name}.exr", name + ".exr", ("Position", "Depth", "Normal", "DiffCol"),
             4 if name == "also_pano" else 3)
    for name in ("ao_0.5", "ao_2", "white", "env_direct", "env_bounce1", "gloss_0.2_white",
                 "gloss_0.5_env"):
        keep(f"{scene}/truth_{name}.exr", f"truth_{name}.exr",
             ("AO", "DiffDir", "DiffInd", "GlossDir"))
    pixels, spec = read(environment)
    blocks = pixels.reshape(spec.height // 4, 4, spec.width // 4, 4, -1)[..., :3].mean(axis=(1, 3))
    write("environment.exr", blocks, ["R", "G", "B"])


main()
