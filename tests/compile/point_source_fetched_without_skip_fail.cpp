// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a point source that lists sources::fetched needs: CLEARANCE_HD cursor skip(const cursor&, std::size_t n) const
#include <clearance/points/masked.hpp>

struct points {
  using can = clearance::can<clearance::sources::fetched>;
  using cursor = std::size_t;
  struct four {};
  CLEARANCE_HD std::size_t size() const { return 0; }
  CLEARANCE_HD clearance::sample operator[](std::size_t) const { return {}; }
  CLEARANCE_HD bool fetches() const { return true; }
  CLEARANCE_HD cursor seek(std::size_t i) const { return i; }
  CLEARANCE_HD four fetch(cursor) const { return {}; }
  CLEARANCE_HD unsigned look(const four&, std::size_t, clearance::vec3 (&)[4]) const { return 0; }
};

static_assert(clearance::explain_point_source<points>());
