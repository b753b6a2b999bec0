// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a primitive needs: balls() const
#include <clearance/concepts.hpp>

struct dot {
  CLEARANCE_HD clearance::real distance(clearance::vec3) const { return 0; }
  CLEARANCE_HD clearance::vec3 nearest(clearance::vec3 p) const { return p; }
  CLEARANCE_HD clearance::vec3 normal(clearance::vec3 p) const { return p; }
};

static_assert(clearance::explain_primitive<dot>());
