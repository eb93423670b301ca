// SPDX-License-Identifier: Apache-2.0
#include "support/gbuffer_of.h"

namespace ssdo::test {

GBuffer gbuffer_of(const Picture& picture) {
  GBuffer g;
  g.window = g.display = picture.window;
  g.position = picture.position;
  g.normal = picture.normal;
  g.valid = picture.valid;
  g.position_step = 1.0f / 16777216;
  return g;
}

}  // namespace ssdo::test
