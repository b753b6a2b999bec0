// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about clouds in chunks, on any backend.

#include "support/random.hpp"
#include "support/same_result.hpp"
#include "support/scenes.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

namespace testing {

/// Asks about everything, then about what was not skipped, from near and far. `source`: the same points on the host.
template <class On, class Model, class C, class S>
void ask_often(const On& on, const Model& on_host, std::vector<Eigen::Isometry3d> poses, clearance::chunked<C>& cloud,
               const S& source, const Eigen::Isometry3d& pose, verdict& v, const std::string& what) {
  const auto model = on_host.on(on);
  const clearance::host host;
  clearance::chunked_query query(on, model, clearance::min_distance{});
  clearance::chunked_query by_parts(on, model, clearance::min_distance_per_part{});
  for (int round = 0; round < 4; ++round) {
    const clearance::placed<S> whole{source, pose};
    v.require(
        same_result(query(poses, cloud, pose), clearance::ask(host, on_host, poses, whole, clearance::min_distance{})),
        what, ", round ", round, ": another answer");
    v.require(round > 0 || query.loaded() == source.size(), what, ": the first question did not read all");
    const auto [robot, each] = clearance::ask(host, on_host, poses, whole, clearance::min_distance_per_part{});
    const auto [found, minima] = by_parts(poses, cloud, pose);
    v.require(same_result(found, robot), what, ", round ", round, ": another answer by parts");
    v.require(std::ranges::equal(minima, each, same_minimum), what, ", round ", round, ": some part's minimum differs");
    poses[0].translation().x() += round == 1 ? 3 : 0.02;
  }
}

/// Points that follow one another are near one another, so there is something to skip.
inline std::vector<vec3> wall(std::size_t points) {
  dice d(5);
  std::vector<vec3> all;
  for (std::size_t i = 0; i < points; ++i)
    all.push_back({real(double(i) * 20 / double(points) - 10), d.number(-1, 1), d.number(1, 2)});
  for (std::size_t i = 7; i < points; i += 1001) all[i].y = clearance::not_a_number;
  return all;
}
inline auto arm() {
  dice d(3);
  return clearance::make_model<clearance::sphere>(
      std::vector{random_primitives<inner_sphere>(d, 50, 0.3, 0.1), random_primitives<inner_sphere>(d, 30, 0.2, 0.1)});
}
inline const std::vector<Eigen::Isometry3d> arm_poses = {shifted(0, 0, 0), shifted(0.5, 0, 0)};

/// A source over records of three floats in memory.
inline clearance::point_span points_at(const std::byte* memory, std::size_t count) {
  return {reinterpret_cast<const vec3*>(memory), count};
}

}  // namespace testing
