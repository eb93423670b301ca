# SPDX-License-Identifier: Apache-2.0
"""Renders a scene of scenes.py to a multilayer EXR as an artist would set it up for ssdo.

    blender -b -P export.py -- still_life -o still_life.exr --camera still_life.camera.json

Without further options that is a G-buffer. `--overscan`, `--pano` and `--also` render more of the
scene beside it, for ssdo to know in place of guessing:

    blender -b -P export.py -- still_life -o still_life.exr --overscan 25 --pano around.exr \
        --also left.exr:-40 --also right.exr:40 --also top.exr:top --camera still_life.camera.json

`--lights lamps.json` writes the lamps of the scene, which `ssdo --lights` reads.

`--samples`, `--world`, `--lamp`, `--bounces`, `--ao-radius` and `--seed` make it a path-traced render
with light passes instead: truth.py uses those.
"""
import argparse
import json
import sys
from math import radians, tan
from pathlib import Path

import bpy
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
# Blender does not put a script's own folder on the path.
from scenes import SCENES  # noqa: E402
from ssdo_relight import (SURFACES, View, from_above, new_camera, panorama,  # noqa: E402
                          set_up_cycles, turned, widened, write_lamps)
from ssdo_relight import render as render_view  # noqa: E402

ENVIRONMENTS = Path(__file__).resolve().parent.parent / "environments"

CONVENTIONS = {
    "camera": "right-handed, x right, y up, looks along -z; column vectors, "
              "camera = world_to_camera * (x,y,z,1)",
    "pixel": "pixel (i,j), i right, j down, (0,0) top left, centre at (i+0.5, j+0.5)",
    "projection": "px = cx + fx*xc/(-zc), py = cy - fy*yc/(-zc)",
    "depth": "planar, = -zc (not ray distance)",
    "world": "z up, metres",
    "env": "lat-long, dir=(x,y,z): u = 0.5 - atan2(y,x)/(2 pi), v_from_top = acos(z)/pi; "
           "u=0.5 is +X, u=0.25 is +Y, u=0.75 is -Y; no rotation",
}


def add_camera(scene, picture):
    camera = new_camera(scene, "cam")
    camera.data.angle = radians(picture.hfov_deg)
    camera.location = picture.camera
    view = Vector(picture.target) - Vector(picture.camera)
    camera.rotation_euler = view.to_track_quat("-Z", "Y").to_euler()
    scene.camera = camera


