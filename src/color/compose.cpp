// SPDX-License-Identifier: Apache-2.0
//
// The composites. Rendered layers are premultiplied, and so is the result, so that edges whose
// alpha is between 0 and 1 need no division.
//
//   relight   F[alpha albedo (direct + bounce)]
//   occlude   beauty - ambient (1 - S) - specular (1 - reflection)
//   add       beauty + F[alpha albedo (direct + bounce)]
//
// F is the mean of the pixels of the G-buffer that a pixel of the output shows: one of them, or
// those under the pixel filter with --downsample. The rendered layers have the output's size.
//
// S is the share of the environment's light that arrives. Light from everywhere alike is hidden by
// 1 - ao. Of other light, each channel has a share of its own, direct over the direct light without
// occluders: what hides a red light and not a green one throws a green shadow, where ao would make
// it brown (Ritschel, Grosch, Seidel, "Approximating Dynamic Global Illumination in Image Space",
// 2009). Under the filter it is F[alpha albedo direct] / F[alpha albedo unoccluded], as an ambient
// layer that the renderer has filtered is F[alpha albedo unoccluded]. What lamps give stays as
// rendered: ambient is a part of the beauty.
//
// occlude and add keep the beauty and its alpha where there is no geometry.
#include "color/compose.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <type_traits>

#include "color/downsample.h"
#include "math/light_range.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Directions from camera space into the space of the input's normals.
Plane<glm::vec3> in_input_space(Plane<glm::vec3> directions, const glm::mat3& normals_to_camera) {
  // The one is turned against the other, so that the transpose is the inverse.
  for (glm::vec3& d : directions.pixels) {
    const glm::vec3 seen = d;
    for (int c = 0; c < 3; ++c) d[c] = glm::dot(normals_to_camera[c], seen);
  }
  return directions;
}

/// albedo (direct + bounce).
glm::vec3 light_of(const Results& r, std::size_t i) {
  glm::vec3 light = r.products.direct[i];
  if (!r.products.bounce.empty()) light += r.products.bounce[i];
  return within_range(r.scene.senders.albedo[i] * light);
}

/// What surfaces send of the light that was found, premultiplied.
Plane<glm::vec3> sent_light(const Results& r, const Plane<float>& alpha) {
  auto sent = Plane<glm::vec3>::like(alpha);
  for_each_row(sent.height, [&](int y) {
    for (std::size_t i = sent.index(0, y); i < sent.index(0, y + 1); ++i)
      sent[i] = alpha[i] * light_of(r, i);
  });
  return at_output_size(std::move(sent), r.gbuffer);
}

/// Light of the environment at the surfaces of a pixel: the visible part, and all of it.
struct Arriving {
  Plane<glm::vec3> part, whole;
};

Arriving arriving_light(const Results& r) {
  Arriving light;
  light.whole = weights_by_albedo(r);
  light.part = light.whole;
  for_each_row(light.part.height, [&](int y) {
    for (std::size_t i = light.part.index(0, y); i < light.part.index(0, y + 1); ++i) {
      if (light.whole[i] == glm::vec3(0)) continue;  // without a surface there is no normal
      if (r.composition.share_is_ao) {
        light.part[i] *= r.products.ao[i];
      } else {
        light.part[i] *= r.products.direct[i];
        const Surfel& s = r.scene.geometry.surfel[i];
        light.whole[i] *= r.scene.light.unoccluded(s.position, s.normal);
      }
    }
  });
  return {at_output_size(std::move(light.part), r.gbuffer),
          at_output_size(std::move(light.whole), r.gbuffer)};
}

/// The share of the light that arrives, by channel, 0 to 1. Methods that look light up in another
/// direction than the normal may find more than arrives without occluders; occlusion brightens
/// nothing. A channel without light has the share of all channels together, and where there is no
/// light at all, nothing is taken away.
glm::vec3 arriving_share(const glm::vec3& part, const glm::vec3& whole) {
  const auto share = [](float arriving, float light, float otherwise) {
    return light > 0 ? std::clamp(arriving / light, 0.0f, 1.0f) : otherwise;
  };
  const float all = share(part.x + part.y + part.z, whole.x + whole.y + whole.z, 1);
  return {share(part.x, whole.x, all), share(part.y, whole.y, all), share(part.z, whole.z, all)};
}

