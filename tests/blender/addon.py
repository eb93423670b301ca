# SPDX-License-Identifier: Apache-2.0
"""What tests/blender/run.sh runs in Blender: addon.py -- SSDO FOLDER."""
import shutil
import signal
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

import bpy
from mathutils import Vector

TOOL, WORK = (Path(word) for word in sys.argv[sys.argv.index("--") + 1:])
DATA = Path(__file__).resolve().parents[2] / "data"
STUDIO = DATA / "environments/studio.exr"
sys.path.append(str(DATA / "blender"))

bpy.ops.preferences.addon_install(filepath=str(DATA / "blender/ssdo_relight.py"))
bpy.ops.preferences.addon_enable(module="ssdo_relight")
import ssdo_relight as addon  # noqa: E402
from export import add_camera, add_world  # noqa: E402
from scenes import SCENES, Lamp  # noqa: E402

TEMPORARY = WORK / "temporary"
BULB = Lamp("a bulb", "POINT", (1.5, -0.6, 1.4), (0, 0, 0), 60, (1.0, 0.8, 0.5),
            {"shadow_soft_size": 0.1})


def build(width=160, height=90):
    """The room corner with a bulb, in a file that is saved, with settings that are not Blender's
    own. Its current view layer is not the first one."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="ssdo_relight")
    preferences = bpy.context.preferences
    preferences.addons["ssdo_relight"].preferences.tool = str(TOOL)
    preferences.filepaths.temporary_directory = str(TEMPORARY)
    scene, picture = bpy.context.scene, SCENES["room_corner"]
    picture.build()
    BULB.put()
    add_camera(scene, picture)
    add_world(scene, picture.environment)
    scene.name = "Shot 1"
    scene.render.resolution_x, scene.render.resolution_y = 2 * width, 2 * height
    scene.render.resolution_percentage = 50
    scene.render.use_border = True
    scene.render.use_motion_blur = True
    scene.render.image_settings.file_format = "TIFF"
    scene.render.image_settings.color_mode = "BW"
    scene.render.image_settings.color_depth = "16"
    scene.frame_set(3)
    current = scene.view_layers.new("current.layer")
    bpy.context.window.view_layer = current
    scene.ssdo.quality = "draft"
    scene.ssdo.antialias = False
    bpy.ops.wm.save_as_mainfile(filepath=str(WORK / "shot.blend"), check_existing=False)
    return scene


def relight(**options):
    """The error of the operator, or None."""
    try:
        bpy.ops.render.ssdo(**options)
    except RuntimeError as error:
        return str(error)
    return None


def kept_folders():
    """Those that runs have left, which are removed."""
    folders = list(TEMPORARY.glob("ssdo_*"))
    for folder in folders:
        shutil.rmtree(folder)
    return folders


def oiiotool(*words):
    return subprocess.run(["oiiotool", *words], check=True, capture_output=True, text=True).stdout


def are_equal(a, b, within=0):
    limits = ["--fail", str(within), "--warn", str(within)]
    done = subprocess.run(["oiiotool", a, b, *limits, "--diff"], capture_output=True, text=True)
    return done.returncode == 0 or done.stdout + done.stderr


def ssdo(*words):
    return subprocess.run([TOOL, *words], capture_output=True, text=True)


def settings_of(owner):
    """The plain values of one of Blender's structures; data that it refers to by name."""
    found = {}
    for name, kind in owner.bl_rna.properties.items():
        if kind.type not in ("POINTER", "COLLECTION"):
            value = getattr(owner, name)
            found[name] = list(value) if getattr(kind, "is_array", False) else value
        elif isinstance(kind.fixed_type, bpy.types.ID):
            found[name] = str(getattr(owner, name))
    for name in ("use_nodes", "node_tree", "users"):
        found.pop(name, None)  # the compositor is what is to change
    return found