def add_world(scene, environment=None, strength=1.0):
    """A uniform white world, or the lat-long map with importance sampling."""
    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    background.inputs["Strength"].default_value = strength
    if environment:
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(str(ENVIRONMENTS / environment))
        links.new(texture.outputs["Color"], background.inputs["Color"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 1024


def add_lamps(scene, picture, args):
    """Those that are asked for; a file of lamps has all of them."""
    for lamp in picture.lamps:
        lamp.put()
    if args.lights:
        for warning in write_lamps(args.lights, bpy.context.evaluated_depsgraph_get()):
            print(warning, file=sys.stderr)
    names = [lamp.name for lamp in picture.lamps]
    for name in args.lamp:
        if name not in (*names, "all"):
            sys.exit(f"--lamp {name}: the scene has {', '.join(names) or 'no lamp'}")
    for name in names:
        if not {name, "all"} & set(args.lamp):
            bpy.data.objects.remove(scene.objects[name])


def set_up_stereo(scene, distance):
    """The camera is the left eye, and the right one looks the same way from `distance` beside it.
    One file holds both views."""
    stereo = scene.camera.data.stereo
    stereo.interocular_distance, stereo.pivot = distance, "LEFT"
    stereo.convergence_mode = "PARALLEL"
    scene.render.use_multiview = True
    scene.render.views_format = "STEREO_3D"
    scene.render.image_settings.views_format = "MULTIVIEW"


def view_json(view):
    """Where a view looks from, and, of a perspective one, its projection in pixels."""
    camera, (width, height) = view.camera, view.size
    rows = lambda matrix: [list(row) for row in matrix]
    facts = {
        "type": "equirect" if camera.data.type == "PANO" else "persp",
        "width": width,
        "height": height,
        "camera_to_world": rows(camera.matrix_world),
        "world_to_camera": rows(camera.matrix_world.inverted()),
        "location": list(camera.matrix_world.translation),
    }
    if camera.data.type == "PANO":
        return facts | {"depth": "distance from the camera"}
    focal_px = (width + 2 * view.margin[0]) / 2 / tan(camera.data.angle / 2)
    return facts | {
        "data_window": {"x": -view.margin[0], "y": -view.margin[1],
                        "width": width + 2 * view.margin[0], "height": height + 2 * view.margin[1]},
        "fx": focal_px, "fy": focal_px, "cx": width / 2, "cy": height / 2,
    }


def camera_json(name, picture, views):
    main, *further = views
    camera = main.camera.data
    return {
        "scene": name,
        "env": f"environments/{picture.environment}",
        **view_json(main),
        "clip_start": camera.clip_start,
        "clip_end": camera.clip_end,
        "sensor_width_mm": camera.sensor_width * main.size[0] / (main.size[0] + 2 * main.margin[0]),
        "sensor_fit": camera.sensor_fit,
        "focal_length_mm": camera.lens,
        "hfov_deg": picture.hfov_deg,
        "ao_radius": {"truth_ao_files": list(picture.ao_radii), "unit": "m"},
        "also": {view.path.name: view_json(view) for view in further},
        "conventions": CONVENTIONS,
    }


def read_also(text):
    """FILE:DEGREES or FILE:top."""
    file, _, kind = text.rpartition(":")
    if not file:
        raise argparse.ArgumentTypeError(f"{text}: expected FILE:DEGREES or FILE:top")
    return Path(file), kind if kind == "top" else float(kind)


def views_of(args, scene, picture):
    """The picture and all that is rendered beside it."""
    main, target = scene.camera, Vector(picture.target)
    size = (args.scale * picture.width, args.scale * picture.height)
    further = []
    if args.pano:
        further.append(panorama(scene, args.pano, main))
    for path, kind in args.also:
        further.append(from_above(scene, path, main, size, target) if kind == "top" else
                       turned(scene, path, main, size, target, kind))
    view = View(args.output, main, size)
    return [widened(view, args.overscan) if args.overscan else view, *further]


def render(scene, view, passes, stereo=None):
    scene.render.use_multiview = False
    if stereo:
        set_up_stereo(scene, stereo)
    render_view(scene, view, passes)


def parse_arguments():
    parser = argparse.ArgumentParser(prog="blender -b -P export.py --")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--camera", type=Path, help="write the camera there, as JSON")
    parser.add_argument("--scale", type=int, default=1, metavar="N",
                        help="N times as many pixels in a row and in a column: ssdo --downsample N")
    more = parser.add_argument_group("more of the scene")
    more.add_argument("--overscan", type=float, default=0, metavar="PERCENT",
                      help="so much more picture on each side, beyond the display window")
    more.add_argument("--pano", type=Path, metavar="FILE", help="a panorama at the camera")
    more.add_argument("--also", type=read_also, action="append", default=[],
                      metavar="FILE:DEGREES|top",
                      help="the camera turned about its target, or a view from above; repeatable")
    more.add_argument("--lights", type=Path, metavar="FILE", help="the lamps of the scene, as JSON")
    more.add_argument("--stereo", type=float, metavar="DISTANCE",
                      help="both eyes in one file, the right one so far beside the camera")
    light = parser.add_argument_group("path-traced light passes")
    light.add_argument("--samples", type=int, help="write light passes, so many samples per pixel")
    light.add_argument("--world", choices=["white", "environment", "black"], default="white")
    light.add_argument("--lamp", action="append", default=[], metavar="NAME",
                       help="a lamp of the scene, or all; repeatable")
    light.add_argument("--bounces", type=int, default=0)
    light.add_argument("--ao-radius", type=float, default=1.0)
    light.add_argument("--seed", type=int, default=0)
    light.add_argument("--antialiased", action="store_true",
                       help="Blender's usual pixel filter, and nothing behind the scene: for Combined")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def main():
    args = parse_arguments()
    picture = SCENES[args.scene]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.name = args.scene
    picture.build()
    add_camera(scene, picture)
    add_world(scene, picture.environment if args.world == "environment" else None,
              0.0 if args.world == "black" else 1.0)
    add_lamps(scene, picture, args)
    scene.world.light_settings.distance = args.ao_radius  # of the AO pass
    set_up_cycles(scene, args.samples or 1, args.bounces, args.seed, args.antialiased)
    if args.samples:
        passes = ["z", "diffuse_direct", "diffuse_indirect", "ambient_occlusion"]
    else:
        passes = SURFACES
    views = views_of(args, scene, picture)
    render(scene, views[0], ["combined", *passes], args.stereo)
    for view in views[1:]:
        render(scene, view, passes)
    if args.camera:
        args.camera.write_text(json.dumps(camera_json(args.scene, picture, views), indent=1) + "\n")


if __name__ == "__main__":
    main()
