// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a bounding volume must be trivially copyable
#include <clearance/concepts.hpp>

#include <vector>

struct blob {
  std::vector<clearance::vec3> hull;
  static blob fit(std::span<const clearance::ball>) { return {}; }
  CLEARANCE_HD clearance::real lower_bound(clearance::vec3) const { return 0; }
};

static_assert(clearance::explain_bounding_volume<blob>());
