// SPDX-License-Identifier: Apache-2.0
//
// The one table of products. Definitions: man ssdo, PRODUCTS.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "math/plane.h"

namespace ssdo {

struct MirrorModel;

/// The products that a method may be asked for.
struct ProductSet {
  bool ao = false;
  bool direct = false;
  bool bounce = false;
  bool specular = false;
  bool bent = false;
  bool reflection = false;
  bool error = false;
  bool guessed = false;

  bool operator==(const ProductSet&) const = default;
};

/// Data about a sun's share that few rays have found, beside the share itself.
struct ShadowSample {
  Plane<float> weight;    ///< in a mean: the mean cosine of the rays to the normal
  Plane<float> width_px;  ///< of the penumbra that the occluder throws here; 0: none
};

/// How much of the light arrives: what filters average in place of `direct`
/// (filters/light_visibility.h). About 0..1, but noise is not cut off, so that means are right.
struct LightVisibility {
  Plane<glm::vec3> sky;               ///< of what the sky gives, channel by channel
  std::vector<Plane<float>> sources;  ///< of what each sun gives, as if its light met any normal
  std::vector<ShadowSample>
      samples;  ///< of each sun; empty where the shares are means of many rays
  std::vector<Plane<float>> sources_again;  ///< `sources` by rays to other points, for the error
  std::vector<ShadowSample> samples_again;  ///< of sources_again; both empty: no error is wanted
  /// The part of `bounce` that small bright senders give, which ao does not bound: filters average
  /// it apart. Empty: there is none.
  Plane<glm::vec3> emitted;
  /// With a learned prior: the mean radiance that surfaces of the frame send, taken for that of
  /// occluders which the frame does not show.
  glm::vec3 sent{0};
  bool are_ao = false;  ///< light comes from everywhere alike, and ao is its share; no planes then
  /// The share that arrives of the sky's light that surfaces mirror, channel by channel; empty:
  /// `specular` is not made.
  Plane<glm::vec3> mirrored_sky;
  /// For a prior: the share of that light, 0..1, about whose directions the method could only
  /// guess, and how much of it the guess lets through. Both empty: not known.
  Plane<float> mirrored_guessed, mirrored_guessed_open;
  std::shared_ptr<const MirrorModel> mirror = {};  ///< what `specular` is computed with
};

/// What one light of a frame gives: the environment or a lamp (scene/light/light_group.h). The sums
/// over the lights are `direct` and `bounce` of all of them.
struct LightProducts {
  std::string name;
  Plane<glm::vec3> direct, bounce;  ///< empty where they were not asked for
  Plane<glm::vec3> emitted;         ///< the part of its bounce that LightVisibility::emitted has
  glm::vec3 sent{0};                ///< as LightVisibility has it
};

/// Planes over the receivers of the request: those that were asked for, and others that the method
/// found on its way; the rest are empty. Linear, without the receiver's albedo.
struct Products {
  Plane<float> ao;
  Plane<glm::vec3> direct, bounce;
  Plane<glm::vec3> bent;    ///< unit, camera space
  Plane<float> reflection;  ///< share of a reflection that is not occluded
  /// Light that surfaces mirror. Until add_specular() (estimators/specular/specular.h): the mean
  /// radiance of the mirrored surfaces, 0 where none is mirrored.
  Plane<glm::vec3> specular;
  Plane<float> error;  ///< of the luminance of direct + bounce, with the sign of one draw of noise
  Plane<float> guessed;        ///< G of estimators/guessed.h; the product once it is filtered
  LightVisibility visibility;  ///< what `direct` is made of, where the method knows
  /// The light with the objects of --shadow-of and without them, as relight/shadow_of.cpp has it.
  /// Empty: not asked for.
  Plane<glm::vec3> lit, lit_without;
  std::vector<LightProducts> lights;  ///< in the order of light_groups_of(); empty: not asked for
};

/// What the values of a product are. It decides how --temporal and pictures treat them.
enum class ProductKind {
  share,      ///< 0..1; grey in a picture
  light,      ///< a colour: goes through the display transform
  direction,  ///< a unit vector; written in the space of the input's normals
  deviation,  ///< of any sign; grey in a picture
};

/// What is done to the mean of a plane.
enum class Finish { none, clamp, normalise };

/// Planes whose means belong together: light of occluders is their radiance times 1 - visibility.
enum class Coupling { none, visibility, occluders };

/// What a plane needs of a filter beside the mean over its neighbours.
struct Filtering {
  Finish finish = Finish::none;  ///< to 0..1, or to unit length, zero staying zero
  bool shadowed = false;         ///< steps of it are edges of shadows, which filters keep; without
                          ///< occlusion each channel is about 1, `direct` where it is a share
  Coupling coupling = Coupling::none;
};

/// A row in the table of products.
struct Product {
  std::string_view name;
  ProductKind kind;
  std::string_view
      channels;  ///< a letter for each; in an EXR "NAME.LETTER", or the letter alone if composed
  bool ProductSet::*in = nullptr;  ///< its place in a set; null: composed (color/compose.h)
  std::variant<std::monostate, Plane<float> Products::*, Plane<glm::vec3> Products::*> plane = {};
  ProductSet made_of = {};  ///< what a method has to make for it
  ProductSet with = {};  ///< optional parts: used if the method makes them and their layers exist
  std::string_view needs = "";      ///< role of a layer that it requires
  std::string_view all_needs = "";  ///< role of a layer without which --products all leaves it out
  float background = 0;             ///< its value where there is no surface
  bool usual = false;               ///< made where --products is not given
  Filtering filtering = {};
  bool of_view = false;       ///< depends on where the camera stands, not on the surface alone
  bool measured = false;      ///< by bench
  bool by_light = false;      ///< --per-light: each light has a layer of it
  std::string_view aka = "";  ///< names that renderers give such a layer, in lower case
};

/// In the order of lists and files.
inline constexpr std::array<Product, 12> kProducts = {{
    {.name = "ao",
     .kind = ProductKind::share,
     .channels = "Y",
     .in = &ProductSet::ao,
     .plane = &Products::ao,
     .made_of = {.ao = true},
     .background = 1,
     .usual = true,
     .filtering = {.finish = Finish::clamp, .shadowed = true, .coupling = Coupling::visibility},
     .measured = true,
     .aka = "ambientocclusion occlusion"},
    {.name = "bent",
     .kind = ProductKind::direction,
     .channels = "XYZ",
     .in = &ProductSet::bent,
     .plane = &Products::bent,
     .made_of = {.bent = true},
     .filtering = {.finish = Finish::normalise}},
    // Without a layer of it, roughness is a parameter that only the user knows.
    {.name = "reflection",
     .kind = ProductKind::share,
     .channels = "Y",
     .in = &ProductSet::reflection,
     .plane = &Products::reflection,
     .made_of = {.reflection = true},
     .all_needs = "roughness",
     .background = 1,
     .filtering = {.finish = Finish::clamp, .shadowed = true},
     .of_view = true},
    {.name = "direct",
     .kind = ProductKind::light,
     .channels = "RGB",
     .in = &ProductSet::direct,
     .plane = &Products::direct,
     .made_of = {.direct = true},
     .usual = true,
     .filtering = {.shadowed = true},
     .measured = true,
     .by_light = true,
     .aka = "diffdir diffusedirect"},
    // Light without any occlusion: no method is needed.
    {.name = "unshadowed", .kind = ProductKind::light, .channels = "RGB", .by_light = true},
    // direct / unshadowed. Not clamped, so that their product is direct.
    {.name = "shadow",
     .kind = ProductKind::share,
     .channels = "RGB",
     .made_of = {.direct = true},
     .background = 1,
     .by_light = true},
    {.name = "bounce",
     .kind = ProductKind::light,
     .channels = "RGB",
     .in = &ProductSet::bounce,
     .plane = &Products::bounce,
     .made_of = {.bounce = true},
     .needs = "albedo",
     .usual = true,
     .filtering = {.coupling = Coupling::occluders},
     .measured = true,
     .by_light = true,
     .aka = "diffind diffuseindirect"},
    // The light with the objects of --shadow-of over the light without them; 1 where there is none.
    {.name = "shadow_of",
     .kind = ProductKind::share,
     .channels = "RGB",
     .made_of = {.direct = true},
     .with = {.bounce = true},
     .all_needs = "shadow-of",
     .background = 1},
    // The surfaces that are mirrored send direct and bounce light.
    {.name = "specular",
     .kind = ProductKind::light,
     .channels = "RGB",
     .in = &ProductSet::specular,
     .plane = &Products::specular,
     .made_of = {.direct = true, .specular = true},
     .with = {.bounce = true},
     .all_needs = "roughness",
     .of_view = true},
    {.name = "error",
     .kind = ProductKind::deviation,
     .channels = "Y",
     .in = &ProductSet::error,
     .plane = &Products::error,
     .made_of = {.direct = true, .error = true},
     .with = {.bounce = true}},
    {.name = "guessed",
     .kind = ProductKind::share,
     .channels = "Y",
     .in = &ProductSet::guessed,
     .plane = &Products::guessed,
     .made_of = {.guessed = true},
     .filtering = {.finish = Finish::clamp}},
    // The row as --compose relight makes it; the others change it (plan/composite_choice.cpp).
    {.name = "composite",
     .kind = ProductKind::light,
     .channels = "RGBA",
     .made_of = {.direct = true},
     .with = {.bounce = true},
     .needs = "albedo",
     .usual = true},
}};

/// The product that the options of COMPOSITES change.
inline constexpr std::string_view kComposite = "composite";

/// --products all: whatever frame and method allow.
inline constexpr std::string_view kAllProducts = "all";

/// Errors: ExitCode::usage with the names that exist.
const Product& find_product(std::string_view name);

/// "ao, bent, ...".
std::string product_names();

/// Whether `larger` has all of `smaller`.
bool contains(const ProductSet& larger, const ProductSet& smaller);
ProductSet operator|(const ProductSet& a, const ProductSet& b);
ProductSet operator&(const ProductSet& a, const ProductSet& b);

/// Whether a list of products has `name`.
bool contains(const std::vector<std::string>& names, std::string_view name);

/// Calls visit(product, plane of each of `all`) for every product that is estimated, then for what
/// each light gives of direct and bounce; the planes, some of which may be empty, are Plane<float>
/// or Plane<glm::vec3>. `all` have as many lights as the first.
template <class Visit, class First, class... Others>
void for_each_plane(const Visit& visit, First& first, Others&... others) {
  for (const Product& product : kProducts) {
    if (const auto* scalar = std::get_if<Plane<float> Products::*>(&product.plane))
      visit(product, first.**scalar, others.**scalar...);
    else if (const auto* vector = std::get_if<Plane<glm::vec3> Products::*>(&product.plane))
      visit(product, first.**vector, others.**vector...);
  }
  for (std::size_t k = 0; k < first.lights.size(); ++k) {
    visit(find_product("direct"), first.lights[k].direct, others.lights[k].direct...);
    visit(find_product("bounce"), first.lights[k].bounce, others.lights[k].bounce...);
  }
}

/// Calls visit(plane of each of `all`) for what light is made of: the sky's share, then each sun's,
/// then those by other points, then what is emitted, in all and by each light, then what is
/// mirrored of the sky, and guessed of that; some planes may be empty. `all` have as many as the
/// first.
template <class Visit, class First, class... Others>
void for_each_visibility(const Visit& visit, First& first, Others&... others) {
  visit(first.visibility.sky, others.visibility.sky...);
  for (std::size_t i = 0; i < first.visibility.sources.size(); ++i)
    visit(first.visibility.sources[i], others.visibility.sources[i]...);
  for (std::size_t i = 0; i < first.visibility.sources_again.size(); ++i)
    visit(first.visibility.sources_again[i], others.visibility.sources_again[i]...);
  visit(first.visibility.emitted, others.visibility.emitted...);
  for (std::size_t k = 0; k < first.lights.size(); ++k)
    visit(first.lights[k].emitted, others.lights[k].emitted...);
  visit(first.visibility.mirrored_sky, others.visibility.mirrored_sky...);
  visit(first.visibility.mirrored_guessed, others.visibility.mirrored_guessed...);
  visit(first.visibility.mirrored_guessed_open, others.visibility.mirrored_guessed_open...);
}

}  // namespace ssdo
