# SPDX-License-Identifier: Apache-2.0
"""An add-on for Blender 3.4 and later: renders G-buffers, runs ssdo, and puts the result into the
compositor. Install this file in Preferences > Add-ons; the panel is in Properties > Render > ssdo.

The other scripts of this folder take their cameras, lamps and render settings from here.
"""
import json
import re
import shlex
import shutil
import struct
import subprocess
import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass
from math import acos, atan2, ceil, cos, degrees, pi, radians, tan
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty
from mathutils import Euler, Matrix, Vector

bl_info = {
    "name": "ssdo",
    "author": "The ssdo project",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > ssdo",
    "description": "Occlusion and bounce light from a one-sample render, in the compositor",
    "category": "Render",
}

SURFACES = ("z", "position", "normal", "diffuse_color")  # the passes of a G-buffer
CRYPTOMATTE = ("cryptomatte_object", "cryptomatte_material", "cryptomatte_asset")
PANORAMA_SIZE = (512, 256)
ALSO_WIDTH = 320  # another view joins surfaces: it needs no finer pixels
ALSO_DEGREES = 40  # between the camera and a view from its left or right
TOP_WIDTH, TOP_HEIGHT = 2.5, 3.0  # a view from above shows 2.5 times the width, from 3 such above
SMALLEST_RADIUS = 1e-3  # metres: a spot without a size
# Without an image there is no finest detail: a pixel is the mean of 16 samples, in which a sun of
# half a degree is 30 samples large.
WORLD_SIZE, LARGEST_WORLD, WORLD_SAMPLES = (1024, 512), (4096, 2048), 16


class RelightError(Exception):
    """One line for the artist: what is wrong, and what to do."""


# Cameras that show more of a scene than its picture does: overscan, a panorama, other views. ssdo
# takes what they show as known geometry, in place of guesses.


@dataclass
class View:
    """A camera and its file. The margins are pixels of overscan on each side, beyond the size."""

    path: Path
    camera: bpy.types.Object
    size: tuple  # pixels
    margin: tuple = (0, 0)


def new_camera(scene, name, data=None):
    """A camera of the scene with this lens, or one of its own."""
    if not data:
        data = bpy.data.cameras.new(name)
        data.sensor_fit = "HORIZONTAL"
        data.clip_start, data.clip_end = 0.05, 1000.0
    camera = bpy.data.objects.new(name, data)
    scene.collection.objects.link(camera)
    return camera


def copied_camera(scene, original):
    """A copy to change, with the motion of the original: from the next frame_set on. Its sensor
    fits one side of the picture, where AUTO would take the longer one of any picture."""
    camera, data, render = original.copy(), original.data.copy(), scene.render
    scene.collection.objects.link(camera)
    camera.data = data
    data.dof.use_dof = False  # P of a blurred pixel is of no surface
    if data.sensor_fit == "AUTO":
        is_wide = (render.resolution_x * render.pixel_aspect_x >=
                   render.resolution_y * render.pixel_aspect_y)
        data.sensor_fit = "HORIZONTAL" if is_wide else "VERTICAL"
        data.sensor_height = data.sensor_width  # AUTO has one size for both
    return camera


def depsgraph_of(scene):
    """The evaluated scene, as the layer that is rendered shows it."""
    layer = next((layer for layer in scene.view_layers if layer.use), scene.view_layers[0])
    layer.update()
    return layer.depsgraph


def place_of(scene, thing):
    """From an object to the world, at the frame of the scene."""
    return thing.evaluated_get(depsgraph_of(scene)).matrix_world.copy()


def widened(view, percent, step=1):
    """The same camera with so many percent more picture on each side, in steps of `step` pixels.

    Sensor (or the width of an orthographic view) and resolution grow alike, so that pixels stay as
    they were. The camera's shift is in units of the picture.
    """
    margin = tuple(step * ceil(side * percent / 100 / step) for side in view.size)
    data = view.camera.data
    side = 1 if data.sensor_fit == "VERTICAL" else 0
    wider = (view.size[side] + 2 * margin[side]) / view.size[side]
    if data.type == "ORTHO":
        data.ortho_scale *= wider
    elif side:
        data.sensor_height *= wider
    else:
        data.sensor_width *= wider
    data.shift_x, data.shift_y = data.shift_x / wider, data.shift_y / wider
    return View(view.path, view.camera, view.size, margin)


