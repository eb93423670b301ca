// SPDX-License-Identifier: Apache-2.0
//
// Slices with a visibility bitmask: the horizon slices of GTAO (Jimenez, Wu, Pesce, Jarabo 2016,
// Practical Real-Time Strategies for Accurate Indirect Occlusion) with the bitmask of Therrien,
// Levesque and Gilet (2023, Screen Space Indirect Lighting with Visibility Bitmask).
//
// A slice is a plane through the view ray; its two sides are marched over the frame. On the side
// along T, a unit vector perpendicular to V, a direction at angle t from V has the cosine
// n_v cos t + n_t sin t to the normal and, as slices turn about V, the measure |sin t| dt:
//
//   M(S) = int_S (n_v cos t + n_t sin t) d cos t
//
// 32 sectors divide a side into equal steps of cos t, and so of solid angle. The solid of a pixel
// hides the sectors between its front and its back, which lies behind the front on the pixel's view
// ray; a mask collects the hidden sectors near to far. M(hidden) then gives ao and direct light, by
// the equations at the head of bitmask/visibility.cpp, where visibility() sums M and Moments::ao()
// divides (bitmask/moments-inl.h); bounce light is in bitmask/bounce.cpp.
//
// A march covers one side of a slice in a few steps and finds sectors (bitmask/side-inl.h). A walk
// follows single rays over the frame (bitmask/rays/): to sources, bright senders and mirrored
// things.
//
// What differs from the sources, and why:
// - w = 1 / |T~|^2, T~ the part of the slice's picture direction that is perpendicular to V. Slices
//   that are uniform in the picture are not uniform around V off the optical axis: without w a true
//   0.5 reads from 0.41 to 0.60 at 45 degrees.
// - Sums are divided by their values for an open surface, so that an open surface has exactly 1.
// - Sectors of equal angle with equal weights gave the ao of a pit, seen from the side, as 0.38
//   instead of 0.75. Here the weight of a sector is the integral of the cosine over it. Equal steps
//   of cos t are cheap to find (no arc function) and the same for all pixels, so that moments of
//   masks come from tables (bitmask/slice_sectors.cpp). The point that stands for a sector differs
//   from slice to slice, or a gentle curve would show the sectors as bands.
// - direct is a ratio to the exact unoccluded irradiance E(N), the ratio estimator of Heitz, Hill
//   and McGuire (2018, Combining Analytic Direct Illumination and Stochastic Shadows): the noise of
//   a few directions cancels. L is the environment without its sources, in spherical harmonics.
//   Rays go to points of each source (bitmask/rays/source.cpp), and along the directions that
//   facets mirror (bitmask/rays/reflection.cpp).
// - bounce takes the radiance of the first surface in each sector; no 1/d^2, so no singularity
//   (bitmask/bounce.cpp, bitmask/senders.cpp). Rays go to bright senders (bitmask/rays/emitters.h).
// - A sampled pixel represents the stretch of the march up to halfway to the samples before and
//   after it (bitmask/piece-inl.h). Treated as points, few samples miss too much: 16 steps that
//   represent their stretches are nearer to the limit than 24 points.
// - The backs of solids, layers of solids behind what is seen (scene/solids/solids.cpp) and
//   surfaces beyond the frame (bitmask/border/extension-inl.h) are guessed; GTAO has none of these.
//   How much light passes surfaces beyond the frame: bitmask/border/beyond.h,
//   bitmask/border/border_extents.h.
// - Surfaces that only other views show may be anywhere, even behind the camera: rays test them for
//   the sectors that the march leaves open (bitmask/other_views-inl.h).
#include "estimators/bitmask.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "estimators/bitmask/basis_weights.h"
#include "estimators/bitmask/border/beyond.h"
#include "estimators/bitmask/bounce_passes.h"
#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/parts.h"
#include "estimators/bitmask/patterns.h"
#include "estimators/bitmask/raster.h"
#include "estimators/bitmask/rays/find_reflection.h"
#include "estimators/bitmask/rays/find_source.h"
#include "estimators/bitmask/rays/linked_occluders.h"
#include "estimators/guessed.h"

namespace ssdo {
namespace {

/// The method on one frame.
class Bitmask {
 public:
  Bitmask(const Scene& scene, const Request& request, const Progress& progress)
      : scene_(scene),
        request_(request),
        progress_(progress),
        march_scene_(make_march_scene(scene.casters(), scene.solids, request.receivers,
                                      scene.caster_surfaces ? &scene.geometry : nullptr,
                                      request.radius)),
        layout_(march_scene_.layout),
        raster_(march_scene_),
        far_(request.around_band && request.around_band->continues_in_overview
                 ? request.around_band->far.get()
                 : nullptr),
        pattern_(pattern_of(request, layout_, scene.geometry.display, overview_raster())),
        bounce_pattern_(bounce_pattern_of(request, scene.light.has_local_lamps(), layout_,
                                          scene.geometry.display, overview_raster())),
        other_views_(OtherViewRays::of_added(scene.other_surfaces)),
        march_(march_with(pattern_)),
        bounce_march_(march_with(bounce_pattern_)) {}

