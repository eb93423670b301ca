# SPDX-License-Identifier: Apache-2.0
"""Writes the lamps of a scene to a file for `ssdo --lights`.

    blender scene.blend -b -P lamps.py -- lamps.json

export.py does so for the scenes of data/.
"""
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
# Blender does not put a script's own folder on the path.
from ssdo_relight import write_lamps  # noqa: E402

for warning in write_lamps(Path(sys.argv[sys.argv.index("--") + 1]),
                           bpy.context.evaluated_depsgraph_get()):
    print(warning, file=sys.stderr)
