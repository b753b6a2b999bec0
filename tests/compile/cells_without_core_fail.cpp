// SPDX-License-Identifier: BSD-3-Clause
// expected-error: cells need a tree in arrays, of primitives with core_at
#include <clearance/bvh/build.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/volume/sphere.hpp>

struct dot {
  clearance::vec3 at;
  CLEARANCE_HD clearance::real distance(clearance::vec3 q) const { return clearance::length(q - at); }
  CLEARANCE_HD clearance::vec3 nearest(clearance::vec3) const { return at; }
  CLEARANCE_HD clearance::vec3 normal(clearance::vec3) const { return {0, 0, 1}; }
  std::array<clearance::ball, 1> balls() const { return {{{at, 0}}}; }
};

auto listed(const std::vector<dot>& dots) {
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(dots))}};
  return clearance::with_cells(clearance::host{}, robot);
}
