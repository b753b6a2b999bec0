// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a settling answer needs: CLEARANCE_HD bool settled(std::uint32_t cloud, std::uint32_t point, std::uint32_t part) const
#include <clearance/concepts.hpp>

struct misspelt {
  using can = clearance::can<clearance::settling>;
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 0; }
  CLEARANCE_HD void take(const clearance::pair_distance&) const {}
  CLEARANCE_HD bool setled(std::uint32_t, std::uint32_t, std::uint32_t) const { return false; }
};

static_assert(clearance::explain_answer<misspelt>());
