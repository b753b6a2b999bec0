// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a point source has rounding, but its list can<...> does not name sources::rounded
#include <clearance/concepts.hpp>

struct points {
  using can = clearance::can<clearance::sources::unfiltered>;
  CLEARANCE_HD std::size_t size() const { return 0; }
  CLEARANCE_HD clearance::sample operator[](std::size_t) const { return {}; }
  CLEARANCE_HD bool unfiltered() const { return true; }
  clearance::position_error rounding() const { return {0.001, 0}; }
};

static_assert(clearance::explain_point_source<points>());
