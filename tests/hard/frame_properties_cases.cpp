// SPDX-License-Identifier: Apache-2.0
#include "hard/frame_properties.h"

#include <array>
#include <cmath>

#include "color/compose.h"
#include "relight/relight.h"
#include "support/estimate_light.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test {
namespace {

bool is_in_range(float v, ProductKind kind) {
  return kind == ProductKind::share ? v >= 0 && v <= 1 : std::isfinite(v);
}
bool is_in_range(const glm::vec3& v, ProductKind kind) {
  const float length = glm::length(v);
  return std::isfinite(length) &&
         (kind != ProductKind::direction || length == 0 || std::abs(length - 1) < 1e-4f);
}

}  // namespace

Measured bad_values(const Subject& s) {
  Worst worst;
  for_each_plane(
      [&](const Product& product, const auto& plane) {
        using Value = std::decay_t<decltype(plane[0])>;
        const Geometry& g = s.frame.scene.geometry;
        for (std::size_t i = 0; i < plane.size(); ++i) {
          const bool fine = g.is_surface(i) ? is_in_range(plane[i], product.kind)
                                            : plane[i] == Value(product.background);
          worst.see(!fine, [&] {
            return fmt::format("{} of pixel {} is {}", product.name, i,
                               *reinterpret_cast<const float*>(&plane[i]));
          });
        }
      },
      s.estimate.products);
  return worst;
}

/// As they are written, of the size of the output. Composites that keep the beauty keep its alpha.
Measured bad_outputs(const Subject& s) {
  Worst worst;
  const Plan& plan = s.frame.plan;
  const Results results{s.frame.scene, s.frame.gbuffer, s.estimate.products, plan.composition};
  const bool makes_alpha = plan.composition.compose == Compose::relight;
  for (const std::string& name : plan.make) {
    const NamedChannels made = product_channels(name, results);
    for (const NamedChannel& channel : made.channels) {
      // Shadow times unshadowed is direct, whatever a method finds: it is not held to 1.
      const bool is_share = (find_product(name).kind == ProductKind::share && name != "shadow") ||
                            (channel.name == "A" && makes_alpha);
      for (int i = 0; i < channel.pixels.width * channel.pixels.height; ++i) {
        const float v = channel.pixels[std::size_t(i)];
        worst.see(!is_in_range(v, is_share ? ProductKind::share : ProductKind::light),
                  [&] { return fmt::format("{} of pixel {} is {}", channel.name, i, v); });
      }
    }
  }
  return worst;
}

/// What the file of a frame holds once it is written, of one frame in ten.
Measured bad_files(const Subject& s) {
  if (!RandomNumbers(s.shot.seed + 7).chance(0.1)) return std::nullopt;
  const TempDir dir;
  const StoredFrame stored = store(s.shot, dir.path());
  OtherPictures pictures;
  Frame frame =
      prepare_frame(stored.options, Lighting(stored.options.light), pictures, stored.files);
  const std::vector<Target> targets = {{(dir / "out.exr").string(), {}}};
  const RelightJob job{stored.options, frame, targets, {}};
  const auto silent = [](double) {};
  Relit made = relight(job, std::move(frame.scene), silent, {});
  write_outputs({{job, &made}}, silent);
  Worst worst;
  for (const std::string& name : channel_names(dir / "out.exr")) {
    const Plane<float> plane = channel(dir / "out.exr", name);
    for (std::size_t i = 0; i < plane.size(); ++i)
      worst.see(!std::isfinite(plane[i]),
                [&] { return fmt::format("{} of pixel {} is {}", name, i, plane[i]); });
  }
  return worst;
}

void Worst::see(double a_value, const std::function<std::string()>& place) {
  if (std::isnan(value) || a_value <= value) return;
  value = a_value;
  where = place();
}

Products relit(const Scene& scene, Plan plan) {
  plan.error.reset();
  return estimate_light(scene, plan).products;
}

std::span<const FrameProperty> frame_properties() {
  static constexpr std::array all = {
      FrameProperty{"values out of their range", 0, 0, bad_values},
      FrameProperty{"written values out of their range", 0, 0, bad_outputs},
      FrameProperty{"values in files that are not finite", 0, 0, bad_files},
      FrameProperty{"light gained in a white furnace", 1e-5, 1e-5, light_gained, false},
      FrameProperty{"light lost by another bounce", 1e-5, 1e-5, lost_by_a_bounce},
      FrameProperty{"light lost by another bounce, of rays", 0.4, 5e-3, lost_by_a_bounce_of_rays},
      FrameProperty{"light lost by more light of one colour", 1e-5, 1e-5,
                    lost_by_more_light_of_one_color, false},
      FrameProperty{"light lost by more light in a map", 0.1, 1e-3, lost_by_more_light_in_a_map,
                    false},
      FrameProperty{"light lost by more light in a map, of ratios", 0.3, 5e-3,
                    lost_by_more_light_of_a_ratio},
      FrameProperty{"change by twice the light", 0, 0, change_by_twice_the_light},
      FrameProperty{"change in units of a power of two", 0, 0, change_in_units_of_a_power_of_two,
                    false},
      FrameProperty{"change of ao in other units", 0.1, 1e-3, change_in_other_units},
      FrameProperty{"change of ao in a turned world", 0.1, 1e-3, change_in_a_turned_world, false},
      FrameProperty{"change of ao in a moved world", 0.1, 1e-3, change_in_a_moved_world},
      FrameProperty{"change of bits by a crop", 0, 0, change_by_a_crop},
  };
  return all;
}

}  // namespace ssdo::test
