// SPDX-License-Identifier: BSD-3-Clause
// expected-error: poses in memory are read by min_distance and min_distance_per_part on a device{}, not by plain
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/traversal/stack.hpp>
#include <clearance/volume/sphere.hpp>

void far(const std::vector<std::vector<clearance::inner_sphere>>& links, const clearance::world_transform* poses,
         clearance::point_span points, clearance::min_distance_result* to) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::query prepared(clearance::plain{clearance::host{}, clearance::stack{}}, robot, clearance::min_distance{});
  prepared.enqueue(poses, points, nullptr, to);
}
