// SPDX-License-Identifier: BSD-3-Clause
// expected-error: deleted
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/volume/sphere.hpp>

using bodies = std::vector<std::vector<clearance::inner_sphere>>;

std::size_t parts(const bodies& links, const bodies& tool) {
  const auto arm = clearance::make_model<clearance::sphere>(links);
  const auto both = clearance::attach(clearance::host{}, arm, clearance::make_model<clearance::sphere>(tool));
  return both.size();
}
