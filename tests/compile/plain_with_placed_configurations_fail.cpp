// SPDX-License-Identifier: BSD-3-Clause
// expected-error: configurations are placed, and asked about without poses, on a device{}, not by plain
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/traversal/stack.hpp>
#include <clearance/volume/sphere.hpp>

void far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::query prepared(clearance::plain{clearance::host{}, clearance::stack{}}, robot, clearance::min_distances{});
  prepared(points);
}