  Products run() {
    gather_light_from_outside();
    BouncedLights bounced;
    if (request_.products.bounce) bounced = gather_bounces(bounce_inputs());
    if (request_.products.reflection || request_.products.specular) gather_reflection(bounced.all);
    end_marches();
    hand_out(std::move(bounced));
    if (request_.products.guessed)
      out_.guessed =
          guessed_shares(scene_, march_scene_.receivers, request_.radius, request_.seed, progress_);
    return std::move(out_);
  }

  /// The data of this scene, an overview of a frame, that bands of the frame need.
  OverviewScene overview(float from_px) {
    const MarchScene& s = march_scene_;
    OverviewRaster raster(layout_.width(), layout_.height(), s.first_x, s.first_y, from_px);
    kept_light_in_ = &raster;
    std::vector<OverviewLight> kept;
    if (request_.products.bounce && request_.bounces > 0) {
      gather_light_from_outside();
      kept = gather_bounces(bounce_inputs()).kept;
    }
    kept_light_in_ = nullptr;
    MarchPlanes planes = raster_.in_whole_rows(s, raster);
    std::vector<DepthBounds> bounds = depth_bounds(s);
    CutSurfaces cut = find_cut_surfaces(s, up_in_camera(scene_), request_.radius);
    const Enclosure open = enclosure_of(s, scene_, request_.radius);
    auto blockers = overview_blockers(scene_, request_, raster);
    return {std::move(march_scene_), raster, std::move(planes), std::move(bounds),  scene_.solids,
            std::move(cut),          open,   std::move(kept),   std::move(blockers)};
  }

 private:
  const OverviewRaster* overview_raster() const { return far_ ? &far_->raster : nullptr; }

  March march_with(const SlicePattern& pattern) const {
    return {march_scene_,
            pattern,
            request_.radius,
            request_.extend_offscreen,
            may_be_thin(scene_.solids),
            other_views_.get(),
            far_};
  }

  bool wants_light() const {
    const ProductSet& asked = request_.products;
    return asked.direct || asked.bounce || asked.specular || asked.error;
  }

  /// The pixels whose direct light is computed: the receivers and, where light is sent on, the
  /// pixels that may send light to them.
  Window lit_part() const {
    const int sent = scene_.senders.radiance.empty() ? times_sent(scene_, request_) : 0;
    const Window& receivers = march_scene_.receivers;
    return sent > 0 ? with_senders(march_scene_, request_, receivers, sent) : receivers;
  }

  /// Sources come first: the depth bounds of their rays need more memory than any other light. With
  /// a prior, visibility comes first: from it the prior finds how much of a sun passes the border.
  void gather_light_from_outside() {
    const bool has_sources = wants_light() && !scene_.light.sources.empty(),
               asks = bool(request_.ask_prior);
    if (has_sources && !asks) gather_sources();
    gather_visibility();
    if (has_sources && asks) gather_sources();
    past_ = {};  // sources alone read it
  }

  void gather_visibility() {
    ao_ = InterleavedPlane(layout_);
    const Light& light = scene_.light;
    VisibilityJob job{.march = march_, .unoccluded = &light, .ao = &ao_};
    InterleavedVectors bent;
    const bool asks = bool(request_.ask_prior);
    if (request_.products.bent || asks)
      bent = raster_.make_color(), job.bent = &bent, job.order = 1;
    InterleavedPlane open_ao;
    if (asks) open_ao = InterleavedPlane(layout_), job.open_ao = &open_ao;
    std::vector<float> weights;
    if (wants_light()) {
      out_.visibility.are_ao = light.is_constant();
      if (!out_.visibility.are_ao) {
        for (InterleavedRatios& channel : sky_share_) channel = InterleavedRatios(layout_);
        job.sky_share = &sky_share_;
      }
      if (light.order > 0 || request_.products.error) {
        job.order = std::max(light.order, 1);
        weights = basis_weights(light, job.order);
        job.light = weights.data();
        // Constant light is multiplied by ao, for which surfaces beyond the frame are opaque.
        if (light.order > 0) job.through_beyond = kLightThroughBeyond;
      }
    }
    if (request_.products.error) {
      error_ = InterleavedPlane(layout_);
      job.difference = &error_;
    }
    for_each_band_of(
        lit_part(), [&](const Window& part) { march_visibility(job, part); }, progress_);
    if (asks) ask_prior(open_ao, bent);
    if (request_.products.bent) out_.bent = raster_.picture(std::move(bent));
  }

