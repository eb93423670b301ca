// SPDX-License-Identifier: Apache-2.0
//
// The composites. Rendered layers are premultiplied, and so is the result, so that edges whose
// alpha is between 0 and 1 need no division.
//
//   relight   F[alpha (albedo (direct + bounce) + specular)]
//   occlude   beauty - ambient (1 - S) - sum light_k (1 - S_k) - specular (1 - reflection)
//   add       beauty + F[alpha (albedo (direct + bounce) + specular)]
//
// In occlude, `specular` is a layer of the render. In relight and add it is the product, if the
// user names it.
//
// F is the mean of the pixels of the G-buffer that a pixel of the output shows: one of them, or
// those under the pixel filter with --downsample. The rendered layers have the output's size.
//
// S is the share of the environment's light that arrives. For light that is the same from
// everywhere it is ao. For other light, each channel has its own share, direct over the direct
// light without occluders: an object that hides red light and not green throws a green shadow,
// which ao would make brown (Ritschel, Grosch, Seidel, "Approximating Dynamic Global Illumination
// in Image Space", 2009). Under the filter it is F[alpha albedo direct] / F[alpha albedo
// unoccluded], as an ambient layer that the renderer has filtered is F[alpha albedo unoccluded].
// S_k is the same share for a lamp, and light_k the layer of its light without shadows (--aov
// light:NAME). The light of other lamps stays as rendered.
//
// occlude and add keep the beauty and its alpha where there is no geometry.
//
// Pixels that are kept (--only, --no-receive), by the share k, have S = 1 in occlude, and
//
//   relight   F[(1 - k) alpha (albedo (direct + bounce) + specular)] + F[k] beauty
//   add       beauty + F[(1 - k) alpha (albedo (direct + bounce) + specular)]
//
// Without a beauty, relight shows kept pixels unoccluded. Where objects are held out by the share
// h, the composite is multiplied by 1 - F[h].
#include "color/compose.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <type_traits>

#include "color/downsample.h"
#include "color/kept_pixels.h"
#include "color/light_colors.h"
#include "math/light_range.h"
#include "parallel/tiles.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

/// Directions from camera space into the space of the input's normals.
Plane<glm::vec3> in_input_space(Plane<glm::vec3> directions, const glm::mat3& normals_to_camera) {
  // The matrix is orthogonal, so that its transpose is its inverse.
  for (glm::vec3& d : directions.pixels) {
    const glm::vec3 seen = d;
    for (int c = 0; c < 3; ++c) d[c] = glm::dot(normals_to_camera[c], seen);
  }
  return directions;
}

/// Adds the channels of a plane, each with its letter.
template <class T>
void append(NamedChannels& out, const Product& product, const std::string& prefix,
            const Plane<T>& plane) {
  for (int c = 0; c < ChannelView(plane, 0).step; ++c)
    out.channels.push_back({prefix + product.channels[out.channels.size()], {plane, c}});
}

template <class T>
void append_made(NamedChannels& out, const Product& product, const std::string& prefix,
                 Plane<T> plane) {
  append(out, product, prefix, plane);
  out.made = std::move(plane);
}

/// Adds a plane of the products as outputs show it.
template <class T>
void append_found(NamedChannels& out, const Product& product, const std::string& prefix,
                  const Plane<T>& found, const Results& results) {
  const bool turns = product.kind == ProductKind::direction;
  if (!turns && results.gbuffer.downsampling.is_identity())
    return append(out, product, prefix, found);
  Plane<T> plane = product_at_output_size(product, found, results);
  if constexpr (std::is_same_v<T, glm::vec3>) {
    if (turns) plane = in_input_space(std::move(plane), results.scene.geometry.normals_to_camera);
  }
  append_made(out, product, prefix, std::move(plane));
}

/// albedo (direct + bounce) + specular.
glm::vec3 light_of(const Results& r, const Products& products, std::size_t i) {
  glm::vec3 light = products.direct[i];
  if (!products.bounce.empty()) light += products.bounce[i];
  light = r.scene.senders.albedo[i] * light;
  if (r.composition.adds_specular) light += products.specular[i];
  return within_range(light);
}