def looks_along(place):
    return place.to_quaternion() @ Vector((0, 0, -1))


def heading(place):
    """Where a camera looks, seen from above: radians about world z, 0 along +y."""
    look = looks_along(place)
    return atan2(-look.x, look.y)


def new_panorama(scene, place):
    """A lat-long camera; upright, its middle is where its -z looks."""
    camera = new_camera(scene, "panorama")
    camera.data.type = "PANO"
    # A setting of Cycles in Blender 3.4, and of the camera in later releases.
    owner = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    owner.panorama_type = "EQUIRECTANGULAR"
    camera.matrix_world = place
    return camera


def panorama(scene, path, main):
    """All around the main camera, upright: its middle is where that camera is heading."""
    place = place_of(scene, main)
    camera = new_panorama(scene, Matrix.Translation(place.translation) @
                          Euler((pi / 2, 0, heading(place))).to_matrix().to_4x4())
    return View(path, camera, PANORAMA_SIZE)


def turned(scene, path, main, size, target, angle):
    """The main camera turned about the vertical axis through the target, in degrees; over 0 to its
    right."""
    camera = new_camera(scene, f"turned {angle:g}", main.data.copy())
    axis = Matrix.Translation(target)
    camera.matrix_world = (axis @ Matrix.Rotation(radians(angle), 4, "Z") @ axis.inverted() @
                           place_of(scene, main))
    return View(path, camera, also_size(size))


def from_above(scene, path, main, size, target):
    """Straight down on the target; up in the picture is where the main camera is heading."""
    camera, place = new_camera(scene, "top"), place_of(scene, main)
    distance = (place.translation - target).length
    seen = main.data.ortho_scale if main.data.type == "ORTHO" else (
        2 * distance * tan(main.data.angle / 2))
    width = TOP_WIDTH * seen
    camera.data.angle = 2 * atan2(width / 2, TOP_HEIGHT * width)
    camera.data.clip_end = 10 * TOP_HEIGHT * width
    camera.matrix_world = (Matrix.Translation(target + Vector((0, 0, TOP_HEIGHT * width))) @
                           Matrix.Rotation(heading(place), 4, "Z"))
    return View(path, camera, also_size(size))


def also_size(size):
    return ALSO_WIDTH, round(ALSO_WIDTH * size[1] / size[0])


# Rendering


def set_up_cycles(scene, samples=1, bounces=0, seed=0, antialiased=False):
    """The plain estimator: everything that biases or blurs a pixel is off, but for its filter."""
    try:
        scene.render.engine = "CYCLES"
    except TypeError:
        raise RelightError("Cycles is missing: enable the add-on Cycles Render Engine") from None
    cycles = scene.cycles
    cycles.samples, cycles.seed = samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    # One ray through the pixel centre. Blender averages Normal and DiffCol over the pixel filter,
    # but takes Position and Depth from the first sample: this way all four are of one point.
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 1.5 if antialiased else 0.01
    scene.render.film_transparent = antialiased


def set_up_output(scene, size, path, passes, margin=(0, 0), layer=None):
    """One file of the passes of a view layer, the first one by default, without post-processing."""
    render, layer = scene.render, layer or scene.view_layers[0]
    render.resolution_x, render.resolution_y = size[0] + 2 * margin[0], size[1] + 2 * margin[1]
    render.resolution_percentage = 100
    render.use_border = render.use_compositing = render.use_sequencer = False
    render.use_motion_blur = False  # P and N of a blurred pixel are of no surface
    render.filepath = str(path.resolve())
    image = render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"  # Blender 5
    image.file_format = "OPEN_EXR_MULTILAYER"
    image.color_depth = "32"  # half would round P to millimetres, and far worse away from 0
    image.exr_codec = "ZIP"
    for setting in layer.bl_rna.properties.keys():
        if setting.startswith("use_pass_"):
            setattr(layer, setting, setting[len("use_pass_"):] in passes)


