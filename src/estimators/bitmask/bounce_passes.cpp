// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/bounce_passes.h"

#include <algorithm>
#include <utility>

#include "estimators/bitmask/border/border_light.h"
#include "estimators/bitmask/parts.h"

namespace ssdo {
namespace {

/// A light as it bounces, or all of them as one.
struct BounceState {
  LightGroup light;
  std::vector<OtherViewLight> sent_by_others;  ///< by pass
  BouncedLight found = {};                     ///< in the pass before
  glm::vec3 from_afar{1};  ///< share of what surfaces send in the first pass; see only_from_afar()
};

/// The light without the lamps that stand in the scene. Lamps light what is near them, and surfaces
/// that are not shown need not be near: a learned prior would turn a street with one spot into a
/// street that is lit everywhere.
LightGroup only_from_afar(const LightGroup& light) {
  LightGroup afar = light;
  afar.light.sources.clear(), afar.source_indices.clear();
  for (std::size_t k = 0; k < light.source_indices.size(); ++k) {
    const auto& source = light.light.sources[k];
    if (!source->distant() && !source->distant_lamp()) continue;
    afar.light.sources.push_back(source);
    afar.source_indices.push_back(light.source_indices[k]);
  }
  return afar;
}

/// What all lights of a pass share.
struct Pass {
  int number;                        ///< from 1 on
  Window lit;                        ///< the pixels that send
  Window to;                         ///< the pixels that gather
  const InterleavedVectors& of_all;  ///< what all lights together send
  const Emitters& emitters;          ///< chosen by `of_all`
  const OverviewLight* far_of_all;
  GatheredLight& gathered;
  const std::vector<LampBeyond>& lamps;  ///< that stand in the scene
  const SentAtBorder& other_at_border;   ///< what all other light sends there
};

/// A surface that replaces objects which cast nothing sends what its sender, a pixel beside it,
/// sends. Without a sender, and where no surface was shown, it sends nothing: it has no light of
/// its own.
void send_from_hole(const Raster& raster, const Surfaces& shown, const Plane<int>& senders,
                    InterleavedVectors& sent) {
  const Interleaving& layout = raster.layout();
  for_each_row(senders.height, [&](int y) {
    raster.for_each_pixel(y, [&](std::size_t pixel, std::ptrdiff_t i) {
      const int from = senders[pixel];
      if (from < 0 && shown[pixel].is_usable()) return;
      if (from < 0) {
        for (InterleavedPlane& channel : sent) channel[i] = 0;
        return;
      }
      const std::ptrdiff_t q = layout.index(from % senders.width, from / senders.width);
      for (InterleavedPlane& channel : sent) channel[i] = channel[q];
    });
  });
}

/// What pixels of a part of the raster send of light that is not given as a layer.
void send_light(const BounceInputs& inputs, const LightGroup& light, const Window& part,
                const BouncedLight* before, InterleavedVectors& sent) {
  const Scene& scene = inputs.scene;
  const SenderJob senders{inputs.march.scene,
                          visibility_of(light, inputs.ao, inputs.sky, inputs.sources),
                          scene.senders.albedo,
                          before ? &before->bounce : nullptr,
                          inputs.change,
                          before ? before->sent : glm::vec3(0),
                          &sent,
                          sends_two_sided(scene)};
  for_each_band_of(part, [&](const Window& band) { find_senders(senders, band); }, {});
}

/// At least so many rows of the display window, or all that it has, tell which share of the sent
/// light comes from afar.
constexpr int kRows = 128;

/// What pixels of a part send in the first pass, in one row of the display window in so many.
InterleavedVectors sent_by_rows(const BounceInputs& inputs, const LightGroup& light,
                                const Window& part, int rows_apart) {
  InterleavedVectors sent = inputs.raster.make_color();
  for_each_row(part.height(), [&](int row) {
    const int y = part.y0 + row;
    if ((y + inputs.march.scene.first_y) % rows_apart == 0)
      send_light(inputs, light, {part.x0, y, part.x1, y + 1}, nullptr, sent);
  });
  return sent;
}

class BouncePasses {
 public:
  explicit BouncePasses(const BounceInputs& inputs)
      : in_(inputs),
        scene_(inputs.scene),
        request_(inputs.request),
        march_scene_(inputs.march.scene),
        overview_(request_.around_band ? request_.around_band->far.get() : nullptr),
        times_sent_(times_sent(scene_, request_)),
        is_lit_(scene_.senders.radiance.empty()),
        two_sided_(sends_two_sided(scene_)),
        all_(start_state(as_one_group(scene_.light))) {
    if (!request_.by_light.bounce) return;
    for (LightGroup& light : light_groups_of(scene_.light))
      each_.push_back(start_state(std::move(light)));
  }