  void ask_prior(const InterleavedPlane& open_ao, const InterleavedVectors& bent) {
    const std::size_t width = std::size_t(layout_.width());
    const auto found = [&](std::size_t pixel) {
      const std::ptrdiff_t i = layout_.index(int(pixel % width), int(pixel / width));
      return FoundVisibility{ao_[i], open_ao[i], {bent[0][i], bent[1][i], bent[2][i]}};
    };
    const bool sends = times_sent(scene_, request_) > 0 && scene_.senders.radiance.empty(),
               has_suns = needs_enclosure(scene_, request_);
    const LearnedVisibility learned = request_.ask_prior(
        {scene_, lit_part(), found, sends || has_suns,
         has_suns ? offscreen_sun_visibility(march_scene_, scene_, request_) : 1});
    if (sends) change_ = raster_.interleaved(learned.change);
    if (has_suns) past_ = raster_.interleaved(learned.offscreen_sun);
  }

  /// The march of rays. In a band that marches on in an overview, the overview has the surfaces
  /// that the border of the frame cuts.
  March march_of_rays() {
    March march = march_;
    if (march.extend) march.cut = &cut_;
    if (march.extend && !far_ && cut_.extents.empty())
      cut_ = find_cut_surfaces(march_scene_, up_in_camera(scene_), request_.radius, asked_planes());
    return march;
  }

  /// Selects the planes that rays to sources may meet; empty where mirrored directions have rays as
  /// well, which may meet all planes.
  MayMeetPlane asked_planes() const {
    if (request_.products.reflection || request_.products.specular) return {};
    return met_by_rays_to_sources(scene_.light);
  }

  /// Finds where sources are seen, and once more by other rays where the error is wanted.
  void gather_sources() {
    const std::vector<DepthBounds> bounds = depth_bounds(march_scene_);
    const March march = march_of_rays();
    const InterleavedPlane* const by_pixel = past_.data() ? &past_ : nullptr;
    const float past = by_pixel ? 0 : offscreen_sun_visibility(march_scene_, scene_, request_);
    const bool unseen = times_sent(scene_, request_) > 0 && sends_two_sided(scene_);
    const auto rays = rays_to_source(request_.slices);
    LinkedOccludersOfSources blockers(scene_, request_, pattern_);
    for (std::size_t k = 0; k < scene_.light.sources.size(); ++k) {
      const Source& source = *scene_.light.sources[k];
      const OffscreenVisibility pass = offscreen_visibility(past, source);
      const LinkedOccluders* const own = blockers.of(k);
      const auto job = [&](const std::vector<PointsOfSource>& points) -> SourceJob {
        if (own) return own->job(points, source);
        return {march, bounds, points, source, pass, by_pixel};
      };
      const auto find = [&](const Window& to, RaySet set) {
        const auto points = points_of(source, rays, request_.seed, set);
        return find_source(job(points), to, progress_);
      };
      sources_.push_back(find(lit_part(), RaySet::of_light));
      if (unseen && source.local_lamp()) {
        const auto points = points_of(source, rays, request_.seed, RaySet::of_light);
        find_unseen_light(job(points), march_scene_, lit_part(), sources_.back());
      }
      if (request_.products.error)
        sources_again_.push_back(find(march_scene_.receivers, RaySet::of_error));
    }
  }

  /// Frees what only marches read: products need no more than which pixels show a surface.
  void end_marches() {
    march_scene_.tilt = {};
    march_scene_.tilt_rest = {};
    march_scene_.layers.resize(1);
    march_scene_.layers.front().thickness = {};
  }

  const InterleavedColorRatios* found_sky() const {
    return out_.visibility.are_ao ? nullptr : &sky_share_;
  }