def set_windows(view):
    """Blender knows no overscan: it has written all pixels as one picture. Says which are which.

    The display window is that of the picture, and the data window reaches beyond; no pixel changes.
    In an EXR, both windows are in each part's header, and each chunk of rows has its first row.
    """
    (width, height), (left, top) = view.size, view.margin
    if (left, top) == (0, 0):
        return
    data = bytearray(view.path.read_bytes())
    has_parts = data[5] & 0x10
    headers, at = [], 8
    while data[at]:  # headers of several parts end with an empty one
        header = {}
        while data[at]:
            type_at = data.index(0, at) + 1
            size_at = data.index(0, type_at) + 1
            header[bytes(data[at:type_at - 1])] = size_at + 4
            at = size_at + 4 + struct.unpack_from("<i", data, size_at)[0]
        headers.append(header)
        at += 1
        if not has_parts:
            break
    at += 1 if has_parts else 0
    for header in headers:
        x0, y0, x1, y1 = struct.unpack_from("<4i", data, header[b"dataWindow"])
        struct.pack_into("<4i", data, header[b"dataWindow"],
                         x0 - left, y0 - top, x1 - left, y1 - top)
        struct.pack_into("<4i", data, header[b"displayWindow"], 0, 0, width - 1, height - 1)
        rows = 16 if data[header[b"compression"]] == 3 else 1  # ZIP; ZIPS, RLE and none
        for _ in range(ceil((y1 - y0 + 1) / rows)):  # where each chunk is
            row_at = struct.unpack_from("<Q", data, at)[0] + (4 if has_parts else 0)
            struct.pack_into("<i", data, row_at, struct.unpack_from("<i", data, row_at)[0] - top)
            at += 8
    view.path.write_bytes(data)


def render(scene, view, passes, layer=None):
    """Renders a view with the settings that the scene has to its file."""
    scene.camera = view.camera
    set_up_output(scene, view.size, view.path, passes, view.margin, layer)
    with bpy.context.temp_override(scene=scene):  # or it would be at the frame of the window's
        bpy.ops.render.render(write_still=True, scene=scene.name)
    set_windows(view)


@contextmanager
def copy_for_rendering(scene, layer):
    """A copy of the scene to change and render: the scene keeps its settings, its frame and its
    last render. Objects are shared; cameras that are added to the copy go with it."""
    copy = scene.copy()
    before = set(copy.collection.objects)
    try:
        for other in copy.view_layers:
            other.use = other.name == layer.name
        copy.timeline_markers.clear()  # they would switch to other cameras
        copy.render.use_multiview = copy.render.use_freestyle = False
        set_up_cycles(copy)
        yield copy
    finally:
        remove_cameras(camera for camera in copy.collection.objects if camera not in before)
        bpy.data.scenes.remove(copy)


def remove_cameras(cameras):
    for camera in list(cameras):
        bpy.data.cameras.remove(camera.data)  # and its object


def camera_at(scene, frame):
    """The scene's camera, or that of a marker: the last one up to this frame, else the first."""
    bound = sorted((marker for marker in scene.timeline_markers if marker.camera),
                   key=lambda marker: marker.frame)
    before = [marker for marker in bound if marker.frame <= frame]
    if bound:
        return (before or bound[:1])[-1].camera
    if not scene.camera:
        raise RelightError(f"{scene.name}: the scene has no camera; add one, or make one active")
    return scene.camera


def looked_at(scene, camera):
    """What a camera turns about: its object in focus, else what is in the middle of its picture,
    else the point at its focus distance."""
    dof, place = camera.data.dof, place_of(scene, camera)
    if dof.focus_object:
        return place_of(scene, dof.focus_object).translation
    look = looks_along(place)
    hit, point, *_ = scene.ray_cast(depsgraph_of(scene), place.translation, look)
    return point if hit else place.translation + dof.focus_distance * look