def state():
    """What the artist sees of the scene, and the names of all data that the file would keep."""
    scene, kept = bpy.context.scene, ("scenes", "objects", "cameras", "worlds", "node_groups")
    owners = [scene, scene.render, scene.render.image_settings, scene.cycles, scene.camera,
              scene.camera.data, scene.camera.data.dof, scene.world, scene.world.cycles_visibility,
              *scene.view_layers, *(layer.cycles for layer in scene.view_layers)]
    return {"settings": [settings_of(owner) for owner in owners],
            "layer": bpy.context.view_layer.name,
            "data": {kind: sorted(getattr(bpy.data, kind).keys()) for kind in kept}}


def composited(scene, frame, path):
    """What the image node called ssdo gives to the composite in a frame, as a float EXR. The nodes
    of the scene's own render go."""
    tree = scene.node_tree
    for node in [node for node in tree.nodes if node.type == "R_LAYERS"]:
        tree.nodes.remove(node)
    tree.links.new(tree.nodes["ssdo"].outputs["Combined"], tree.nodes["Composite"].inputs[0])
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGBA", "32"
    scene.render.filepath = str(path)
    scene.render.use_border = False
    scene.frame_set(frame)
    bpy.ops.render.render(write_still=True)


def shown(scene, width, height):
    """The object that each pixel's centre shows, or None, as rays through the scene find it; from
    the lower left corner, row by row."""
    place, depsgraph = scene.camera.matrix_world, bpy.context.evaluated_depsgraph_get()
    corners = scene.camera.data.view_frame(scene=scene)
    low, high = (Vector(map(side, zip(*corners))) for side in (min, max))
    found = []
    for i in range(width * height):
        x, y = (i % width + 0.5) / width, (i // width + 0.5) / height
        through = Vector((low.x + (high.x - low.x) * x, low.y + (high.y - low.y) * y, low.z))
        hit, *_, thing, _ = scene.ray_cast(depsgraph, place.translation, place.to_3x3() @ through)
        found.append(thing if hit else None)
    return found


class InAWindow:
    """What Blender's window does with the operator, played: blender -b has no window to send it
    events from. The operator's own functions run, on a real scene."""

    frames = "CURRENT"
    for name in ("start", "step", "invoke", "modal", "end"):
        locals()[name] = getattr(addon.RENDER_OT_ssdo, name)
    del name

    def __init__(self, scene):
        self.reports = []
        self.context = mock.Mock(scene=scene, view_layer=bpy.context.view_layer)
        self.status = self.context.workspace.status_text_set
        self.result = self.invoke(self.context, None)

    def report(self, kind, text):
        self.reports.append((kind, text))

    def send(self, kind):
        self.result = self.modal(self.context, mock.Mock(type=kind))
        return self.result

    def run_until(self, text):
        """Sends ticks of the timer until the status line shows a text."""
        while not any(text in str(call) for call in self.status.mock_calls):
            if self.send("TIMER") != {"RUNNING_MODAL"}:
                raise AssertionError(f"ended before {text}: {self.result} {self.reports}")

    def is_put_away(self):
        """Whether timer, progress and status line are gone."""
        manager = self.context.window_manager
        return (manager.event_timer_remove.mock_calls == [mock.call(self.timer)] and
                manager.progress_end.call_count == 1 and
                self.status.mock_calls[-1] == mock.call(None))


class Composite(unittest.TestCase):
    def test_it_has_the_bits_of_the_command_line(self):
        scene = build(480, 270)  # as large as export.py makes it
        scene.ssdo.use_lamps = False
        scene.ssdo.options = f"--env '{STUDIO}'"
        before = state()
        with mock.patch.object(addon.shutil, "rmtree"):
            self.assertIsNone(relight())
        self.assertEqual(state(), before)
        [kept] = TEMPORARY.glob("ssdo_*")
        frame, around = (kept / f"{name}.0003.exr" for name in ("frame", "panorama"))
        done = ssdo(frame, "-o", WORK / "expected.exr", "--crop", "--quality", "draft",
                    "--also", around, "--env", STUDIO)
        self.assertEqual(done.returncode, 0, done.stderr)
        made = WORK / "ssdo/Shot_1.0003.exr"
        self.assertIs(are_equal(made, WORK / "expected.exr"), True)
        composited(scene, 3, WORK / "composited.exr")
        oiiotool(made, "--ch", "R,G,B,A", "-o", WORK / "composite.exr")
        self.assertIs(are_equal(WORK / "composited.exr", WORK / "composite.exr"), True)
        # Two renders of Cycles differ in the last bits of a few pixels.
        subprocess.run([bpy.app.binary_path, "-b", "--factory-startup", "-P",
                        DATA / "blender/export.py", "--", "room_corner", "-o", WORK / "wide.exr",
                        "--overscan", "25", "--pano", WORK / "around.exr"],
                       check=True, stdout=subprocess.DEVNULL)
        for file, exported in ((frame, "wide"), (around, "around")):
            for name, layer in (("a", "current.layer"), ("b", "ViewLayer")):
                oiiotool(file if name == "a" else WORK / f"{exported}.exr", "--ch",
                         ",".join(f"{layer}.Position.{c}" for c in "XYZ"), "--chnames", "X,Y,Z",
                         "-o", WORK / f"{name}.exr")
            self.assertIs(are_equal(WORK / "a.exr", WORK / "b.exr", 2e-5), True)
        self.assertEqual(kept_folders(), [kept])

    def test_it_lies_over_what_is_there_and_is_put_there_once(self):
        scene = build()
        self.assertIsNone(relight())
        self.assertEqual(kept_folders(), [])
        nodes = {node.name: node for node in scene.node_tree.nodes}
        over = nodes["Composite"].inputs[0].links[0].from_node
        self.assertEqual(over.type, "ALPHAOVER")
        self.assertEqual([socket.links[0].from_node.name for socket in over.inputs[1:]],
                         ["Render Layers", "ssdo"])
        scene.node_tree.links.remove(over.inputs[2].links[0])
        self.assertIsNone(relight())
        self.assertEqual(set(nodes), {node.name for node in scene.node_tree.nodes})
        self.assertFalse(over.inputs[2].is_linked)
        self.assertEqual(len([image for image in bpy.data.images if "Shot" in image.name]), 1)

    def test_a_range_is_a_sequence_with_the_bits_of_its_files(self):
        scene = build()
        scene.frame_start, scene.frame_end, scene.ssdo.shot = 9, 10, 1
        for frame, x in ((9, 0.0), (10, 0.4)):
            scene.objects["a bulb"].location.x = x
            scene.camera.delta_location.x = x
            scene.camera.keyframe_insert("delta_location", frame=frame)
        scene.frame_set(3)
        before = state()
        self.assertIsNone(relight(frames="RANGE"))
        self.assertEqual(state(), before)
        files = [WORK / f"ssdo/Shot_1.{frame:04d}.exr" for frame in (9, 10)]
        self.assertIsNot(are_equal(*files), True)
        for frame, file in zip((9, 10), files):
            composited(scene, frame, WORK / "composited.exr")
            oiiotool(file, "--ch", "R,G,B,A", "-o", WORK / "composite.exr")
            self.assertIs(are_equal(WORK / "composited.exr", WORK / "composite.exr"), True)

    def test_lamps_that_move_are_those_of_each_frame(self):
        scene = build()
        scene.frame_start, scene.frame_end = 1, 2
        scene.ssdo.use_world = False
        scene.ssdo.also = set()
        for frame, power in ((1, 60), (2, 120)):
            bpy.data.lights[0].energy = power
            bpy.data.lights[0].keyframe_insert("energy", frame=frame)
        self.assertIsNone(relight(frames="RANGE"))
        means = [oiiotool(WORK / f"ssdo/Shot_1.{frame:04d}.exr", "--ch", "direct.G", "--echo",
                          "{TOP.AVGCOLOR}") for frame in (1, 2)]
        self.assertAlmostEqual(float(means[1]) / float(means[0]), 2, places=2)

    def test_lamps_give_a_floor_the_light_that_they_give_in_blender(self):
        for name, kind, height, tilt in (("point", "POINT", 0.3, 0), ("spot", "SPOT", 1, 0.8)):
            scene = build()
            for thing in [t for t in scene.objects if t.type != "CAMERA"]:
                bpy.data.objects.remove(thing)
            bpy.ops.mesh.primitive_plane_add(size=20)
            bpy.ops.mesh.primitive_cube_add(size=0.3, location=(0.8, 0.4, 0))  # shows the camera
            Lamp(name, kind, (0, 0, height), (0, 0, 0), 60, (1, 1, 1),
                 {"shadow_soft_size": 0.1}).put()
            lamp = scene.objects[name]
            lamp.rotation_euler = (tilt, 0, 0)
            if kind == "SPOT":
                lamp.data.spot_size, lamp.data.spot_blend = 2.4, 0.7
            scene.camera.location, scene.camera.rotation_euler = (0, 0, 3), (0, 0, 0)
            scene.ssdo.use_world, scene.ssdo.also = False, set()
            self.assertIsNone(relight())
            scene.world = None
            scene.render.engine = "CYCLES"
            scene.cycles.samples, scene.cycles.use_denoising = 64, False
            for layer in scene.view_layers:
                layer.use_pass_diffuse_direct = True
            scene.render.use_compositing = False
            scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
            scene.render.filepath = str(WORK / f"{name}.exr")
            bpy.ops.render.render(write_still=True)
            means = [float(oiiotool(file, "--ch", channel, "--echo", "{TOP.AVGCOLOR}"))
                     for file, channel in ((WORK / "ssdo/Shot_1.0003.exr", "direct.G"),
                                           (WORK / f"{name}.exr", "current.layer.DiffDir.G"))]
            self.assertAlmostEqual(means[0] / means[1], 1, delta=0.01, msg=name)

    def test_an_object_that_cryptomatte_names_is_cut_out(self):
        scene = build()
        ball = scene.objects["ball.001"]
        ball.name = "a ball, of mine"
        scene.ssdo.antialias = False
        scene.ssdo.options = "--env 1,1,1 --holdout 'crypto:a ball, of mine'"
        with mock.patch.object(addon.shutil, "rmtree"):
            self.assertIsNone(relight())
        oiiotool(WORK / "ssdo/Shot_1.0003.exr", "--ch", "R=A,G=A,B=A", "-o", WORK / "alpha.exr")
        picture = bpy.data.images.load(str(WORK / "alpha.exr"))
        alpha, things = picture.pixels[:][::picture.channels], shown(scene, *picture.size)
        self.assertGreater(things.count(ball), 200)
        wrong = [i for i, thing in enumerate(things)
                 if (alpha[i] > 0.5) == (thing is None or thing == ball)]
        self.assertLess(len(wrong), 5)  # rays of Cycles differ in the last bits
        [kept] = kept_folders()

    def test_a_map_of_more_options_replaces_the_world(self):
        scene = build()
        scene.ssdo.use_lamps = False
        for options, has_world in (("--env-rotate 90", True), ("--env 1,1,1", False)):
            scene.ssdo.options = options
            [words] = addon.commands("ssdo", scene, [3], WORK, WORK / "out.exr")
            self.assertEqual(str(WORK / "world.exr") in words, has_world)
            self.assertEqual(words.count("--env"), 1)


class Failures(unittest.TestCase):
    def test_the_line_of_the_tool_is_shown_and_its_files_are_kept(self):
        scene = build()
        scene.ssdo.options = "--method nonsense"
        before = state()
        error = relight()
        line = ssdo("in.exr", "-o", "out.exr", "--method", "nonsense").stderr.strip()
        self.assertIn(line, error)
        self.assertEqual(state(), before)
        [kept] = TEMPORARY.glob("ssdo_*")
        self.assertIn(f"(what was rendered is in {kept})", error)
        # The pixels that are rendered are of the current view layer, and of no other.
        listed = oiiotool("--info", "-v", kept / "frame.0003.exr")
        self.assertIn("current.layer.Position.X", listed)
        self.assertNotIn("ViewLayer.", listed)
        self.assertEqual(kept_folders(), [kept])

    def test_an_error_between_changes_nothing(self):
        build()
        before = state()
        with mock.patch.object(addon, "set_windows", side_effect=OSError("the disk is full")):
            self.assertIn("the disk is full", relight())
        self.assertEqual(state(), before)
        self.assertEqual(len(kept_folders()), 1)

    def test_a_run_that_is_cancelled_leaves_nothing(self):
        scene = build()
        before = state()
        steps = addon.relight(scene, bpy.context.view_layer, [3], [])
        while next(steps)[0] < 0.5:
            pass
        steps.close()
        self.assertEqual(state(), before)
        self.assertEqual(kept_folders(), [])

    def test_escape_ends_the_tool_and_leaves_nothing(self):
        scene = build()
        slow = WORK / "slow.sh"
        slow.write_text("#!/bin/sh\nexec sleep 600\n")
        slow.chmod(0o755)
        bpy.context.preferences.addons["ssdo_relight"].preferences.tool = str(slow)
        before = state()
        started, popen = [], subprocess.Popen
        with mock.patch.object(addon.subprocess, "Popen",
                               side_effect=lambda *a, **b: started.append(popen(*a, **b)) or
                               started[-1]):
            window = InAWindow(scene)
            window.run_until("relighting")
        steps = window.status.call_count
        self.assertEqual(window.send("MOUSEMOVE"), {"RUNNING_MODAL"})
        self.assertEqual(window.status.call_count, steps)
        self.assertEqual([tool.poll() for tool in started], [None])
        self.assertEqual(window.send("ESC"), {"CANCELLED"})
        self.assertEqual([tool.poll() for tool in started], [-signal.SIGTERM])
        self.assertTrue(window.is_put_away())
        self.assertEqual(window.reports, [])
        self.assertEqual(state(), before)
        self.assertEqual(kept_folders(), [])
        self.assertIsNone(scene.node_tree)

    def test_escape_between_renders_leaves_nothing(self):
        scene = build()
        before = state()
        window = InAWindow(scene)
        window.run_until("rendering panorama")
        self.assertEqual(window.send("ESC"), {"CANCELLED"})
        self.assertTrue(window.is_put_away())
        self.assertEqual(state(), before)
        self.assertEqual(kept_folders(), [])

    def test_a_window_gets_the_result_or_the_error(self):
        scene = build()
        for options, result, kinds in (("", {"FINISHED"}, []),
                                       ("--method nonsense", {"CANCELLED"}, [{"ERROR"}])):
            scene.ssdo.options = options
            window = InAWindow(scene)
            while window.send("TIMER") == {"RUNNING_MODAL"}:
                pass
            self.assertEqual(window.result, result)
            self.assertEqual([kind for kind, _ in window.reports if kind != {"WARNING"}], kinds)
            self.assertTrue(window.is_put_away())
        self.assertEqual(scene.node_tree.nodes["ssdo"].image.name, "Shot_1.exr")
        self.assertEqual(len(kept_folders()), 1)

    def test_what_is_missing_is_named(self):
        scene = build()
        preferences = bpy.context.preferences.addons["ssdo_relight"].preferences
        for tool in ("no_such_tool", str(STUDIO)):
            preferences.tool = tool
            self.assertIn(f"{tool}: no such program; give the path of ssdo", relight())
        preferences.tool = str(TOOL)
        scene.ssdo.options = "--env 'no end"
        self.assertIn("More Options: No closing quotation: --env 'no end", relight())
        scene.ssdo.options = ""
        scene.camera = None
        self.assertIn("Shot 1: the scene has no camera", relight())
        self.assertEqual(len(kept_folders()), 2)
        with mock.patch.object(addon.bpy, "data", mock.Mock(filepath="")):
            with self.assertRaisesRegex(addon.RelightError, "//ssdo/: .* save that first"):
                addon.output_pattern(scene)

    def test_it_can_be_switched_off(self):
        bpy.ops.preferences.addon_disable(module="ssdo_relight")
        self.assertFalse(hasattr(bpy.types.Scene, "ssdo"))
        bpy.ops.preferences.addon_enable(module="ssdo_relight")
        self.assertTrue(hasattr(bpy.types.Scene, "ssdo"))


class Render(unittest.TestCase):
    def test_overscan_leaves_the_pixels_of_the_picture_as_they_are(self):
        cases = [("PERSP", "AUTO", (40, 24)), ("PERSP", "AUTO", (24, 40)),
                 ("PERSP", "VERTICAL", (40, 24)), ("ORTHO", "AUTO", (24, 40))]
        scene = build()
        camera = scene.camera.data
        for kind, fit, size in cases:
            with self.subTest(kind=kind, fit=fit, size=size):
                camera.type, camera.sensor_fit, camera.ortho_scale = kind, fit, 4
                camera.sensor_width, camera.sensor_height = 32, 24
                camera.shift_x, camera.shift_y = 0.1, -0.15
                scene.render.pixel_aspect_x = 1.5
                with addon.copy_for_rendering(scene, bpy.context.view_layer) as copy:
                    layer = copy.view_layers["current.layer"]
                    for percent, name in ((0, "plain"), (30, "wide")):
                        copy.render.resolution_x, copy.render.resolution_y = size
                        view = addon.View(WORK / f"{name}.exr",
                                          addon.copied_camera(copy, scene.camera), size)
                        addon.render(copy, addon.widened(view, percent), ["position"], layer)
                files = [WORK / f"{name}.P.exr" for name in ("plain", "wide")]
                position = ",".join(f"current.layer.Position.{c}" for c in "XYZ")
                for name, file in zip(("plain", "wide"), files):
                    oiiotool(WORK / f"{name}.exr", "--crop", f"{size[0]}x{size[1]}+0+0", "--ch",
                             position, "-o", file)
                self.assertIs(are_equal(*files, 2e-5), True)

    def test_windows_are_those_of_oiiotool(self):
        for subimages in (1, 2):
            files = [WORK / "moved.exr", WORK / "expected.exr"]
            parts = ["--pattern", "fill:topleft=0,1,0:bottomright=1,0,1", "40x44", "3"] * subimages
            oiiotool(*parts, *(["--siappend"] if subimages > 1 else []), "--compression", "zip",
                     "-d", "float", "-o", files[0])
            oiiotool(files[0], "-a", "--origin", "-4-6", "--fullsize", "32x32+0+0", "-o", files[1])
            addon.set_windows(addon.View(files[0], None, (32, 32), (4, 6)))
            self.assertIs(are_equal(*files), True)
            listed = oiiotool("--info", "-v", "-a", files[0])
            self.assertEqual(listed.count("pixel data origin: x=-4, y=-6"), subimages)
            self.assertEqual(listed.count("full/display size: 32 x 32"), subimages)

    def test_the_world_is_the_map_that_lights_it(self):
        scene = build()
        addon.render_world(scene.world, WORK / "world.exr")
        oiiotool(WORK / "world.exr", "--ch", ",".join(f"ViewLayer.Combined.{c}" for c in "RGB"),
                 "--chnames", "R,G,B", "-o", WORK / "map.exr")
        self.assertIs(are_equal(WORK / "map.exr", STUDIO, 2e-5), True)

    def test_the_camera_is_that_of_the_markers(self):
        scene = build()
        cam, other = scene.camera, bpy.data.objects.new("other", bpy.data.cameras.new("other"))
        scene.timeline_markers.new("cut", frame=5).camera = other
        scene.timeline_markers.new("back", frame=9).camera = cam
        cameras = [addon.camera_at(scene, frame).name for frame in (1, 5, 8, 9)]
        self.assertEqual(cameras, ["other", "other", "other", "cam"])


if not unittest.main(argv=["addon"], exit=False).result.wasSuccessful():
    sys.exit(1)