/// What occlude and add change: the beauty, or the ambient layer alone where there is no beauty.
const Plane<glm::vec3>& rendered(const GBuffer& gbuffer) {
  return gbuffer.beauty.empty() ? gbuffer.ambient : gbuffer.beauty;
}

Plane<glm::vec3> occluded(const Results& r) {
  const Plane<glm::vec3>&beauty = rendered(r.gbuffer), &ambient = r.gbuffer.ambient,
        &specular = r.gbuffer.specular;
  const Arriving light = arriving_light(r);
  Plane<float> reflection;
  if (!specular.empty())
    reflection = product_at_output_size(find_product("reflection"), r.products.reflection, r);
  auto out = Plane<glm::vec3>::like(beauty);
  for_each_row(out.height, [&](int y) {
    for (std::size_t i = out.index(0, y); i < out.index(0, y + 1); ++i) {
      glm::vec3 hidden =
          ambient[i] * (glm::vec3(1) - arriving_share(light.part[i], light.whole[i]));
      if (!specular.empty()) hidden += specular[i] * (1 - reflection[i]);
      // No light is negative, unless the render has it so, even where its layers do not add up.
      out[i] = glm::max(within_range(beauty[i] - hidden), glm::min(beauty[i], glm::vec3(0)));
    }
  });
  return out;
}

Plane<glm::vec3> added(const Results& r, const Plane<float>& alpha) {
  Plane<glm::vec3> out = sent_light(r, alpha);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = within_range(rendered(r.gbuffer)[i] + out[i]);
  return out;
}

/// Coverage where there is geometry, and the alpha of the render elsewhere.
Plane<float> rendered_alpha(const Results& r, Plane<float> alpha) {
  for (std::size_t i = 0; i < alpha.size() && !r.gbuffer.alpha.empty(); ++i) {
    if (!r.scene.geometry.is_surface(i) && std::isfinite(r.gbuffer.alpha[i]))
      alpha[i] = r.gbuffer.alpha[i];
  }
  return alpha;
}

}  // namespace

Composite composite(const Results& r) {
  Plane<float> alpha = coverage(r.scene, r.gbuffer);
  const Compose compose = r.composition.compose;
  if (compose == Compose::relight) {
    Plane<glm::vec3> color = sent_light(r, alpha);
    return {std::move(color), at_output_size(std::move(alpha), r.gbuffer)};
  }
  return {compose == Compose::occlude ? occluded(r) : added(r, alpha),
          at_output_size(rendered_alpha(r, alpha), r.gbuffer)};
}

NamedChannels product_channels(const std::string& name, const Results& results) {
  const Product& wanted = find_product(name);
  NamedChannels out;
  const auto append = [&](const std::string& prefix, const auto& plane) {
    for (int c = 0; c < ChannelView(plane, 0).step; ++c)
      out.channels.push_back({prefix + wanted.channels[out.channels.size()], {plane, c}});
  };
  for_each_plane(
      [&](const Product& product, const auto& found) {
        if (&product != &wanted) return;
        const bool turns = product.kind == ProductKind::direction;
        if (!turns && results.gbuffer.downsampling.is_identity()) return append(name + ".", found);
        auto plane = product_at_output_size(product, found, results);
        if constexpr (std::is_same_v<decltype(plane), Plane<glm::vec3>>) {
          if (turns)
            plane = in_input_space(std::move(plane), results.scene.geometry.normals_to_camera);
        }
        append(name + ".", plane);
        out.made = std::move(plane);
      },
      results.products);
  if (wanted.in) return out;
  Composite composed = composite(results);
  append("", composed.color);
  append("", composed.alpha);
  out.made = std::move(composed);
  return out;
}

}  // namespace ssdo