def views_of(scene, settings, main, path):
    """The camera's picture with its overscan, and the views beside it that are asked for.
    path(NAME) is the file of one."""
    render, scale = scene.render, 2 if settings.antialias else 1
    size = tuple(scale * (side * render.resolution_percentage // 100)
                 for side in (render.resolution_x, render.resolution_y))
    further, target = [], looked_at(scene, main)
    if "PANORAMA" in settings.also:
        further.append(panorama(scene, path("panorama"), main))
    for name, sign in (("LEFT", -1), ("RIGHT", 1)):
        if name in settings.also:
            further.append(turned(scene, path(name.lower()), main, size, target,
                                  sign * ALSO_DEGREES))
    if "TOP" in settings.also:
        further.append(from_above(scene, path("top"), main, size, target))
    view = View(path("frame"), main, size)
    if main.data.type == "PANO":
        return [view, *further]
    return [widened(view, settings.overscan, scale), *further]


def render_frame(scene, layer, frame, folder, warnings):
    """Renders the views of a frame and writes its lamps. Yields the name of each view."""
    settings = scene.ssdo
    with copy_for_rendering(scene, layer) as copy:
        main = copied_camera(copy, camera_at(scene, frame))
        copy.frame_set(frame)
        if settings.use_lamps:
            warnings += write_lamps(folder / f"lamps.{frame:04d}.json", depsgraph_of(copy))
        passes = SURFACES + (CRYPTOMATTE if "crypto:" in settings.options else ())
        path = lambda name: folder / f"{name}.{frame:04d}.exr"
        for view in views_of(copy, settings, main, path):
            yield view.path.name
            render(copy, view, passes, copy.view_layers[layer.name])
            passes = SURFACES
            copy.render.pixel_aspect_x = copy.render.pixel_aspect_y = 1.0  # of further views


def render_world(world, path):
    """A lat-long map of what a world sends from all directions, with the axes of `--env-up z`. Its
    middle is +x. It has the texels of the world's largest image, unless these are too many."""
    scene = bpy.data.scenes.new("ssdo world")
    scene.world = world.copy()
    try:
        scene.world.cycles_visibility.camera = True
        camera = new_panorama(scene, Euler((pi / 2, 0, -pi / 2)).to_matrix().to_4x4())
        nodes = world.node_tree.nodes if world.use_nodes else ()
        sizes = [tuple(node.image.size) for node in nodes
                 if node.type == "TEX_ENVIRONMENT" and node.image and node.image.size[0]]
        size = min(max(sizes, default=WORLD_SIZE), LARGEST_WORLD)
        set_up_cycles(scene)
        if size not in sizes:
            scene.cycles.samples = WORLD_SAMPLES
            scene.cycles.pixel_filter_type = "BOX"
            scene.cycles.filter_width = 1.0
        render(scene, View(path, camera, size), ("combined",))
    finally:
        remove_cameras(scene.collection.objects)
        bpy.data.worlds.remove(scene.world)
        bpy.data.scenes.remove(scene)


# Lamps. Blender gives a lamp a power C in watts; the radiance of a point lamp of radius r is
# C / (4 pi^2 r^2), that of an area lamp of area A is C / (4 A), and a sun of strength E gives a
# surface that faces it the irradiance E, all times the lamp's colour. In a file of lamps,
# `intensity` with `normalize` is radiance times area, and for a distant light irradiance.


def color_and_gain(lamp, warnings):
    """Linear colour of a lamp, and what its nodes multiply the power by."""
    color, gain = list(lamp.color), 1.0
    if not lamp.use_nodes:
        return color, gain
    emissions = [n for n in lamp.node_tree.nodes if n.type == "EMISSION"]
    if len(emissions) != 1 or any(i.is_linked for i in emissions[0].inputs):
        warnings.append(f"{lamp.name}: has nodes that vary its light; they are left out")
        return color, gain
    inputs = emissions[0].inputs
    of_node = inputs["Color"].default_value
    return [a * b for a, b in zip(color, of_node)], inputs["Strength"].default_value


def spot_cone(lamp):
    """Blender fades a spot by the cosine to its axis, from where it is all there to its border; a
    file of lamps has that border, the share of the angle that fades, and by what it fades."""
    border = lamp.spot_size / 2
    inner = acos(cos(border) + (1 - cos(border)) * lamp.spot_blend)
    return {"cone_angle": degrees(border), "cone_softness": 1 - inner / border,
            "cone_by_cosine": True}


def shape(lamp, scale, warnings):
    """Keys of the type of a lamp. A point or spot is a disk which faces each surface, or a ball
    where its soft falloff is off. Before Blender 4, a spot's light also falls with the cosine to
    its axis, as a disk's does."""
    watts = lamp.energy
    has_cone = lamp.type == "SPOT"
    if lamp.type == "POINT" or (has_cone and bpy.app.version >= (4, 0)):
        return {"type": "sphere", "radius": lamp.shadow_soft_size, "intensity": watts / pi,
                "soft_falloff": getattr(lamp, "use_soft_falloff", True),
                **(spot_cone(lamp) if has_cone else {})}
    if has_cone:
        return {"type": "disk", "radius": max(lamp.shadow_soft_size, SMALLEST_RADIUS),
                "intensity": watts / (4 * pi), **spot_cone(lamp)}
    if lamp.type == "SUN":
        return {"type": "distant", "angle": degrees(lamp.angle), "intensity": watts}
    width, height = lamp.size * scale.x, lamp.size * scale.y
    if lamp.shape in ("RECTANGLE", "ELLIPSE"):
        height = lamp.size_y * scale.y
    if lamp.spread < pi - 1e-4:
        warnings.append(f"{lamp.name}: has a spread of less than 180 degrees, which is left out")
    if lamp.shape in ("SQUARE", "RECTANGLE"):
        return {"type": "rect", "width": width, "height": height, "intensity": watts / 4}
    if abs(width - height) > 1e-3 * max(width, height):
        warnings.append(f"{lamp.name}: is an ellipse; it becomes a disk of the same area")
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


def read_lamps(depsgraph, warnings):
    """The lamps that the scene is rendered with, in world space."""
    lamps, taken = [], set()
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type != "LIGHT" or thing.hide_render or not instance.show_self:
            continue
        lamp, matrix = thing.data, instance.matrix_world
        color, gain = color_and_gain(lamp, warnings)
        keys = shape(lamp, matrix.to_scale(), warnings)
        keys["intensity"] *= gain
        if lamp.type == "SUN":
            place = {}
        else:
            place = {"position": list(matrix.translation)}
        turn = matrix.to_quaternion().to_matrix()
        place["direction"], place["up"] = list(-turn.col[2]), list(turn.col[1])
        lamps.append({"name": unique_name(thing.name, taken), **keys, "normalize": True,
                      "color": color, **place})
    return lamps


def rounded(value):
    """Blender's numbers have single precision: seven digits."""
    if isinstance(value, float):
        return float(f"{value:.7g}") + 0.0  # no -0
    if isinstance(value, dict):
        return {key: rounded(part) for key, part in value.items()}
    return [rounded(part) for part in value] if isinstance(value, list) else value


def write_lamps(path, depsgraph):
    """One lamp on each line. Returns warnings."""
    warnings = []
    lamps = ",\n".join("  " + json.dumps(rounded(lamp)) for lamp in read_lamps(depsgraph, warnings))
    path.write_text(f'{{"lights": [\n{lamps}\n]}}\n')
    return warnings


# The tool


def find_tool():
    """The program ssdo: that of the preferences, else of the PATH."""
    addon = bpy.context.preferences.addons.get(__name__)
    path = bpy.path.abspath(addon.preferences.tool) if addon and addon.preferences.tool else "ssdo"
    found = shutil.which(path)
    if not found:
        raise RelightError(f"{path}: no such program; give the path of ssdo in Preferences > "
                           "Add-ons > ssdo")
    return found


def output_pattern(scene):
    """The frames that ssdo writes, with #### for their numbers."""
    folder = scene.ssdo.output
    if folder.startswith("//") and not bpy.data.filepath:
        raise RelightError(f"{folder}: this folder is relative to the .blend file; save that "
                           "first, or give another output folder")
    return Path(bpy.path.abspath(folder)) / f"{bpy.path.clean_name(scene.name)}.####.exr"


def frame_file(pattern, frame):
    return str(pattern).replace("####", f"{frame:04d}")


def commands(tool, scene, frames, folder, output):
    """Command lines that make the frames. Lamps are read once in a run: if they move, each frame is
    a run of its own."""
    settings = scene.ssdo
    words = [tool, str(folder / "frame.####.exr"), "-o", str(output), "--quality", settings.quality,
             "--overwrite", "--create-dirs", "--progress", "openjd"]
    options = more_options(settings)
    if "--env" not in options:
        words += ["--env", str(folder / "world.exr") if has_world(scene) else "0,0,0"]
    for also in ("panorama", "left", "right", "top"):
        if also.upper() in settings.also:
            words += ["--also", str(folder / f"{also}.####.exr")]
    words += ["--crop"] if settings.overscan else []
    words += ["--downsample", "2"] if settings.antialias else []
    words += options
    if not settings.use_lamps:
        runs, lamps = [frames], []
    else:
        lamps = [folder / f"lamps.{frame:04d}.json" for frame in frames]
        stay = len({path.read_text() for path in lamps}) == 1
        runs = [frames] if stay else [[frame] for frame in frames]
    made = []
    for i, run in enumerate(runs):
        lights = ["--lights", str(lamps[i])] if lamps and has_lamps(lamps[i]) else []
        shot = ["--shot", str(settings.shot)] if len(run) > 1 and settings.shot else []
        made.append([*words, *lights, *shot, "--frames", ",".join(str(frame) for frame in run)])
    return made


def more_options(settings):
    try:
        return shlex.split(settings.options)
    except ValueError as error:
        raise RelightError(f"More Options: {error}: {settings.options}") from None


def has_world(scene):
    """Whether its world lights the scene, and no map of More Options."""
    settings = scene.ssdo
    return settings.use_world and bool(scene.world) and "--env" not in more_options(settings)


def has_lamps(path):
    return bool(json.loads(path.read_text())["lights"])


def run_tool(command, folder, warnings):
    """Runs a command line; yields the share that is done, 0 to 1. What it prints is in the
    folder."""
    progress, messages = folder / "progress.txt", folder / "messages.txt"
    with progress.open("w") as out, messages.open("w") as err:
        try:
            tool = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err)
        except OSError as error:
            raise RelightError(f"{command[0]}: cannot be run ({error.strerror}); give the path of "
                               "ssdo in Preferences > Add-ons > ssdo") from None
    try:
        while tool.poll() is None:
            percents = re.findall(r"openjd_progress: (\d+)", progress.read_text())
            yield int(percents[-1]) / 100 if percents else 0.0
    finally:
        if tool.poll() is None:  # cancelled
            tool.terminate()
            tool.wait()
    lines = [line for line in messages.read_text().splitlines() if line.strip()]
    if tool.returncode:
        raise RelightError(lines[-1] if lines else f"ssdo ended with status {tool.returncode}")
    warnings += [line for line in lines if ": warning: " in line]


