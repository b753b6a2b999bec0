// SPDX-License-Identifier: BSD-3-Clause
// expected-error: deleted
#include <clearance/as_balls.hpp>
#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>

std::size_t clouds(const std::vector<std::vector<clearance::inner_sphere>>& links,
                   const std::vector<Eigen::Isometry3d>& poses) {
  return as_balls(clearance::make_model<clearance::sphere>(links), poses).size();
}
