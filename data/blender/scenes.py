# SPDX-License-Identifier: Apache-2.0
"""The scenes of data/, built from Blender's primitives. Deterministic: the same meshes every time.

World z up, metres. Every surface is a Diffuse BSDF of one colour and roughness 0, that is,
Lambertian: what ssdo assumes. Objects are put down by their lowest vertex, so contacts are exact.
"""
import random
from dataclasses import dataclass
from math import cos, inf, pi, radians, sin
from typing import Callable

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector

# Long edges are split: over a large triangle, float32 barycentrics would move P off its pixel.
# This way every P projects to within 0.006 px of its pixel's centre.
LONGEST_EDGE = 0.15

CREAM, ORANGE, RED = (0.72, 0.68, 0.60), (0.78, 0.32, 0.10), (0.72, 0.10, 0.10)
BLUE, GREEN, YELLOW = (0.10, 0.22, 0.70), (0.14, 0.56, 0.18), (0.80, 0.62, 0.12)
TEAL, PURPLE, WHITE = (0.10, 0.50, 0.52), (0.42, 0.14, 0.56), (0.80, 0.80, 0.80)
DARK_GREEN, SAND, SLATE = (0.10, 0.24, 0.11), (0.46, 0.42, 0.37), (0.20, 0.22, 0.26)


@dataclass(frozen=True)
class Scene:
    """A picture: who builds the objects, where the camera stands, what lights it."""

    build: Callable[[], None]
    width: int
    height: int
    camera: tuple
    target: tuple
    hfov_deg: float
    environment: str  # file in data/environments
    ao_radii: tuple  # metres; the short one for contacts, the long one about a hero's size
    lamps: tuple = ()  # each a Lamp; they light only what asks for them


@dataclass(frozen=True)
class Lamp:
    """A lamp as Blender has it: type and properties of its data, and where it looks."""

    name: str
    type: str
    at: tuple
    to: tuple
    watts: float
    color: tuple
    more: dict

    def put(self):
        data = bpy.data.lights.new(self.name, self.type)
        data.energy, data.color = self.watts, self.color
        for key, value in self.more.items():
            setattr(data, key, value)
        thing = bpy.data.objects.new(self.name, data)
        thing.location = self.at
        toward = Vector(self.to) - Vector(self.at)
        thing.rotation_euler = toward.to_track_quat("-Z", "Y").to_euler()
        bpy.context.scene.collection.objects.link(thing)


def diffuse(albedo):
    material = bpy.data.materials.new("diffuse")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    bsdf = nodes.new("ShaderNodeBsdfDiffuse")
    bsdf.inputs["Color"].default_value = (*albedo, 1.0)
    bsdf.inputs["Roughness"].default_value = 0.0
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])
    return material


def put(name, mesh, albedo, at, on=0.0, turn=(0, 0, 0), size=1, smooth=False,
        longest_edge=LONGEST_EDGE):
    """Scales, turns (degrees) and moves a bmesh to x, y = `at`, its lowest point at z = `on`.

    Returns the z of its highest point, so that the next object can stand on it.
    """
    if isinstance(size, (int, float)):
        size = (size,) * 3
    turned = Euler([radians(a) for a in turn]).to_matrix().to_4x4()
    mesh.transform(turned @ Matrix.Diagonal((*size, 1.0)))
    heights = [v.co.z for v in mesh.verts]
    mesh.transform(Matrix.Translation(Vector((at[0], at[1], on - min(heights)))))

    while long_edges := [e for e in mesh.edges if e.calc_length() > longest_edge]:
        bmesh.ops.subdivide_edges(mesh, edges=long_edges, cuts=1, use_grid_fill=True)
    for face in mesh.faces:
        face.smooth = smooth
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(diffuse(albedo))
    bpy.context.collection.objects.link(bpy.data.objects.new(name, data))
    return on + max(heights) - min(heights)


def box():
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1.0)
    return mesh


def cylinder(top=0.5, segments=128):
    """Diameter and height 1; `top` is the upper radius: 0 makes a cone."""
    mesh = bmesh.new()
    bmesh.ops.create_cone(mesh, cap_ends=True, cap_tris=True, segments=segments, radius1=0.5,
                          radius2=top, depth=1.0)
    return mesh


def sphere():
    mesh = bmesh.new()
    bmesh.ops.create_uvsphere(mesh, u_segments=96, v_segments=64, radius=0.5)
    return mesh


def icosphere(subdivisions=1):
    mesh = bmesh.new()
    bmesh.ops.create_icosphere(mesh, subdivisions=subdivisions, radius=0.5)
    return mesh


