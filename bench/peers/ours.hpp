// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Ours, to compare with each peer in the same run: the exact distance of one frame to all triangles, one thread.

#include "min_distance/scene_files.hpp"

#include <clearance/io/robot.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>

namespace peers {

inline const bench::scene& scene() { return bench::the_scene<false>(); }

inline void ours(benchmark::State& state, bool cold) {
  const auto model = bench::triangle_model<clearance::aabb>(scene());
  const clearance::placed<clearance::point_span> cloud{scene().cloud, scene().world_from_camera};
  clearance::query query(clearance::host{.threads = 1}, model, clearance::min_distance{});
  clearance::min_distance_result r = query(scene().poses, cloud);
  for (auto _ : state) {
    if (cold) query.forget();
    r = query(scene().poses, cloud);
  }
  state.counters["distance_mm"] = r.distance * 1e3;
}
/// Every point's own distance, not just the least.
inline void ours_every_point(benchmark::State& state) {
  const auto model = bench::triangle_model<clearance::aabb>(scene());
  const clearance::placed<clearance::point_span> cloud{scene().cloud, scene().world_from_camera};
  std::vector<clearance::real> distance(scene().cloud.size());
  clearance::point_counts counts;
  for (auto _ : state)
    clearance::enqueue(clearance::host{.threads = 1}, model, scene().poses, cloud, clearance::distances{},
                       {{distance.data()}, &counts});
  clearance::real least = clearance::infinity;
  for (const clearance::real d : distance) least = clearance::min(least, d);
  state.counters["distance_mm"] = least * 1e3;
}
inline void ours_cold(benchmark::State& state) { ours(state, true); }
inline void ours_warm(benchmark::State& state) { ours(state, false); }

}  // namespace peers
