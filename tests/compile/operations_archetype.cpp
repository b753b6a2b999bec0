// SPDX-License-Identifier: BSD-3-Clause
// The least that a point source must offer to the operations, and the least part.
#include <clearance/backend/host.hpp>
#include <clearance/min_distance.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/sphere.hpp>

namespace {

struct least_source {
  CLEARANCE_HD std::size_t size() const { return 3; }
  CLEARANCE_HD clearance::sample operator[](std::size_t i) const { return {{float(i) + 2, 0, 0}}; }
};

static_assert(clearance::explain_point_source<least_source>());

}  // namespace

int main() {
  const std::vector<clearance::inner_sphere> ball = {{{0, 0, 0}, 1}};
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(ball));
  const auto r = clearance::min_distance(clearance::host{}, part, Eigen::Isometry3d::Identity(), least_source{});
  return r.distance == 1 ? 0 : 1;
}
