# SPDX-License-Identifier: Apache-2.0
"""Writes the lamps of a scene to a file for `ssdo --lights`.

    blender scene.blend -b -P lamps.py -- lamps.json

export.py does so for the scenes of data/. Blender gives a lamp a power C in watts; the radiance of a
point lamp of radius r is C / (4 pi^2 r^2), that of an area lamp of area A is C / (4 A), and a sun of
strength E gives a surface that faces it the irradiance E, all times the lamp's colour. In a file of
lamps, `intensity` with `normalize` is radiance times area, and for a distant light irradiance.
"""
import json
import re
import sys
from math import acos, cos, degrees, pi
from pathlib import Path

import bpy

SMALLEST_RADIUS = 1e-3  # metres: a spot without a size


def warn(lamp, text):
    print(f"{lamp.name}: {text}", file=sys.stderr)


def color_and_gain(lamp):
    """Linear colour of a lamp, and what its nodes multiply the power by."""
    color, gain = list(lamp.color), 1.0
    if not lamp.use_nodes:
        return color, gain
    emissions = [n for n in lamp.node_tree.nodes if n.type == "EMISSION"]
    if len(emissions) != 1 or any(i.is_linked for i in emissions[0].inputs):
        warn(lamp, "has nodes that vary its light; they are left out")
        return color, gain
    inputs = emissions[0].inputs
    of_node = inputs["Color"].default_value
    return [a * b for a, b in zip(color, of_node)], inputs["Strength"].default_value


def spot_cone(lamp):
    """Blender fades a spot by the cosine to its axis, from where it is all there to its border; a
    file of lamps has that border and the share of the angle that fades."""
    border = lamp.spot_size / 2
    inner = acos(cos(border) + (1 - cos(border)) * lamp.spot_blend)
    return {"cone_angle": degrees(border), "cone_softness": 1 - inner / border}


def shape(lamp, scale):
    """Keys of the type of a lamp. Blender turns a point or spot towards each surface, so that it
    looks like a ball; that a spot's light also falls with the cosine to its axis makes it a disk."""
    watts = lamp.energy
    if lamp.type == "POINT":
        return {"type": "sphere", "radius": lamp.shadow_soft_size, "intensity": watts / pi}
    if lamp.type == "SPOT":
        return {"type": "disk", "radius": max(lamp.shadow_soft_size, SMALLEST_RADIUS),
                "intensity": watts / (4 * pi), **spot_cone(lamp)}
    if lamp.type == "SUN":
        return {"type": "distant", "angle": degrees(lamp.angle), "intensity": watts}
    width, height = lamp.size * scale.x, lamp.size * scale.y
    if lamp.shape in ("RECTANGLE", "ELLIPSE"):
        height = lamp.size_y * scale.y
    if lamp.spread < pi - 1e-4:
        warn(lamp, "has a spread of less than 180 degrees, which is left out")
    if lamp.shape in ("SQUARE", "RECTANGLE"):
        return {"type": "rect", "width": width, "height": height, "intensity": watts / 4}
    if abs(width - height) > 1e-3 * max(width, height):
        warn(lamp, "is an ellipse; it becomes a disk of the same area")
    return {"type": "disk", "radius": (width * height) ** 0.5 / 2, "intensity": watts / 4}


def unique_name(name, taken):
    """Layers have the names of their lamps: letters, digits and _."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", name)
    unique = name
    number = 2
    while unique in taken or unique == "env":
        unique, number = f"{name}_{number}", number + 1
    taken.add(unique)
    return unique


def lamps_json():
    """The lamps that the scene is rendered with, in world space."""
    lamps, taken = [], set()
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        thing = instance.object
        if thing.type != "LIGHT" or thing.hide_render or not instance.show_self:
            continue
        lamp, matrix = thing.data, instance.matrix_world
        color, gain = color_and_gain(lamp)
        keys = shape(lamp, matrix.to_scale())
        keys["intensity"] *= gain
        if lamp.type == "SUN":
            place = {}
        else:
            place = {"position": list(matrix.translation)}
        turn = matrix.to_quaternion().to_matrix()
        place["direction"], place["up"] = list(-turn.col[2]), list(turn.col[1])
        lamps.append({"name": unique_name(thing.name, taken), **keys, "normalize": True,
                      "color": color, **place})
    return {"lights": lamps}


def rounded(value):
    """Blender's numbers have single precision: seven digits."""
    if isinstance(value, float):
        return float(f"{value:.7g}") + 0.0  # no -0
    if isinstance(value, dict):
        return {key: rounded(part) for key, part in value.items()}
    return [rounded(part) for part in value] if isinstance(value, list) else value


def write_lamps(path):
    """One lamp on each line."""
    lamps = ",\n".join("  " + json.dumps(rounded(lamp)) for lamp in lamps_json()["lights"])
    path.write_text(f'{{"lights": [\n{lamps}\n]}}\n')


if __name__ == "__main__":
    write_lamps(Path(sys.argv[sys.argv.index("--") + 1]))
