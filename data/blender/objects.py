# SPDX-License-Identifier: Apache-2.0
"""Renders a scene of scenes.py with and without an object, to test `ssdo --no-cast` with.

    blender -b -P objects.py -- still_life suzanne -o /tmp/objects

writes with.exr and without.exr, G-buffers of 320 x 180 with Cryptomatte and IndexOB; also0.exr and
also1.exr, two further views of the scene without the object; and the path-traced answers of the
scene without it: white.exr (ao, DiffDir in a white world) and environment.exr (direct light,
DiffDir). `--small` writes with.exr alone, of 48 x 27 and antialiased as a comp has it.
"""
import argparse
import sys
from pathlib import Path

import bpy
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
from export import add_camera, add_world, render  # noqa: E402
from scenes import SCENES  # noqa: E402
from ssdo_relight import CRYPTOMATTE, SURFACES, View, set_up_cycles, turned  # noqa: E402

OBJECTS = (*CRYPTOMATTE, "object_index")
ALSO_DEGREES = (-40, 40)


def build(picture, without=None):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    picture.build()
    things = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    for index, thing in enumerate(sorted(things, key=lambda o: o.name)):
        thing.pass_index = index + 1
    if without:
        bpy.data.objects.remove(bpy.data.objects[without])
    scene = bpy.context.scene
    add_camera(scene, picture)
    bpy.context.view_layer.update()
    return scene


def write(picture, path, size, passes, without=None, environment=None, samples=1, small=False):
    scene = build(picture, without)
    add_world(scene, environment)
    set_up_cycles(scene, samples, 0, 0)
    if small:
        scene.cycles.filter_width = 1.5
    render(scene, View(path, scene.camera, size), passes)


def main():
    parser = argparse.ArgumentParser(prog="blender -b -P objects.py --")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("object")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--small", action="store_true")
    args = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    args.output.mkdir(parents=True, exist_ok=True)
    picture = SCENES[args.scene]
    if args.small:
        return write(picture, args.output / "with.exr", (48, 27),
                     [*SURFACES, *OBJECTS, "combined"], samples=16, small=True)
    size = (320, 180)
    write(picture, args.output / "with.exr", size, [*SURFACES, *OBJECTS, "combined"])
    write(picture, args.output / "without.exr", size, [*SURFACES, *OBJECTS], args.object)
    for i, degrees in enumerate(ALSO_DEGREES):
        scene = build(picture, args.object)
        set_up_cycles(scene, 1, 0, 0)
        view = turned(scene, args.output / f"also{i}.exr", scene.camera, size,
                      Vector(picture.target), degrees)
        render(scene, view, SURFACES)
    for name, environment in (("white", None), ("environment", picture.environment)):
        write(picture, args.output / f"{name}.exr", size, ["diffuse_direct"], args.object,
              environment, args.samples)


if __name__ == "__main__":
    main()
