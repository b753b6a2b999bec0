// SPDX-License-Identifier: BSD-3-Clause
// expected-error: what a point source has by the name survey must be: bool survey(std::size_t begin, extent&
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

struct points {
  std::size_t size() const { return 0; }
  clearance::sample operator[](std::size_t) const { return {}; }
  bool survey(std::size_t, clearance::extent&) const { return true; }
};

clearance::real ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies) {
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, std::vector{clearance::placed{points{}}},
                        clearance::min_distance{})
      .distance;
}