  BouncedLights run() {
    BouncedLights out;
    if (request_.products.error && request_.bounces > 0)
      out.error = InterleavedPlane(march_scene_.layout);
    for (int pass = 1; pass <= request_.bounces; ++pass) run(pass, out);
    out.all = std::move(all_.found);
    for (BounceState& light : each_) out.each.push_back(std::move(light.found));
    return out;
  }

 private:
  BounceState start_state(LightGroup light) const {
    BounceState state{std::move(light), {}};
    if (request_.bounces == 0)
      state.found.bounce = in_.raster.black();
    else if (in_.march.other_views)
      state.sent_by_others =
          light_other_surfaces(scene_, state.light, request_.bounces - 1, request_.radius);
    return state;
  }

  void run(int number, BouncedLights& out) {
    // The lit pixels reach as far around the receivers as light is still sent on.
    const Window lit =
        with_senders(march_scene_, request_, march_scene_.receivers, times_sent_ - number + 1);
    // Light that is not sent on is needed by receivers only.
    const Window to =
        is_lit_ && number < times_sent_
            ? with_senders(march_scene_, request_, march_scene_.receivers, times_sent_ - number)
            : march_scene_.receivers;
    InterleavedVectors sent = sent_light(lit, all_, number);
    const OverviewLight* overview_light =
        overview_ ? &overview_->light[std::size_t(number - 1)] : nullptr;
    const Emitters emitters = find_emitters(
        {march_scene_, sent, two_sided_, lit, in_.march.far, overview_light}, request_.seed);
    const bool wants_error = request_.products.error && number == request_.bounces;
    GatheredLight gathered(in_.march, wants_error);
    const std::vector<LampBeyond> lamps = lamps_beyond(all_.light, lit);
    const SentAtBorder other = without_lamps(sent_at_border(march_scene_, sent, two_sided_), lamps);
    const Pass pass{number, lit, to, sent, emitters, overview_light, gathered, lamps, other};
    std::vector<OverviewLight> kept;
    for (std::size_t k = 0; k < each_.size(); ++k) {
      InterleavedVectors of_light = sent_light(lit, each_[k], number);
      const OverviewLight* far_of_light = overview_light ? &overview_light->lights[k] : nullptr;
      const Emitters points = emitters_of_light(emitters, of_light, two_sided_, far_of_light);
      OverviewLight far = gather(each_[k], of_light, pass, far_of_light, points, nullptr);
      if (in_.keep_in) kept.push_back(std::move(far));
      each_[k].found.bounce = std::move(of_light);
    }
    OverviewLight far =
        gather(all_, sent, pass, overview_light, emitters, wants_error ? &out.error : nullptr);
    if (in_.keep_in) {
      far.lights = std::move(kept);
      out.kept.push_back(std::move(far));
    }
    all_.found.bounce = std::move(sent);
  }

  /// Given the bounce of the pass before.
  InterleavedVectors sent_light(const Window& part, const BounceState& light, int pass) const {
    return ssdo::sent_light(in_, light.light, part, pass > 1 ? &light.found : nullptr);
  }

