// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a traversal of the robot's trees needs: template <hierarchy H, visitor Q> CLEARANCE_HD void operator()(const H& tree, vec3 p, Q& q) const
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

struct root_alone {
  template <clearance::hierarchy H, clearance::visitor Q>
  void operator()(const H& tree, clearance::vec3 p, Q& q) {  // not const
    clearance::offer_leaf(tree, tree.root(), p, q);
  }
};

void far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::ask(clearance::plain{clearance::host{}, root_alone{}}, robot, std::vector{Eigen::Isometry3d::Identity()},
                 points, clearance::zones{{0.1}});
}