  /// Turns what was found into products, each in room that others have left. Sources go before the
  /// sky, whose planes are the largest: theirs lay between those of the bounce.
  void hand_out(BouncedLights bounced) {
    const auto place = [&](BouncedLight& light, Plane<glm::vec3>& bounce,
                           Plane<glm::vec3>& emitted) {
      bounce = raster_.picture(std::move(light.bounce));
      if (light.emitted[0].data()) emitted = raster_.picture(std::move(light.emitted));
    };
    if (request_.products.bounce) place(bounced.all, out_.bounce, out_.visibility.emitted);
    out_.lights.resize(bounced.each.size());
    out_.visibility.sent = bounced.all.sent;
    for (std::size_t k = 0; k < bounced.each.size(); ++k) {
      place(bounced.each[k], out_.lights[k].bounce, out_.lights[k].emitted);
      out_.lights[k].sent = bounced.each[k].sent;
    }
    make_add_up(out_.lights, &LightProducts::bounce, out_.bounce);
    make_add_up(out_.lights, &LightProducts::emitted, out_.visibility.emitted);
    if (wants_light() && !request_.visibility_suffices)
      out_.direct = raster_.picture(direct_light());
    if (request_.products.error) {
      const InterleavedPlane& more = bounced.error;
      const bool bounces = more.data() != nullptr;
      out_.error = raster_.of_receivers(
          0.0f, [&](std::ptrdiff_t i) { return bounces ? error_[i] + more[i] : error_[i]; });
    }
    hand_out_sources(sources_, raster_, out_.visibility.sources, out_.visibility.samples);
    hand_out_sources(sources_again_, raster_, out_.visibility.sources_again,
                     out_.visibility.samples_again);
    if (wants_light() && !out_.visibility.are_ao)
      out_.visibility.sky = raster_.picture(std::move(sky_share_), ao_);
    out_.ao = raster_.picture(std::move(ao_), 1.0f);
  }

  InterleavedVectors direct_light() const {
    InterleavedVectors direct = raster_.make_color();
    const LightGroup light = as_one_group(scene_.light);
    const DirectJob job{march_scene_, visibility_of(light, ao_, found_sky(), sources_), &direct};
    for_each_band_of(march_scene_.receivers, [&](const Window& part) { find_direct(job, part); },
                     {});
    return direct;
  }

  void gather_reflection(const BouncedLight& bounce) {
    InterleavedVectors sent;
    if (mirrors_surfaces(scene_, request_))
      sent = sent_light(bounce_inputs(), as_one_group(scene_.light), lit_part(),
                        bounce.bounce[0].data() ? &bounce : nullptr);
    find_reflection(
        {march_of_rays(), raster_, scene_, request_, sent, lit_part(), sends_two_sided(scene_)},
        out_, progress_);
  }

  BounceInputs bounce_inputs() const {
    return {scene_,        request_,      progress_,
            raster_,       bounce_march_, ao_,
            found_sky(),   sources_,      change_.data() ? &change_ : nullptr,
            kept_light_in_};
  }

  const Scene& scene_;
  const Request& request_;
  const Progress& progress_;
  MarchScene march_scene_;
  const Interleaving& layout_;
  const Raster raster_;
  const OverviewScene* far_;  ///< where marches of a band go on; null: nowhere
  SlicePattern pattern_, bounce_pattern_;
  std::unique_ptr<OtherViewRays> other_views_;  ///< null: there are no other views
  March march_, bounce_march_;
  CutSurfaces cut_;
  InterleavedPlane ao_, error_;
  InterleavedPlane change_, past_;    ///< as LearnedVisibility has them; empty: of no prior
  InterleavedColorRatios sky_share_;  ///< empty where that is ao
  std::vector<SourceVisibility> sources_, sources_again_;  ///< by source
  const OverviewRaster* kept_light_in_ = nullptr;  ///< order in which bands read what is sent
  Products out_;
};

Products estimate(const Scene& scene, const Request& request, const Progress& progress) {
  return Bitmask(scene, request, progress).run();
}

std::shared_ptr<const OverviewScene> overview(const Scene& scene, const Request& request,
                                              float from_px, const Progress& progress) {
  return std::make_shared<OverviewScene>(Bitmask(scene, request, progress).overview(from_px));
}

}  // namespace

Method bitmask_method() {
  return {
      .name = "bitmask",
      .summary = "slices with a visibility bitmask; light and bounce from the same march",
      .products = {.ao = true,
                   .direct = true,
                   .bounce = true,
                   .specular = true,
                   .bent = true,
                   .reflection = true,
                   .error = true,
                   .guessed = true},
      .supports = {.radius = true,
                   .infinite_radius = true,
                   .thickness = true,
                   .march = true,
                   .receivers = true,
                   .prior = true},
      .pattern_size = Interleaving::kPeriod,
      .published_filter = {"geometry"},
      .parameters = {kRoughness, kIndexOfRefraction},
      .samples_per_pixel = [](const Request& r) { return 2 * r.slices * r.steps; },
      .estimate = estimate,
      .bands = {overview, reach_rows, band_needs_enclosure, add_enclosure},
      .ladder = {.rungs = {slices_and_steps(1, 6), slices_and_steps(2, 8), slices_and_steps(2, 16),
                           slices_and_steps(2, 24), slices_and_steps(4, 32),
                           slices_and_steps(6, 48), slices_and_steps(12, 64)},
                 .limit = slices_and_steps(32, 96),
                 .seeds = 2}};
}

}  // namespace ssdo