  /// The mean radiance that surfaces send, of the light that comes from afar.
  glm::vec3 sent_by_unshown(BounceState& light, const InterleavedVectors& sent,
                            const Pass& pass) const {
    const auto mean = [&](const InterleavedVectors& of, int rows_apart) {
      return mean_sent(march_scene_, scene_.geometry,
                       {of, pass.of_all, two_sided_, pass.emitters.bright, rows_apart});
    };
    if (pass.number == 1 && is_lit_) {
      const LightGroup afar = only_from_afar(light.light);
      if (afar.source_indices.size() < light.light.source_indices.size()) {
        // Holes send what pixels of other rows send.
        const bool has_holes = bool(scene_.caster_surfaces);
        const int apart = has_holes ? 1 : std::max(scene_.geometry.display.height() / kRows, 1);
        const glm::vec3 all = mean(sent, apart),
                        part = mean(has_holes ? ssdo::sent_light(in_, afar, pass.lit, nullptr)
                                              : sent_by_rows(in_, afar, pass.lit, apart),
                                    apart);
        for (int c = 0; c < 3; ++c) light.from_afar[c] = all[c] > 0 ? part[c] / all[c] : 0;
      }
    }
    return light.from_afar * mean(sent, 1);
  }

  /// The lamps of `light` that stand in the scene; `lit`: the pixels that send.
  std::vector<LampBeyond> lamps_beyond(const LightGroup& light, const Window& lit) const {
    std::vector<LampBeyond> lamps;
    const bool extends_lit = is_lit_ && in_.march.extend && !scene_.caster_surfaces;
    if (!extends_lit || !light.light.has_local_lamps()) return lamps;
    const int width = march_scene_.layout.width(), height = march_scene_.layout.height();
    InterleavedVectors sent = in_.raster.make_color();  // set at the border alone
    for (std::size_t k = 0; k < light.source_indices.size(); ++k) {
      const auto& lamp = light.light.sources[k];
      if (!lamp->local_lamp()) continue;
      LightGroup one{lamp->name, {}, {light.source_indices[k]}};
      one.light.sources.push_back(lamp);
      for (const Window& border : {Window{0, 0, width, 1}, Window{0, height - 1, width, height},
                                   Window{0, 0, 1, height}, Window{width - 1, 0, width, height}})
        send_light(in_, one, intersection(border, lit), nullptr, sent);
      lamps.push_back({lamp.get(), sent_at_border(march_scene_, sent, two_sided_)});
    }
    return lamps;
  }

  /// Replaces the sent light by the light that arrives. Returns what bands need of the sent light,
  /// if `keep_in` is set. `points`: targets of rays, with this light. `error` may be null.
  OverviewLight gather(BounceState& light, InterleavedVectors& sent, const Pass& pass,
                       const OverviewLight* overview_light, const Emitters& points,
                       InterleavedPlane* error) {
    if (request_.ask_prior)
      light.found.sent = overview_light ? overview_light->mean : sent_by_unshown(light, sent, pass);
    std::vector<LampBeyond> lamps;
    for (const LampBeyond& of : pass.lamps) {
      const auto is_it = [&](const auto& source) { return source.get() == of.lamp; };
      if (std::ranges::any_of(light.light.light.sources, is_it)) lamps.push_back(of);
    }
    const SentAtBorder border =
        light_beyond(without_lamps(sent_at_border(march_scene_, sent, two_sided_), lamps),
                     pass.other_at_border, pass.emitters.bright);
    OverviewLight kept{{}, {}, pass.emitters.bright, pass.emitters.level, light.found.sent};
    if (in_.keep_in) {
      kept.sent = in_.raster.in_whole_rows(sent, *in_.keep_in);
      kept.border = border, kept.lamps = lamps;
    }
    const Emitters* const bright = pass.emitters.points.empty() ? nullptr : &pass.emitters;
    const OtherViewLight* const from_others =
        in_.march.other_views ? &light.sent_by_others[std::size_t(pass.number - 1)] : nullptr;
    const BounceJob job{in_.march,       &in_.ao,       &sent,          &pass.of_all,
                        two_sided_,      scene_.solids, border.data(),  lamps,
                        from_others,     pass.lit,      overview_,      overview_light,
                        pass.far_of_all, bright,        &pass.gathered, error};
    for_each_band_of(
        grown(march_scene_.layout, pass.to, in_.march.pattern.spacing() - 1),
        [&](const Window& part) { march_bounce(job, part); }, in_.progress);
    for_each_band_of(pass.to, [&](const Window& part) { spread_bounce(job, part); }, {});
    light.found.emitted = {};
    if (points.points.empty()) return kept;
    light.found.emitted = in_.raster.black();
    const std::vector<DepthBounds> bounds = depth_bounds(march_scene_);
    const EmittedJob rays{in_.march,
                          bounds,
                          points,
                          rays_to_source(request_.slices),
                          request_.seed,
                          &sent,
                          &light.found.emitted,
                          error};
    for_each_tall_part_of(march_scene_.layout, pass.to,
                          [&](const Window& w) { gather_emitted(rays, w); }, {});
    return kept;
  }