def relight(scene, layer, frames, warnings):
    """Renders frames of a view layer, runs ssdo and loads the result. Yields the share that is
    done, 0 to 1, and what is being done. Appends to `warnings`. The files in between are removed,
    but for those of a run that fails."""
    tool, output = find_tool(), output_pattern(scene)
    folder = Path(tempfile.mkdtemp(
        prefix="ssdo_", dir=bpy.context.preferences.filepaths.temporary_directory or None))
    try:
        if has_world(scene):
            yield 0.0, "rendering the world"
            render_world(scene.world, folder / "world.exr")
        views = len(frames) * (1 + len(scene.ssdo.also))
        rendered = 0
        for frame in frames:
            for name in render_frame(scene, layer, frame, folder, warnings):
                yield rendered / views / 2, f"rendering {name}"
                rendered += 1
        runs = commands(tool, scene, frames, folder, output)
        for i, command in enumerate(runs):
            print(shlex.join(command))
            for done in run_tool(command, folder, warnings):
                yield (1 + (i + done) / len(runs)) / 2, "relighting"
    except GeneratorExit:  # cancelled
        shutil.rmtree(folder)
        raise
    except (RelightError, RuntimeError, OSError) as error:
        raise RelightError(f"{str(error).strip()} (what was rendered is in {folder})") from error
    finally:
        scene.frame_set(scene.frame_current)  # objects are as in the last frame that was rendered
    shutil.rmtree(folder)
    show(scene, output, frames)


