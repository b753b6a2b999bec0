// SPDX-License-Identifier: BSD-3-Clause
// expected-error: joint vectors of a chain are for questions about many configurations: this one is asked about one, by the poses of its parts
// and no other error
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/robot/joint_chain.hpp>
#include <clearance/volume/sphere.hpp>

void ask(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points,
         const clearance::joint_chain<clearance::host>& chain, const std::vector<double>& q) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::query prepared(clearance::host{}, robot, clearance::min_distance{});
  prepared(chain, q, points);
}
