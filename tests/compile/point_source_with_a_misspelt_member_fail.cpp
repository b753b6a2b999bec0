// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a point source that lists sources::unfiltered needs: CLEARANCE_HD bool unfiltered() const
#include <clearance/concepts.hpp>

struct points {
  using can = clearance::can<clearance::sources::unfiltered>;
  CLEARANCE_HD std::size_t size() const { return 0; }
  CLEARANCE_HD clearance::sample operator[](std::size_t) const { return {}; }
  CLEARANCE_HD bool unfilterd() const { return true; }
};

static_assert(clearance::explain_point_source<points>());
