// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a point source needs: CLEARANCE_HD sample operator[](std::size_t) const
#include <clearance/concepts.hpp>

struct points {
  CLEARANCE_HD std::size_t size() const { return 0; }
  CLEARANCE_HD clearance::vec3 operator[](std::size_t) const { return {}; }
};

static_assert(clearance::explain_point_source<points>());
