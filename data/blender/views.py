# SPDX-License-Identifier: Apache-2.0
"""Cameras that show more of a scene than its picture does: overscan, a panorama, other views.

ssdo takes what they show as known geometry, in place of guesses. Each is a G-buffer as export.py
makes it, with P in world space and unfiltered.
"""
import subprocess
from dataclasses import dataclass
from math import atan2, ceil, pi, radians, tan
from pathlib import Path

import bpy
from mathutils import Euler, Matrix, Vector

PANORAMA_SIZE = (512, 256)
ALSO_WIDTH = 320  # another view joins surfaces: it needs no finer pixels
TOP_WIDTH, TOP_HEIGHT = 2.5, 3.0  # a view from above shows 2.5 times the width, from 3 such above


@dataclass
class View:
    """A camera and its file. The margins are pixels of overscan on each side, beyond the size."""

    path: Path
    camera: bpy.types.Object
    size: tuple  # pixels
    margin: tuple = (0, 0)


def new_camera(scene, name, like=None):
    data = bpy.data.cameras.new(name)
    data.sensor_fit = "HORIZONTAL"
    data.clip_start, data.clip_end = 0.05, 1000.0
    camera = bpy.data.objects.new(name, data)
    scene.collection.objects.link(camera)
    if like:
        data.angle = like.data.angle
        camera.matrix_world = like.matrix_world.copy()
    return camera


def widened(view, percent):
    """The same camera with so many percent more picture on each side.

    Resolution and sensor grow alike, so that lens and pixels stay as they were.
    """
    width, height = view.size
    margin = (ceil(width * percent / 100), ceil(height * percent / 100))
    view.camera.data.sensor_width *= (width + 2 * margin[0]) / width
    return View(view.path, view.camera, view.size, margin)


def heading(camera):
    """Where the camera looks, seen from above: radians about world z, 0 along +y."""
    look = camera.matrix_world.to_quaternion() @ Vector((0, 0, -1))
    return atan2(-look.x, look.y)


def panorama(scene, path, main):
    """All around the main camera, upright: its middle is where that camera is heading."""
    camera = new_camera(scene, "panorama")
    camera.data.type = "PANO"
    camera.data.cycles.panorama_type = "EQUIRECTANGULAR"
    camera.matrix_world = (Matrix.Translation(main.matrix_world.translation) @
                           Euler((pi / 2, 0, heading(main))).to_matrix().to_4x4())
    return View(path, camera, PANORAMA_SIZE)


def turned(scene, path, main, size, target, degrees):
    """The main camera turned about the vertical axis through the target; over 0 to its right."""
    camera = new_camera(scene, f"turned {degrees:g}", like=main)
    axis = Matrix.Translation(target)
    camera.matrix_world = (axis @ Matrix.Rotation(radians(degrees), 4, "Z") @ axis.inverted() @
                           main.matrix_world)
    return View(path, camera, also_size(size))


def from_above(scene, path, main, size, target):
    """Straight down on the target; up in the picture is where the main camera is heading."""
    camera = new_camera(scene, "top")
    distance = (main.matrix_world.translation - target).length
    width = TOP_WIDTH * 2 * distance * tan(main.data.angle / 2)
    camera.data.angle = 2 * atan2(width / 2, TOP_HEIGHT * width)
    camera.data.clip_end = 10 * TOP_HEIGHT * width
    camera.matrix_world = (Matrix.Translation(target + Vector((0, 0, TOP_HEIGHT * width))) @
                           Matrix.Rotation(heading(main), 4, "Z"))
    return View(path, camera, also_size(size))


def also_size(size):
    return ALSO_WIDTH, round(ALSO_WIDTH * size[1] / size[0])


def set_windows(view):
    """Blender knows no overscan: it has written all pixels as one picture. Says which are which.

    The display window is that of the picture, and the data window reaches beyond; no pixel changes.
    """
    if view.margin == (0, 0):
        return
    (width, height), (left, top) = view.size, view.margin
    subprocess.run(["oiiotool", "--nosoftwareattrib", view.path, "--origin", f"-{left}-{top}",
                    "--fullsize", f"{width}x{height}+0+0", "-o", view.path], check=True)


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
