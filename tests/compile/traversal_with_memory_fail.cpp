// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a traversal must be trivially copyable
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <vector>

struct with_a_vector {
  std::vector<int> pending;

  template <clearance::hierarchy H, clearance::visitor Q>
  void operator()(const H& tree, clearance::vec3 p, Q& q) const {
    clearance::offer_leaf(tree, tree.root(), p, q);
  }
};

void far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::ask(clearance::plain{clearance::host{}, with_a_vector{}}, robot,
                 std::vector{Eigen::Isometry3d::Identity()}, points, clearance::min_distance{});
}