def torus(minor, major_segments=96, minor_segments=32):
    """Outer diameter 1 and tube radius `minor`, lying flat."""
    mesh = bmesh.new()
    rings = []
    for i in range(major_segments):
        a = 2 * pi * i / major_segments
        radii = [(0.5 - minor + minor * cos(b), minor * sin(b))
                 for b in (2 * pi * j / minor_segments for j in range(minor_segments))]
        rings.append([mesh.verts.new((r * cos(a), r * sin(a), z)) for r, z in radii])
    for i, ring in enumerate(rings):
        following = rings[(i + 1) % major_segments]
        for j in range(minor_segments):
            k = (j + 1) % minor_segments
            mesh.faces.new((ring[j], following[j], following[k], ring[k]))
    return mesh


def monkey(levels=3):
    """Suzanne after Catmull-Clark subdivision."""
    source = bmesh.new()
    bmesh.ops.create_monkey(source)
    data = bpy.data.meshes.new("suzanne")
    source.to_mesh(data)
    source.free()
    cage = bpy.data.objects.new("cage", data)
    bpy.context.collection.objects.link(cage)
    cage.modifiers.new("smooth", "SUBSURF").levels = levels
    mesh = bmesh.new()
    mesh.from_object(cage, bpy.context.evaluated_depsgraph_get())
    bpy.data.objects.remove(cage)
    return mesh


def disc(radius, innermost=0.4, segments=144):
    """Flat ground to the horizon; rings widen with the distance, so that cells stay square."""
    mesh = bmesh.new()
    spokes = [(cos(2 * pi * i / segments), sin(2 * pi * i / segments)) for i in range(segments)]
    radii = [innermost]
    while radii[-1] < radius:
        radii.append(radii[-1] * (1 + 2 * pi / segments))
    rings = [[mesh.verts.new((r * x, r * y, 0)) for x, y in spokes] for r in radii]
    mesh.faces.new(rings[0])
    for inner, outer in zip(rings, rings[1:]):
        for i in range(segments):
            j = (i + 1) % segments
            mesh.faces.new((inner[i], outer[i], outer[j], inner[j]))
    return mesh


def still_life():
    """Suzanne among toys: round and flat, stacked, leaning and thin things, all touching."""
    put("ground", disc(300), SAND, (0, 0), longest_edge=inf)

    top = put("plinth", cylinder(), CREAM, (0, 0), size=(2.3, 2.3, 0.24))
    put("suzanne", monkey(), ORANGE, (0, 0.15), on=top, turn=(-14, 0, 16), size=0.92, smooth=True)

    top = put("block", box(), BLUE, (-2.5, 0.5), turn=(0, 0, 24), size=0.95)
    top = put("block", box(), YELLOW, (-2.45, 0.45), on=top, turn=(0, 0, -12), size=0.64)
    top = put("block", box(), GREEN, (-2.5, 0.5), on=top, turn=(0, 0, 40), size=0.46)
    put("finial", cylinder(top=0.0), RED, (-2.5, 0.5), on=top, size=(0.38, 0.38, 0.56))

    # The white ball touches a red box on its right: colour bleeding to look for.
    put("red box", box(), RED, (2.62, -0.25), size=(0.8, 1.1, 0.8))
    put("ball", sphere(), WHITE, (1.77, -0.45), size=0.9, smooth=True)
    put("ball", sphere(), TEAL, (2.66, -0.2), on=0.8, size=0.5, smooth=True)

    top = 0.0
    for diameter, albedo in ((1.0, PURPLE), (0.82, TEAL), (0.64, YELLOW)):
        top = put("ring", torus(0.14), albedo, (-1.45, -1.45), on=top, size=diameter, smooth=True)
    put("ring's ball", icosphere(5), RED, (-1.45, -1.45), on=top - 0.12, size=0.38, smooth=True)

    put("cone", cylinder(top=0.0), GREEN, (-0.35, -1.65), size=(0.5, 0.5, 0.62))
    put("drum", cylinder(), YELLOW, (1.05, -1.75), turn=(90, 0, 62), size=(0.5, 0.5, 0.85))
    put("gem", icosphere(1), PURPLE, (2.35, -1.6), turn=(20, 10, 0), size=0.62)
    put("wheel", torus(0.12), BLUE, (3.29, -0.35), turn=(0, 76, 0), size=0.72, smooth=True)
    put("plank", box(), ORANGE, (-3.24, 0.17), turn=(0, -58, 24), size=(1.15, 0.3, 0.07))

    for side in (-0.9, 0.9):
        top = put("pillar", cylinder(), CREAM, (-1.5 + side, 2.6), size=(0.36, 0.36, 1.75))
    top = put("lintel", box(), CREAM, (-1.5, 2.6), on=top, size=(2.5, 0.5, 0.26))
    put("dome", sphere(), BLUE, (-1.5, 2.6), on=top, size=0.5, smooth=True)

    top = put("stand", box(), SLATE, (3.3, 1.95), size=(3.0, 0.9, 0.6))
    railing(left=1.9, right=4.7, y=2.2, on=top, height=0.85)
    for i, albedo in enumerate((TEAL, WHITE, PURPLE, YELLOW)):
        put("plate", cylinder(), albedo, (2.3 + 0.66 * i, 2.0), on=top, turn=(70, 0, 0),
            size=(0.6, 0.6, 0.04))

    pebbles(count=16, seed=11)
    for at, height in (((-8.6, 13), 2.4), ((-5.8, 19), 3.0), ((2.2, 24), 3.4), ((8.0, 17), 2.6),
                       ((4.8, 38), 3.8)):
        width = 0.55 * height
        put("tree", cylinder(top=0.0), DARK_GREEN, at, size=(width, width, height))


