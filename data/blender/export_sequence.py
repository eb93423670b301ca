# SPDX-License-Identifier: Apache-2.0
"""Renders G-buffers of a scene of scenes.py under a camera that moves sideways around its target.

    blender -b -P export_sequence.py -- still_life -o shot.####.exr --frames 12 --degrees 6

Each frame is what export.py makes, at a share of the scene's size. The frames are for looking at
flicker: that of `ssdo shot.####.exr -o out.####.exr`, and with --temporal.
"""
import argparse
import sys
from dataclasses import replace
from math import radians
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
# Blender does not put a script's own folder on the path.
from export import add_camera, add_world, set_up_cycles, set_up_output  # noqa: E402
from scenes import SCENES  # noqa: E402


def parse_arguments():
    parser = argparse.ArgumentParser(prog="blender -b -P export_sequence.py --")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("-o", "--output", required=True, help="with #### for the frame's number")
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--degrees", type=float, default=6, help="about the target, in all")
    parser.add_argument("--width", type=int, default=160)
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def main():
    args = parse_arguments()
    picture = SCENES[args.scene]
    picture = replace(picture, width=args.width,
                      height=round(picture.height * args.width / picture.width))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    picture.build()
    add_world(scene)
    set_up_cycles(scene, samples=1, bounces=0, seed=0)
    eye, target = Vector(picture.camera), Vector(picture.target)
    for frame in range(args.frames):
        angle = radians(args.degrees) * (frame / max(args.frames - 1, 1) - 0.5)
        at = target + Matrix.Rotation(angle, 3, "Z") @ (eye - target)
        add_camera(scene, replace(picture, camera=tuple(at)))
        path = Path(args.output.replace("####", f"{frame + 1:04d}"))
        set_up_output(scene, picture, path, ["z", "position", "normal", "diffuse_color"])
        bpy.ops.render.render(write_still=True)


main()
