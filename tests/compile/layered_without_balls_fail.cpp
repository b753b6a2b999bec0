// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the layered fit needs a volume with balls()
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>

struct blob {
  static blob fit(std::span<const clearance::ball>) { return {}; }
  CLEARANCE_HD clearance::real lower_bound(clearance::vec3) const { return 0; }
};

auto tree = clearance::build<blob>(std::vector<clearance::inner_sphere>(1), {}, clearance::layered{});
