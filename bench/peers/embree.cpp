// SPDX-License-Identifier: BSD-3-Clause
// Embree's point query on the same frame, one thread: every point by itself, with the bound passed from point to point,
// and with a seed from a sample before that. Embree has neither; these show the cost of adding them by hand.
#include "peers/ours.hpp"

#include <embree3/rtcore.h>

namespace {

using clearance::real, clearance::vec3;

struct point_query {
  const vec3* corners;
  real best;
};

/// Squared distance to a triangle by regions of its plane (Ericson, Real-Time Collision Detection, 2004, 5.1.5).
real squared_distance(vec3 p, vec3 a, vec3 b, vec3 c) {
  const auto dot = [](vec3 u, vec3 v) { return u.x * v.x + u.y * v.y + u.z * v.z; };
  const auto along = [&](vec3 from, vec3 edge, real t) {
    const vec3 d = p - vec3{from.x + t * edge.x, from.y + t * edge.y, from.z + t * edge.z};
    return dot(d, d);
  };
  const vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const real d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return dot(ap, ap);
  const real d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return dot(bp, bp);
  const real d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return dot(cp, cp);
  const real vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return along(b, c - b, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const real scale = 1 / (va + vb + vc), v = vb * scale, w = vc * scale;
  const vec3 d{p.x - (a.x + ab.x * v + ac.x * w), p.y - (a.y + ab.y * v + ac.y * w), p.z - (a.z + ab.z * v + ac.z * w)};
  return dot(d, d);
}

bool visit(RTCPointQueryFunctionArguments* at) {
  auto& mine = *static_cast<point_query*>(at->userPtr);
  const vec3* t = mine.corners + 3 * at->primID;
  const real d = std::sqrt(squared_distance({at->query->x, at->query->y, at->query->z}, t[0], t[1], t[2]));
  if (!(d < mine.best)) return false;
  mine.best = at->query->radius = d;
  return true;
}

class robot {
 public:
  robot() : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    const auto start = std::chrono::steady_clock::now();
    for (const auto& t : bench::robot_in_camera(peers::scene()))
      for (const auto& v : t) corners_.push_back({real(v.x()), real(v.y()), real(v.z())});
    const RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<vec3*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), corners_.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), corners_.size() / 3));
    for (std::size_t i = 0; i < corners_.size(); ++i) vertices[i] = corners_[i], indices[i] = unsigned(i);
    rtcSetGeometryBuildQuality(mesh, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
    build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
  ~robot() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }
  robot(const robot&) = delete;

  real distance(vec3 p, real within) const {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{p.x, p.y, p.z, 0, within};
    point_query mine{corners_.data(), within};
    rtcPointQuery(scene_, &query, &context, visit, &mine);
    return mine.best;
  }
  double build_ms = 0;

 private:
  RTCDevice device_;
  RTCScene scene_;
  std::vector<vec3> corners_;
};

enum kind { alone, shared, seeded };

template <kind Kind>
void embree(benchmark::State& state) {
  const robot r;
  const auto& cloud = peers::scene().cloud;
  real best = 0;
  for (auto _ : state) {
    best = clearance::infinity;
    if (Kind == seeded)
      for (std::size_t i = 0; i < cloud.size(); i += 256)
        if (clearance::is_finite(cloud[i])) best = r.distance(cloud[i], best);
    for (const vec3 p : cloud)
      if (clearance::is_finite(p)) best = std::min(best, r.distance(p, Kind == alone ? clearance::infinity : best));
  }
  state.counters["distance_mm"] = best * 1e3;
  state.counters["build_ms"] = r.build_ms;
}

BENCHMARK(peers::ours_cold)->Unit(benchmark::kMillisecond);
BENCHMARK(peers::ours_warm)->Unit(benchmark::kMillisecond);
BENCHMARK(peers::ours_every_point)->Unit(benchmark::kMillisecond);
BENCHMARK(embree<alone>)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(embree<shared>)->Unit(benchmark::kMillisecond);
BENCHMARK(embree<seeded>)->Unit(benchmark::kMillisecond);
BENCHMARK(peers::ours_cold)->Name("ours_cold again")->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) { return bench::run_all(argc, argv); }