# The compositor


def compositor(scene):
    """The scene's node tree, made if there is none."""
    if hasattr(scene, "compositing_node_group"):  # Blender 5
        if not scene.compositing_node_group:
            scene.compositing_node_group = bpy.data.node_groups.new("Compositor",
                                                                    "CompositorNodeTree")
            show_render(scene.compositing_node_group)
        return scene.compositing_node_group
    scene.use_nodes = True
    return scene.node_tree


def show_render(tree):
    """Has the tree of a scene, which is empty, show the render, as Blender before 5 makes it."""
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    render, end = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("NodeGroupOutput")
    render.location = end.location - Vector((400, 0))
    tree.links.new(render.outputs[0], end.inputs[0])


def show(scene, output, frames):
    """Loads frames into the image node called ssdo. A new node is put over what the composite
    shows, if that is asked for."""
    tree = compositor(scene)
    node = tree.nodes.get("ssdo")
    is_new = node is None
    if is_new:
        node = tree.nodes.new("CompositorNodeImage")
        node.name = node.label = "ssdo"
    path = frame_file(output, frames[0])
    image = node.image or bpy.data.images.load(path, check_existing=True)
    image.name = output.name.replace(".####", "")
    image.filepath = bpy.path.relpath(path) if bpy.data.filepath else path
    image.source = "SEQUENCE" if len(frames) > 1 else "FILE"
    image.reload()
    node.image = image  # finds its layers
    if len(frames) > 1:  # the file of each frame has the frame's number
        node.frame_start, node.frame_offset = frames[0], frames[0] - 1
        node.frame_duration = frames[-1] - frames[0] + 1
        node.use_auto_refresh = True
    if is_new and scene.ssdo.join == "OVER":
        put_over(tree, node)


