// SPDX-License-Identifier: BSD-3-Clause
// expected-error: what a point source has by the name fetches must be: CLEARANCE_HD bool fetches() const
#include <clearance/concepts.hpp>

struct points {
  CLEARANCE_HD std::size_t size() const { return 0; }
  CLEARANCE_HD clearance::sample operator[](std::size_t) const { return {}; }
  CLEARANCE_HD int fetches() const { return 1; }
};

static_assert(clearance::explain_point_source<points>());
