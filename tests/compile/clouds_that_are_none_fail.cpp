// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a point source needs: CLEARANCE_HD sample operator[](std::size_t) const
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

struct points {
  std::size_t size() const { return 0; }
  clearance::vec3 operator[](std::size_t) const { return {}; }
};

clearance::real ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies) {
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, points{}, clearance::min_distance{})
      .distance;
}
