// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Extreme numbers on any backend: every way of asking it has the bits of one call on a host.

#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

#include <optional>

namespace testing {

/// Asks `on`, plainly and by parts, once and prepared: cold, warm, moved and moved back. At each place
/// `judge(result, by_parts, poses, when)` sees what one call on a host says.
template <class On, class Model, class Judge>
void check_edge(const On& on, const Model& on_host, std::vector<Eigen::Isometry3d> poses,
                const std::vector<vec3>& points, const Eigen::Isometry3d& pose, verdict& v, const std::string& what,
                const Judge& judge) {
  using clearance::host, clearance::min_distance, clearance::min_distance_per_part;
  const auto model = on_host.on(on);
  const auto there = on.copy_in(std::span<const vec3>(points));
  const clearance::placed here{clearance::point_span(points), pose},
      cloud{clearance::point_span(there.data(), points.size()), pose};
  using part_view = typename decltype(model.view())::part_type;
  std::optional<clearance::query<min_distance, On, part_view>> query;
  std::optional<clearance::query<min_distance_per_part, On, part_view>> per_part;
  if (std::is_same_v<On, host> || poses.size() <= 128)  // a device's kernel takes no more
    query.emplace(on, model.view(), min_distance{}), per_part.emplace(on, model.view(), min_distance_per_part{});
  const auto same = [&](const std::string& when, int times) {
    const auto expected = clearance::ask(host{}, on_host, poses, here, min_distance{});
    const auto by_parts = clearance::ask(host{}, on_host, poses, here, min_distance_per_part{});
    judge(expected, by_parts, poses, when);
    const auto require = [&](const clearance::min_distance_result& r, const auto& parts, const std::string& how) {
      v.require(same_result(r, expected), what, ", ", how, when, ": differs from the host's result");
      v.require(same_result(parts.all, by_parts.all), what, ", by parts, ", how, when, ": differs");
      v.require(std::ranges::equal(parts.parts, by_parts.parts, same_minimum), what, ", ", how, when,
                ": some part's minimum differs");
    };
    require(clearance::ask(on, model, poses, cloud, min_distance{}),
            clearance::ask(on, model, poses, cloud, min_distance_per_part{}), "plain, ");
    for (int k = 0; query && k < times; ++k)
      require((*query)(poses, cloud), (*per_part)(poses, cloud), "prepared, time " + std::to_string(k) + ", ");
  };
  const auto first = poses;
  same("cold", 2);
  poses[0].translation().x() += 0.01, poses.back().translation().z() -= 5;
  same("moved", 2);
  poses = first;
  if (query) query->forget(), per_part->forget();
  same("moved back", 1);
}

/// Judges nothing.
inline const auto nobody = [](const auto&...) {};

/// Of points that are all inside boxes the first is the answer, 0 away. `judge_of(model, points)` makes a judge.
template <class On, class JudgeOf>
void check_all_inside(const On& on, std::size_t count, verdict& v, const JudgeOf& judge_of) {
  dice d(79);
  std::vector<decltype(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(1))))> parts;
  for (const double half : {2.0, 1.0, 3.0})
    parts.push_back(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(half))));
  const clearance::model model(std::move(parts));
  auto points = d.points(count, 0.5);
  points[0].z = clearance::not_a_number;
  const auto there = model.on(on);
  for (const double off : {0.0, 1000.0}) {  // the second box
    const std::vector<Eigen::Isometry3d> poses = {d.pose(0.1), shifted(off, 0, 0) * d.pose(0.1), d.pose(0.1)};
    check_edge(on, model, poses, points, shifted(0, 0, 0), v, "the second box " + std::to_string(off) + " m off",
               judge_of(model, points));
    clearance::query query(on, there, clearance::min_distance{});
    for (int time = 0; time < 2; ++time) {
      const auto r = query(poses, points);
      CHECK((r.distance == 0 && r.point == 1 && r.part == 0 && r.state == clearance::state::collision && r.upper == 0 &&
             r.lower == 0));
    }
  }
}

}  // namespace testing