def put_over(tree, node):
    """Puts an image node over what each output of the tree shows; its RGB is premultiplied."""
    for end in [n for n in tree.nodes if n.type in ("COMPOSITE", "GROUP_OUTPUT") and n.inputs]:
        result, under = node.outputs[0], end.inputs[0].links
        node.location = end.location - Vector((600, 500))
        if under:
            over = tree.nodes.new("CompositorNodeAlphaOver")
            over.location = end.location
            end.location.x += 200
            images = [socket for socket in over.inputs if socket.type == "RGBA"]
            tree.links.new(under[0].from_socket, images[0])
            tree.links.new(result, images[1])
            result = over.outputs[0]
        tree.links.new(result, end.inputs[0])


# What Blender shows


class SsdoPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__

    tool: StringProperty(name="ssdo", subtype="FILE_PATH",
                         description="The program ssdo; if empty, the one on the PATH")

    def draw(self, _):
        self.layout.prop(self, "tool")


class SsdoSettings(bpy.types.PropertyGroup):
    output: StringProperty(name="Output", subtype="DIR_PATH", default="//ssdo/",
                           description="The folder of the frames that ssdo writes")
    overscan: IntProperty(name="Overscan", subtype="PERCENTAGE", default=25, min=0, max=100,
                          description="So much more picture on each side, for geometry outside it")
    also: EnumProperty(
        name="Also Render", options={"ENUM_FLAG"}, default={"PANORAMA"},
        description="Further small views of the scene, for geometry that the picture does not show",
        items=[("PANORAMA", "Panorama", "All around the camera"),
               ("LEFT", "Left", "The camera turned to the left about what it looks at"),
               ("RIGHT", "Right", "The camera turned to the right about what it looks at"),
               ("TOP", "Top", "From above on what the camera looks at")])
    use_world: BoolProperty(name="World", default=True, description="Light of the world")
    use_lamps: BoolProperty(name="Lamps", default=True, description="Light of lamps")
    antialias: BoolProperty(name="Antialias", default=True,
                            description="Render twice as large, for edges like those of a render")
    quality: EnumProperty(name="Quality", default="standard",
                          items=[("draft", "Draft", "2 x 8 samples"),
                                 ("standard", "Standard", "2 x 16 samples"),
                                 ("final", "Final", "6 x 48 samples")])
    shot: IntProperty(name="Frames Around", default=8, min=0, max=100,
                      description="Each frame of a range takes what so many frames before and "
                                  "after it have found, so that light does not swim")
    options: StringProperty(name="More Options",
                            description="Further options of ssdo, such as --products all or "
                                        "--no-cast crypto:NAME")
    join: EnumProperty(name="Compositor", default="OVER",
                       items=[("OVER", "Over", "Put the result over what the composite shows"),
                              ("NODE", "Node Only", "Add an image node, and no links")])


