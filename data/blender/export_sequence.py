# SPDX-License-Identifier: Apache-2.0
"""Renders G-buffers of a scene of scenes.py under a camera that moves sideways around its target.

    blender -b -P export_sequence.py -- still_life -o shot.####.exr --frames 12 --degrees 6
    blender -b -P export_sequence.py -- still_life -o shot.####.exr --move suzanne --by=-1,-1,0.5

Each frame is what export.py makes, at a share of the scene's size, with the Vector pass beside it
that `ssdo --temporal` takes for the motion of things. The frames are for looking at flicker: that
of `ssdo shot.####.exr -o out.####.exr`, and with --temporal.
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
from export import add_camera, add_world  # noqa: E402
from scenes import SCENES  # noqa: E402
from ssdo_relight import set_up_cycles, set_up_output  # noqa: E402


def parse_arguments():
    parser = argparse.ArgumentParser(prog="blender -b -P export_sequence.py --")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("-o", "--output", required=True, help="with #### for the frame's number")
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--degrees", type=float, default=6, help="about the target, in all")
    parser.add_argument("--width", type=int, default=160)
    parser.add_argument("--move", help="an object of the scene that moves too")
    parser.add_argument("--by", default="0,0,0", help="X,Y,Z metres, in all")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def view_from(picture, at):
    """Location and rotation of a camera there that looks at the target."""
    direction = Vector(picture.target) - at
    return at, direction.to_track_quat("-Z", "Y").to_euler()


def main():
    args = parse_arguments()
    picture = SCENES[args.scene]
    picture = replace(picture, width=args.width,
                      height=round(picture.height * args.width / picture.width))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    picture.build()
    add_camera(scene, picture)
    add_world(scene)
    set_up_cycles(scene, samples=1, bounces=0, seed=0)
    thing = scene.objects[args.move] if args.move else None
    way = Vector(float(x) for x in args.by.split(","))
    eye, target = Vector(picture.camera), Vector(picture.target)
    # Vector looks one frame ahead and back: there are keys for those too.
    for frame in range(args.frames + 2):
        share = (frame - 1) / max(args.frames - 1, 1)
        at = target + Matrix.Rotation(radians(args.degrees) * (share - 0.5), 3, "Z") @ (eye - target)
        camera = scene.camera
        camera.location, camera.rotation_euler = view_from(picture, at)
        camera.keyframe_insert("location", frame=frame)
        camera.keyframe_insert("rotation_euler", frame=frame)
        if thing:
            thing.location = share * way
            thing.keyframe_insert("location", frame=frame)
    for frame in range(1, args.frames + 1):
        scene.frame_set(frame)
        path = Path(args.output.replace("####", f"{frame:04d}"))
        set_up_output(scene, (picture.width, picture.height), path,
                      ["z", "position", "normal", "diffuse_color", "vector"])
        bpy.ops.render.render(write_still=True)


main()