  const BounceInputs& in_;
  const Scene& scene_;
  const Request& request_;
  const MarchScene& march_scene_;
  const OverviewScene* overview_;
  const int times_sent_;
  const bool is_lit_;  ///< what is sent is found, not given
  const bool two_sided_;
  BounceState all_;
  std::vector<BounceState> each_;
};

}  // namespace

BouncedLights gather_bounces(const BounceInputs& inputs) { return BouncePasses(inputs).run(); }

void make_add_up(std::vector<LightProducts>& lights, Plane<glm::vec3> LightProducts::*plane,
                 const Plane<glm::vec3>& of_all) {
  if (lights.empty()) return;
  constexpr float kMost = 0.01f;  // more is no rounding
  for_each_row(of_all.height, [&](int y) {
    for (std::size_t i = of_all.index(0, y); i < of_all.index(0, y + 1); ++i) {
      glm::vec3 sum(0);
      for (const LightProducts& light : lights)
        if (!(light.*plane).empty()) sum += (light.*plane)[i];
      for (int c = 0; c < 3; ++c) {
        if (!(sum[c] > 0)) continue;
        const float times = std::clamp(of_all[i][c] / sum[c], 1 - kMost, 1 + kMost);
        for (LightProducts& light : lights)
          if (!(light.*plane).empty()) (light.*plane)[i][c] *= times;
      }
    }
  });
}

bool mirrors_surfaces(const Scene& scene, const Request& request) {
  const Senders& senders = scene.senders;
  return request.products.specular && !(senders.albedo.empty() && senders.radiance.empty());
}

int times_sent(const Scene& scene, const Request& request) {
  return (request.products.bounce ? request.bounces : 0) + int(mirrors_surfaces(scene, request));
}

bool sends_two_sided(const Scene& scene) {
  return scene.senders.radiance.empty() && !scene.light.is_constant();
}

InterleavedVectors sent_light(const BounceInputs& inputs, const LightGroup& light,
                              const Window& part, const BouncedLight* before) {
  const Scene& scene = inputs.scene;
  // The sent radiance may be given as a layer.
  if (!scene.senders.radiance.empty()) {
    InterleavedVectors given = inputs.raster.interleaved(scene.senders.radiance);
    if (scene.caster_surfaces)
      send_from_hole(inputs.raster, scene.geometry.surfaces, scene.caster_surfaces->sender, given);
    return given;
  }
  InterleavedVectors sent = inputs.raster.make_color();
  send_light(inputs, light, part, before, sent);
  if (scene.caster_surfaces)
    send_from_hole(inputs.raster, scene.geometry.surfaces, scene.caster_surfaces->sender, sent);
  return sent;
}

Window with_senders(const MarchScene& scene, const Request& request, const Window& part,
                    int bounces) {
  const Window raster = scene.raster();
  if (!request.around_band) return raster;
  const int rows = bounces * request.around_band->reach_rows;
  return intersection(raster, {raster.x0, part.y0 - rows, raster.x1, part.y1 + rows});
}

InterleavedVisibility visibility_of(const LightGroup& light, const InterleavedPlane& ao,
                                    const InterleavedColorRatios* sky,
                                    const std::vector<SourceVisibility>& sources) {
  InterleavedVisibility found{light.light, &ao, sky, {}};
  for (const std::size_t number : light.source_indices) found.sources.push_back(&sources[number]);
  return found;
}

}  // namespace ssdo
