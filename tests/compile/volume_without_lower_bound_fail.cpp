// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a bounding volume needs: CLEARANCE_HD real lower_bound(vec3) const
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>

struct blob {
  static blob fit(std::span<const clearance::ball>) { return {}; }
};

auto tree = clearance::build<blob>(std::vector<clearance::inner_sphere>(1));
