// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a bounding volume V needs: static V fit(std::span<const ball>)
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>

struct blob {
  CLEARANCE_HD clearance::real lower_bound(clearance::vec3) const { return 0; }
};

auto tree = clearance::build<blob>(std::vector<clearance::inner_sphere>(1));