/// The light that surfaces send, by the products, premultiplied by alpha.
Plane<glm::vec3> sent_light(const Results& r, const Products& products, const Plane<float>& alpha) {
  auto sent = Plane<glm::vec3>::like(alpha);
  for_each_row(sent.height, [&](int y) {
    for (std::size_t i = sent.index(0, y); i < sent.index(0, y + 1); ++i)
      sent[i] = alpha[i] * light_of(r, products, i);
  });
  return at_output_size(std::move(sent), r.gbuffer);
}

/// A light at the surfaces of a pixel: the visible part, and all of it.
struct Arriving {
  Plane<glm::vec3> part, whole;
};

/// `by` null: light that is the same from everywhere; its visible share is ao.
Arriving arriving_light(const Results& r, const LitBy* by) {
  Arriving light;
  light.whole = weights_by_albedo(r);
  light.part = light.whole;
  for_each_row(light.part.height, [&](int y) {
    for (std::size_t i = light.part.index(0, y); i < light.part.index(0, y + 1); ++i) {
      if (light.whole[i] == glm::vec3(0)) continue;  // without a surface there is no normal
      if (!by) {
        light.part[i] *= r.shown().ao[i];
      } else {
        light.part[i] *= by->direct[i];
        const Surfel& s = r.scene.geometry.surfaces[i];
        light.whole[i] *= by->light.unoccluded_in(i, s.position, s.normal);
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

/// The part of rendered layers that occlusion takes away.
class Hidden {
 public:
  explicit Hidden(const Results& r) : r_(r), sum_(Plane<glm::vec3>::like(rendered(r.gbuffer))) {
    std::fill(sum_.pixels.begin(), sum_.pixels.end(), glm::vec3(0));
  }

  /// `layer` is the rendered layer of a light; `by` as for arriving_light().
  void add(const Plane<glm::vec3>& layer, const LitBy* by) {
    const Arriving light = arriving_light(r_, by);
    for_each_row(sum_.height, [&](int y) {
      for (std::size_t i = sum_.index(0, y); i < sum_.index(0, y + 1); ++i)
        sum_[i] += layer[i] * (glm::vec3(1) - arriving_share(light.part[i], light.whole[i]));
    });
  }

  Plane<glm::vec3> take() { return std::move(sum_); }

 private:
  const Results& r_;
  Plane<glm::vec3> sum_;
};

/// What occlusion takes of the layers that lights gave. Ambient light is the environment's alone.
Plane<glm::vec3> hidden_light(const Results& r) {
  Hidden hidden(r);
  const Plane<glm::vec3>& ambient = r.gbuffer.ambient;
  const LitBy all{r.scene.light, r.shown().direct};
  const bool by_ao = r.composition.share_is_ao, has_ambient = !ambient.empty();
  if (has_ambient && by_ao) hidden.add(ambient, nullptr);
  if (has_ambient && !by_ao && !has_lamps(r.scene.light)) hidden.add(ambient, &all);
  if (!has_lamps(r.scene.light)) return hidden.take();
  const std::vector<LightGroup> lights = light_groups_of(r.scene.light);
  const std::vector<LightProducts>& found = r.shown().lights;
  for (std::size_t k = 0; k < lights.size() && k < found.size(); ++k) {
    const LitBy by{lights[k].light, found[k].direct};
    const auto layer = r.gbuffer.lights.find(lights[k].name);
    if (has_ambient && !by_ao && lights[k].name == kEnvironmentName) hidden.add(ambient, &by);
    if (layer != r.gbuffer.lights.end()) hidden.add(layer->second, &by);
  }
  return hidden.take();
}

Plane<glm::vec3> occluded(const Results& r) {
  const Plane<glm::vec3>&beauty = rendered(r.gbuffer), &specular = r.gbuffer.specular;
  Plane<glm::vec3> hidden = hidden_light(r);
  Plane<float> reflection;
  if (!specular.empty())
    reflection = product_at_output_size(find_product("reflection"), r.shown().reflection, r);
  for_each_row(hidden.height, [&](int y) {
    for (std::size_t i = hidden.index(0, y); i < hidden.index(0, y + 1); ++i) {
      if (!specular.empty()) hidden[i] += specular[i] * (1 - reflection[i]);
      // Where layers do not add up, the result is not negative, unless the beauty is.
      hidden[i] = glm::max(within_range(beauty[i] - hidden[i]), glm::min(beauty[i], glm::vec3(0)));
    }
  });
  return hidden;
}

/// The part of alpha that is not kept.
Plane<float> changed(const Results& r, Plane<float> alpha) {
  for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] *= changed_share(r.gbuffer, i);
  return alpha;
}

Plane<glm::vec3> added(const Results& r, const Plane<float>& alpha) {
  Plane<glm::vec3> out = sent_light(r, r.products, changed(r, alpha));
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

/// The composite relight where pixels keep the beauty.
Composite relit_beside_beauty(const Results& r, const Plane<float>& alpha) {
  const Plane<float> kept = at_output_size(r.gbuffer.masks.kept, r.gbuffer);
  Plane<float> all = rendered_alpha(r, alpha);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = std::lerp(alpha[i], all[i], r.gbuffer.masks.kept[i]);
  Plane<glm::vec3> color = sent_light(r, r.products, changed(r, alpha));
  for (std::size_t i = 0; i < color.size(); ++i)
    color[i] = within_range(color[i] + kept[i] * r.gbuffer.beauty[i]);
  return {std::move(color), at_output_size(std::move(all), r.gbuffer)};
}

Composite composite_of_all(const Results& r) {
  Plane<float> alpha = coverage(r.scene, r.gbuffer);
  const Compose compose = r.composition.compose;
  if (compose == Compose::relight && r.composition.keeps_beauty)
    return relit_beside_beauty(r, alpha);
  if (compose == Compose::relight) {
    Plane<glm::vec3> color = sent_light(r, r.shown(), alpha);
    return {std::move(color), at_output_size(std::move(alpha), r.gbuffer)};
  }
  return {compose == Compose::occlude ? occluded(r) : added(r, alpha),
          at_output_size(rendered_alpha(r, alpha), r.gbuffer)};
}

}  // namespace

Composite composite(const Results& r) {
  Composite all = composite_of_all(r);
  if (r.gbuffer.masks.held_out.empty()) return all;
  const Plane<float> out = at_output_size(r.gbuffer.masks.held_out, r.gbuffer);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float left = 1 - std::clamp(out[i], 0.0f, 1.0f);
    all.color[i] *= left, all.alpha[i] *= left;
  }
  return all;
}

NamedChannels product_channels(const std::string& name, const Results& results) {
  const Product& product = find_product(name);
  NamedChannels out(product.background);
  if (const auto* scalar = std::get_if<Plane<float> Products::*>(&product.plane)) {
    append_found(out, product, name + ".", results.shown().*(*scalar), results);
  } else if (const auto* vector = std::get_if<Plane<glm::vec3> Products::*>(&product.plane)) {
    append_found(out, product, name + ".", results.shown().*(*vector), results);
  } else if (name == kComposite) {
    Composite composed = composite(results);
    append(out, product, "", composed.color);
    append(out, product, "", composed.alpha);
    out.made = std::move(composed);
  } else if (name == "shadow_of") {
    append_made(out, product, name + ".", shadow_of_objects(product, results));
  } else {
    const LitBy all{results.scene.light, results.shown().direct};
    append_made(out, product, name + ".", composed_of_light(product, all, results));
  }
  return out;
}

std::vector<NamedChannels> light_channels(const std::string& name, const Results& results) {
  const Product& product = find_product(name);
  std::vector<NamedChannels> out;
  if (!product.by_light || !results.composition.per_light) return out;
  const std::vector<LightGroup> lights = light_groups_of(results.scene.light);
  const std::vector<LightProducts>& found = results.shown().lights;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    NamedChannels& channels = out.emplace_back(product.background);
    const std::string prefix = name + "." + lights[k].name + ".";
    if (name == "direct") {
      append_found(channels, product, prefix, found[k].direct, results);
    } else if (name == "bounce") {
      append_found(channels, product, prefix, found[k].bounce, results);
    } else {
      const Plane<glm::vec3> none;
      const LitBy by{lights[k].light, found.empty() ? none : found[k].direct};
      append_made(channels, product, prefix, composed_of_light(product, by, results));
    }
  }
  return out;
}

}  // namespace ssdo
