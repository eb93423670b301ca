# SPDX-License-Identifier: Apache-2.0
"""Renders one small frame in each of the layouts that Blender writes, for the tests.

    blender -b -P export_layouts.py -- exports

`multilayer.exr` is Blender's own output; `node.exr` and a file for each pass (`node_position.exr`) are
what the compositor's File Output node writes, whose slots are named here.
"""
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
# Blender does not put a script's own folder on the path.
from export import add_camera, add_world  # noqa: E402
from scenes import SCENES  # noqa: E402
from ssdo_relight import set_up_cycles, set_up_output  # noqa: E402

SIZE = (96, 54)
PASSES = ["z", "position", "normal", "diffuse_color"]

# The slot of the node, and the socket of the render layers that leads to it.
SLOTS = {"Position": "Position", "Normal": "Normal", "Albedo": "DiffCol", "Depth": "Depth"}


def add_node(scene, file_format, base_path):
    node = scene.node_tree.nodes.new("CompositorNodeOutputFile")
    node.base_path = str(base_path)
    node.format.file_format = file_format
    node.format.color_depth = "32"
    node.format.exr_codec = "ZIP"
    node.inputs.clear()
    return node


def add_nodes(scene, folder):
    """The node twice: all slots as layers of one file, and a file for each."""
    scene.use_nodes = True
    layers = scene.node_tree.nodes["Render Layers"]
    together = add_node(scene, "OPEN_EXR_MULTILAYER", folder / "node")
    apart = add_node(scene, "OPEN_EXR", folder)
    for slot, socket in SLOTS.items():
        for slots, node, path in ((together.layer_slots, together, slot),
                                  (apart.file_slots, apart, f"node_{slot.lower()}")):
            slots.new(path)
            scene.node_tree.links.new(layers.outputs[socket], node.inputs[-1])


def drop_frame_number(folder, number):
    for path in folder.glob(f"*{number:04d}.exr"):
        path.rename(path.with_name(path.name.replace(f"{number:04d}.exr", ".exr")))


def main():
    folder = Path(sys.argv[sys.argv.index("--") + 1]).resolve()
    picture = SCENES["still_life"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    picture.build()
    add_camera(scene, picture)
    add_world(scene)
    set_up_cycles(scene, samples=1, bounces=0, seed=0)
    set_up_output(scene, SIZE, folder / "multilayer.exr", PASSES)
    scene.render.use_compositing = True
    add_nodes(scene, folder)
    bpy.ops.render.render(write_still=True)
    drop_frame_number(folder, scene.frame_current)


if __name__ == "__main__":
    main()
