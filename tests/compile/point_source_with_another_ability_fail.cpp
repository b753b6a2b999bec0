// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the list can<...> names an ability that models of this kind do not have
#include <clearance/concepts.hpp>

struct points {
  using can = clearance::can<clearance::sample>;
  CLEARANCE_HD std::size_t size() const { return 0; }
  CLEARANCE_HD clearance::sample operator[](std::size_t) const { return {}; }
};

static_assert(clearance::explain_point_source<points>());
