// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots and clouds that questions are asked about, on the host or by kernels.

#include "emulated/record.hpp"
#include "support/frame_after_frame.hpp"
#include "support/scenes.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/query/query.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#if defined(__CUDA_ARCH__)
#include <clearance/device.cuh>
#endif

namespace emulated_test {

using namespace testing;
using clearance::host, clearance::placed, clearance::point_span;
using emulated::record;

#if defined(__CUDA_ARCH__)
inline const clearance::device here;
#else
inline const clearance::host here;
#endif

/// Puts a file's questions among all.
struct asks {
  asks(const std::string& name, void (*all)(record&)) {
#if defined(__CUDA_ARCH__)
    emulated::askers()[name].by_kernels = all;
#else
    emulated::askers()[name].on_host = all;
#endif
  }
};

inline void put(record& to, const std::string& what, const clearance::min_distance_result& r) {
  to.put(what, r.state, r.distance, r.lower, r.upper, r.cloud, r.point, r.part, r.primitive, r.seen, r.valid);
  to.put(what, r.at.x, r.at.y, r.at.z, r.nearest.x, r.nearest.y, r.nearest.z, r.normal.x, r.normal.y, r.normal.z);
  to.put(what, std::vector(r.dropped, r.dropped + clearance::drop_reasons));
}
inline void put(record& to, const std::string& what, const clearance::part_minimum& m) {
  to.put(what, m.distance, m.cloud, m.point, m.primitive);
}

inline void put(record& to, const std::string& what, const clearance::point_counts& c) {
  to.put(what + ", counts", c.seen, c.valid, std::vector(c.dropped, c.dropped + clearance::drop_reasons));
}

/// Scenes of few points; `most` of each at most.
template <class P>
std::vector<scene<P>> small_scenes(std::size_t most = 700) {
  auto all = scenes<P>();
  for (auto& s : all)
    if (s.points.size() > most) s.points.resize(most);
  return all;
}

template <class V, class P>
auto model_of(const scene<P>& s, const clearance::build_options& how = {}) {
  std::vector<clearance::part<clearance::bvh<V, P>>> parts;
  for (const auto& primitives : s.parts) parts.push_back(clearance::make_part(clearance::build<V>(primitives, how)));
  return clearance::model(std::move(parts)).on(here);
}

/// Calls `ask(scene, model, clouds, name)` for each small scene, with its points and, as a second cloud, an image.
template <class V, class P, class Ask>
void each_scene(const clearance::build_options& how, const Ask& ask, std::size_t most = 700) {
  for (const auto& s : small_scenes<P>(most)) {
    const sources<P> all(s);
    const auto model = model_of<V>(s, how);
    ask(s, model, std::tuple(placed{all.span, s.cloud_pose}, placed{all.raw, all.camera_pose}), s.name);
  }
}

}  // namespace emulated_test
