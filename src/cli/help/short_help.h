// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace ssdo {

/// What `ssdo --help` prints: what most need, on one screen of 24 lines of 80 columns.
inline constexpr std::string_view kShortHelp =
    R"(Puts light back into a rendered frame, from its G-buffer (P, N, albedo, depth).
  ssdo INPUT -o OUTPUT   relight a frame, or a sequence such as shot.####.exr
  ssdo info INPUT        say what was found, what would be done and why
  ssdo bench INPUT       speed against error of methods and settings
  ssdo compare A B       error between two images, layer by layer

  -o FILE                .exr holds the products, .png .jpg .tif the composite
  --env FILE|R,G,B       lat-long map, or a constant colour; default 1,1,1
  --radius R             reach of occluders in scene units; default: no limit
  --quality LEVEL        draft, standard or final; default standard
  --products LIST        of an EXR: ao, bent, direct, bounce, composite, or all
  --save PRODUCT=FILE    a product in a file of its own
  --aov ROLE=LAYER       the layer for a role, where it is not found by its name
  --also FILE            another view of the scene, in place of guesses
  --frames RANGE         frames of a sequence: 1001-1010; default: all
  --overwrite            replace outputs that exist

  ssdo shot.exr -o relit.exr -o relit.png --env sky.exr
  ssdo shot.####.exr -o relit.####.exr --frames 1001-1010 --skip-existing
  ssdo info shot.exr

All options: ssdo --help-all; of a command: ssdo bench --help.
Methods: ssdo --list-methods. Manual: man ssdo, man ssdo-methods.
)";

}  // namespace ssdo