def railing(left, right, y, on, height):
    """Bars three centimetres thick: light reaches what stands behind them."""
    bars = int((right - left) / 0.22)
    for i in range(bars + 1):
        x = left + (right - left) * i / bars
        put("bar", box(), SLATE, (x, y), on=on, size=(0.03, 0.03, height))
    put("handrail", box(), ORANGE, ((left + right) / 2, y), on=on + height,
        size=(right - left + 0.1, 0.09, 0.05))


def pebbles(count, seed):
    """Small faceted stones on an ellipse of ground around the group, every third one round."""
    rng = random.Random(seed)
    albedos = (CREAM, TEAL, RED, BLUE, YELLOW, PURPLE)
    for i in range(count):
        angle = pi * (1.02 + 0.96 * (i + rng.uniform(0.1, 0.9)) / count)
        reach = rng.uniform(0.95, 1.1)
        at = (4.3 * reach * cos(angle), 2.55 * reach * sin(angle))
        put("pebble", icosphere(4 if i % 3 == 0 else 1), albedos[i % len(albedos)], at,
            turn=(rng.uniform(0, 90), rng.uniform(0, 90), 0), size=rng.uniform(0.14, 0.3),
            smooth=i % 3 == 0)


def room_corner():
    """Two coloured walls and a light floor, open above and in front: bounce light everywhere."""
    put("floor", box(), WHITE, (0, 0), on=-0.1, size=(4.4, 4.4, 0.1))
    put("left wall", box(), RED, (-2.15, 0.05), size=(0.1, 4.3, 2.8))
    put("right wall", box(), TEAL, (0.05, 2.15), size=(4.3, 0.1, 2.8))

    top = put("cupboard", box(), WHITE, (-1.55, 1.5), size=(1.0, 1.0, 0.9))
    put("ball", sphere(), CREAM, (-1.55, 1.5), on=top, size=0.62, smooth=True)
    top = put("crate", box(), YELLOW, (0.75, 1.2), turn=(0, 0, 18), size=0.85)
    put("crate", box(), BLUE, (0.8, 1.25), on=top, turn=(0, 0, -14), size=0.55)
    put("ball", sphere(), WHITE, (-0.45, -0.1), size=1.0, smooth=True)
    put("ring", torus(0.14), PURPLE, (0.85, -0.1), size=0.75, smooth=True)
    put("column", cylinder(), CREAM, (1.7, 1.7), size=(0.36, 0.36, 1.7))
    put("marble", sphere(), GREEN, (0.35, 0.32), size=0.4, smooth=True)


# A large soft lamp at the left, a spot behind the group, a bulb between things, and a low sun.
STILL_LIFE_LAMPS = (
    Lamp("key", "AREA", (-4.2, -4.6, 4.4), (0, 0, 0.6), 900, (1.0, 0.86, 0.68),
         {"shape": "RECTANGLE", "size": 1.6, "size_y": 1.0}),
    Lamp("rim", "SPOT", (3.4, 4.6, 3.4), (0, 0.1, 0.9), 1500, (0.42, 0.62, 1.0),
         {"spot_size": radians(50), "spot_blend": 0.4, "shadow_soft_size": 0.1}),
    Lamp("bulb", "POINT", (-0.62, -0.98, 0.5), (0, 0, 0), 40, (1.0, 0.45, 0.16),
         {"shadow_soft_size": 0.06}),
    Lamp("dusk", "SUN", (0, 0, 9), (-4, 3, 6.5), 1.5, (1.0, 0.6, 0.35), {"angle": radians(3)}),
)

SCENES = {
    # The horizon, 300 m away, falls between two rows of pixel centres: no pixel is half sky.
    "still_life": Scene(still_life, 576, 324, camera=(0.35, -8.6, 2.35), target=(0.1, 0, 0.984),
                        hfov_deg=45.0, environment="sky.exr", ao_radii=(0.5, 2.0),
                        lamps=STILL_LIFE_LAMPS),
    "room_corner": Scene(room_corner, 480, 270, camera=(4.1, -5.2, 3.3), target=(-0.15, 0.3, 0.72),
                         hfov_deg=42.0, environment="studio.exr", ao_radii=(0.25, 1.0)),
}