class RENDER_OT_ssdo(bpy.types.Operator):
    """Render a G-buffer of the current view layer, relight it with ssdo, and load the result into
    the compositor"""

    bl_idname = "render.ssdo"
    bl_label = "Relight with ssdo"
    bl_options = {"UNDO"}

    frames: EnumProperty(name="Frames", default="CURRENT",
                         items=[("CURRENT", "Current", "The current frame"),
                                ("RANGE", "Range", "The frame range of the scene")],
                         options={"SKIP_SAVE"})

    def start(self, context):
        scene = context.scene
        self.warnings = []
        frames = (list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))
                  if self.frames == "RANGE" else [scene.frame_current])
        self.steps = relight(scene, context.view_layer, frames, self.warnings)

    def step(self):
        """What is done, or None at the end; a RelightError is reported."""
        try:
            return next(self.steps)
        except StopIteration:
            for warning in dict.fromkeys(self.warnings):
                self.report({"WARNING"}, warning)
            self.result = {"FINISHED"}
        except RelightError as error:
            self.report({"ERROR"}, str(error))
            self.result = {"CANCELLED"}
        return None

    def execute(self, context):
        self.start(context)
        while self.step():
            time.sleep(0.02)
        return self.result

    def invoke(self, context, _):
        """Runs while the window shows how far it is. All else waits, as undo or an edit in between
        would change what is rendered."""
        self.start(context)
        context.window_manager.progress_begin(0, 100)
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.steps.close()
            return self.end(context, {"CANCELLED"})
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        done = self.step()
        if not done:
            return self.end(context, self.result)
        context.window_manager.progress_update(100 * done[0])
        context.workspace.status_text_set(f"ssdo: {done[1]}, {done[0]:.0%} (Esc cancels)")
        return {"RUNNING_MODAL"}

    def end(self, context, result):
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        return result


class RENDER_PT_ssdo(bpy.types.Panel):
    bl_label = "ssdo"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        scene, layout = context.scene, self.layout
        row = layout.row(align=True)
        row.operator("render.ssdo", text="Relight Frame").frames = "CURRENT"
        row.operator("render.ssdo", text=f"Frames {scene.frame_start}-{scene.frame_end}"
                     ).frames = "RANGE"
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in ("output", "join", "quality", "overscan"):
            layout.prop(scene.ssdo, name)
        layout.column().prop(scene.ssdo, "also")
        for name in ("use_world", "use_lamps", "antialias", "shot", "options"):
            layout.prop(scene.ssdo, name)


CLASSES = (SsdoPreferences, SsdoSettings, RENDER_OT_ssdo, RENDER_PT_ssdo)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.ssdo = PointerProperty(type=SsdoSettings)


def unregister():
    del bpy.types.Scene.ssdo
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
