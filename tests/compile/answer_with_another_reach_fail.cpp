// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a coarse answer needs, beside reach(part): CLEARANCE_HD real reach(std::uint32_t part, real found, real nearest) const
#include <clearance/concepts.hpp>

struct another {
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 0; }
  CLEARANCE_HD double reach(std::uint32_t, double, double) const { return 0; }
  CLEARANCE_HD void take(const clearance::pair_distance&) const {}
};

static_assert(clearance::explain_answer<another>());
