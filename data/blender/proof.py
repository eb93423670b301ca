# SPDX-License-Identifier: Apache-2.0
"""G-buffers and path-traced answers of the scenes of proof_scenes.py, for data/prior/truth_test.py

    blender -b -P proof.py -- FOLDER SAMPLES [SCENE...]

writes FOLDER/public/SCENE/ with the files that truth_test.py reads, and FOLDER/env/. Light that
arrives directly, no bounces. Each answer has a second render, *_again.exr, with another seed: the
difference of the two gives the noise. With 0 samples only the G-buffers are rendered."""
import json
import shutil
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from export import ENVIRONMENTS, add_camera, add_world  # noqa: E402
from proof_scenes import PROOF_SCENES  # noqa: E402
from ssdo_relight import SURFACES, set_up_cycles, set_up_output  # noqa: E402


def render(scene, picture, path, samples, world, radius=1.0, seed=0):
    """The picture in one world; the AO pass, which does not depend on it, is in the same file."""
    add_world(scene, picture.environment if world == "map" else None)
    scene.world.light_settings.distance = radius
    set_up_cycles(scene, samples, 0, seed)
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    passes = ["z", "diffuse_direct", "ambient_occlusion"] if samples > 1 else SURFACES
    set_up_output(scene, (picture.width, picture.height), path, passes)
    bpy.ops.render.render(write_still=True)


def main():
    folder, samples, *names = sys.argv[sys.argv.index("--") + 1:]
    folder, samples = Path(folder), int(samples)
    (folder / "env").mkdir(parents=True, exist_ok=True)
    for path in ENVIRONMENTS.glob("*.exr"):
        shutil.copy(path, folder / "env")
    for name in names or PROOF_SCENES:
        picture, out = PROOF_SCENES[name], folder / "public" / name
        out.mkdir(parents=True, exist_ok=True)
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        picture.build()
        add_camera(scene, picture)
        render(scene, picture, out / "gbuffer.exr", 1, "white")
        near, far = picture.ao_radii
        for seed, again in ((0, ""), (1, "_again")) if samples else ():
            for world, answer, radius in (("white", "white", near), ("map", "env_direct", far)):
                path = out / f"truth_{answer}{again}.exr"
                render(scene, picture, path, samples, world, radius, seed)
                shutil.copy(path, out / f"truth_ao_{radius:g}{again}.exr")
        camera = json.dumps({"env": picture.environment}) + "\n"
        (out / "camera.json").write_text(camera)


if __name__ == "__main__":
    main()
