# SPDX-License-Identifier: Apache-2.0
"""Renders a beauty and the ambient layer in it, for the composite that occludes that layer.

    blender -b -P beauty.py -- still_life -o ../still_life_beauty.exr

The ambient layer is the light of the scene's map with nothing in its way, as renderers without
ambient occlusion make it. The beauty adds a lamp with its shadows. Both show the same points as the
G-buffer of export.py, in half floats: layers Combined and Ambient. Needs oiiotool beside Blender.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
from export import add_camera, add_world  # noqa: E402
from scenes import SCENES  # noqa: E402
from ssdo_relight import set_up_cycles  # noqa: E402

SAMPLES = 64  # per pixel
LAMP = {"at": (4.5, -5.5, 5.0), "to": (0, 0, 0.5), "size": 0.6, "watts": 500}


def add_lamp(scene):
    data = bpy.data.lights.new("lamp", "AREA")
    data.size, data.energy, data.color = LAMP["size"], LAMP["watts"], (1.0, 0.93, 0.84)
    lamp = bpy.data.objects.new("lamp", data)
    lamp.location = LAMP["at"]
    lamp.rotation_euler = (Vector(LAMP["to"]) - lamp.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(lamp)


def let_light_through(scene):
    """Rays of light and of surfaces meet nothing; the camera's still do."""
    for thing in scene.objects:
        thing.visible_shadow = thing.visible_diffuse = False


def render(name, path, ambient):
    picture = SCENES[name]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    picture.build()
    add_camera(scene, picture)
    if ambient:
        add_world(scene, picture.environment)
        let_light_through(scene)
    else:
        add_lamp(scene)  # no world: black
    set_up_cycles(scene, SAMPLES, bounces=0, seed=0)
    settings = scene.render
    settings.resolution_x, settings.resolution_y = picture.width, picture.height
    settings.resolution_percentage = 100
    settings.filepath = str(path)
    image = settings.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    bpy.ops.render.render(write_still=True)


def main():
    parser = argparse.ArgumentParser(prog="blender -b -P beauty.py --")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("-o", "--output", type=Path, required=True)
    args = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    with tempfile.TemporaryDirectory() as folder:
        ambient, lamp = Path(folder) / "ambient.exr", Path(folder) / "lamp.exr"
        render(args.scene, ambient, ambient=True)
        render(args.scene, lamp, ambient=False)
        layers = [",".join(f"{layer}.{c}" for c in "RGB") for layer in ("Combined", "Ambient")]
        subprocess.run(["oiiotool", "--nosoftwareattrib", ambient, lamp, "--add", "--ch", "R,G,B",
                        "--chnames", layers[0], ambient, "--ch", "R,G,B", "--chnames", layers[1],
                        "--chappend", "--eraseattrib", ".*", "--compression", "zip", "-d", "half",
                        "-o", args.output.resolve()], check=True)


main()
