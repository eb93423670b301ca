// SPDX-License-Identifier: Apache-2.0
#include "ray_cast.h"

#include <cstring>
#include <limits>

namespace {
template <class T>
void share(RTCGeometry g, RTCBufferType type, RTCFormat format, const std::vector<T>& v, size_t n) {
  const size_t bytes = sizeof(T) * v.size() / n;
  std::memcpy(rtcSetNewGeometryBuffer(g, type, 0, format, bytes, n), v.data(), bytes * n);
}
RTCRay ray_of(Vec o, Vec d) {
  return {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, std::numeric_limits<float>::infinity(), ~0u, 0, 0};
}
}  // namespace

RayCaster::RayCaster(RTCDevice device, const Mesh& mesh)
    : mesh_(mesh), scene_(rtcNewScene(device)) {
  const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  share(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.points, mesh.points.size());
  share(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.corners, mesh.corners.size() / 3);
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene_, g);
  rtcReleaseGeometry(g);
  rtcCommitScene(scene_);
}

RayCaster::~RayCaster() { rtcReleaseScene(scene_); }

RayCaster::Hit RayCaster::first_hit(Vec origin, Vec direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit h;
  h.ray = ray_of(origin, direction);
  h.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &context, &h);
  if (h.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {h.ray.tfar, {}, {}, {}};
  const unsigned* q = &mesh_.corners[3 * h.hit.primID];
  const float u = h.hit.u, v = h.hit.v;
  Vec normal = unit({h.hit.Ng_x, h.hit.Ng_y, h.hit.Ng_z});
  Vec shading =
      unit(mesh_.normals[q[0]] * (1 - u - v) + mesh_.normals[q[1]] * u + mesh_.normals[q[2]] * v);
  if (dot(normal, direction) > 0) normal = normal * -1;
  if (dot(normal, shading) < 0) shading = shading * -1;
  return {h.ray.tfar, normal, shading, mesh_.albedo[h.hit.primID]};
}

bool RayCaster::is_open(Vec origin, Vec direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = ray_of(origin, direction);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar >= 0;
}

Frame render(const RayCaster& rays, const Camera& camera, int width, int height, float roll) {
  const size_t n = size_t(width) * size_t(height);
  Frame f{};
  f.width = width;
  f.height = height;
  f.valid.resize(n, 0);
  f.depth.resize(n, 1e10f);
  f.eye = camera.eye;
  f.ortho = camera.ortho_width > 0;
  f.position.resize(n);
  f.normal.resize(n);
  f.facet.resize(n);
  f.albedo.resize(n);
  const Vec forward = unit(camera.target - camera.eye);
  const Vec level = unit(cross(forward, Vec{0, 0, 1})), above = cross(level, forward);
  const Vec right = level * std::cos(roll) + above * std::sin(roll);
  const Vec up = above * std::cos(roll) - level * std::sin(roll);
  f.right = right;
  f.up = up;
  f.forward = forward;
  const float longer = f.ortho ? camera.ortho_width / 2 : std::tan(camera.fov * kPi / 360);
  f.half_width = longer * std::min(1.f, float(width) / float(height));
  f.half_height = longer * std::min(1.f, float(height) / float(width));
  double sum = 0, count = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float a = (2 * (float(x) + .5f) / float(width) - 1) * f.half_width;
      const float b = (1 - 2 * (float(y) + .5f) / float(height)) * f.half_height;
      const Vec across = right * a + up * b;
      const Vec origin = f.ortho ? camera.eye + across : camera.eye;
      const Vec direction = f.ortho ? forward : unit(forward + across);
      const RayCaster::Hit hit = rays.first_hit(origin, direction);
      if (!std::isfinite(hit.distance)) continue;
      const size_t i = size_t(y) * size_t(width) + size_t(x);
      f.valid[i] = 1;
      f.position[i] = origin + direction * hit.distance;
      f.normal[i] = hit.shading;
      f.facet[i] = hit.normal;
      f.albedo[i] = hit.albedo;
      f.depth[i] = dot(f.position[i] - camera.eye, forward);
      sum += std::log(std::max(f.depth[i], 1e-6f));
      ++count;
    }
  f.mean_depth = static_cast<float>(std::exp(sum / std::max(count, 1.)));
  return f;
}

namespace {
// Cosine-weighted directions about an axis, one in each of n x n strata of the square.
Vec cosine_direction(const Rot& axes, float u, float v) {
  const float s = std::sqrt(u), f = 2 * kPi * v;
  return axes * Vec{s * std::cos(f), s * std::sin(f), std::sqrt(std::max(0.f, 1 - u))};
}

void trace_pixel(const RayCaster& rays, const TruthPlan& plan, const Frame& f, size_t i, Random& r,
                 Truth& t) {
  const float bias = 1e-4f * (f.mean_depth + length(f.position[i] - f.eye));
  const Vec origin = f.position[i] + f.facet[i] * bias;
  const Rot axes = around(f.normal[i]);
  int bounces = 0;
  for (int a = 0; a < plan.rays; ++a)
    for (int b = 0; b < plan.rays; ++b) {
      const float n = float(plan.rays), u = (float(a) + r(0, 1)) / n, v = (float(b) + r(0, 1)) / n;
      const Vec d = cosine_direction(axes, u, v);
      const bool sends = (a + b) % 2 == 0;  // half of the rays carry on to a second point
      bounces += sends;
      if (dot(d, f.facet[i]) <= 0) continue;
      const RayCaster::Hit hit = rays.first_hit(origin, d);
      t.ao_radius += hit.distance > plan.radius ? 1.f : 0.f;
      if (std::isfinite(hit.distance)) {
        if (!sends) continue;
        const Vec at = origin + d * hit.distance + hit.normal * bias;
        const Vec on = cosine_direction(around(hit.normal), r(0, 1), r(0, 1));
        if (!rays.is_open(at, on)) continue;
        t.bounce[0] += hit.albedo.x;
        t.bounce[1] += hit.albedo.y;
        t.bounce[2] += hit.albedo.z;
        continue;
      }
      const float basis[9] = {1,
                              d.x,
                              d.y,
                              d.z,
                              d.x * d.y,
                              d.y * d.z,
                              3 * d.z * d.z - 1,
                              d.x * d.z,
                              d.x * d.x - d.y * d.y};
      for (int k = 0; k < 9; ++k) t.moments[k] += basis[k];
    }
  const float count = float(plan.rays * plan.rays);
  t.ao_radius /= count;
  for (float& m : t.moments) m /= count;
  for (float& c : t.bounce) c /= float(bounces);
  t.sun = dot(plan.sun, f.facet[i]) > 0 && dot(plan.sun, f.normal[i]) > 0 &&
                  rays.is_open(origin, plan.sun)
              ? 1.f
              : 0.f;
}
}  // namespace

std::vector<Truth> trace_truth(const RayCaster& rays, const Frame& f, const TruthPlan& plan,
                               Random& r) {
  std::vector<Truth> out;
  for (int y = 0; y + plan.step <= f.height; y += plan.step)
    for (int x = 0; x + plan.step <= f.width; x += plan.step) {
      const size_t i = size_t(y + r.count(0, plan.step - 1)) * size_t(f.width) +
                       size_t(x + r.count(0, plan.step - 1));
      if (!f.valid[i]) continue;
      Truth t{};
      t.pixel = float(i);
      trace_pixel(rays, plan, f, i, r, t);
      out.push_back(t);
    }
  return out;
}
